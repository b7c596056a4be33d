"""Motion without contact: orders of convergence, energy of a fast rotation. Cases: reference/motion/cases.py"""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drone_engine.arrays import Floats
from reference.box_world import Setting
from reference.free_rotation import attitude, rates
from reference.motion.cases import CASES

Hold = Callable[..., None]


@pytest.mark.parametrize("setting", CASES["tumble"].settings, ids=str)
def test_a_tumbling_box_converges_with_the_order_of_the_integrator(setting: Setting, hold: Hold) -> None:
    hold("tumble", setting)


@pytest.mark.parametrize("setting", CASES["spin"].settings, ids=str)
def test_a_fast_rotation_about_the_intermediate_axis_keeps_energy_and_momentum(setting: Setting, hold: Hold) -> None:
    hold("spin", setting)


@pytest.mark.parametrize("seed", range(6))
def test_the_closed_form_of_free_rotation_solves_eulers_equations(seed: int) -> None:
    rng = np.random.default_rng(seed)
    inertia, rate_b = rng.uniform(1.0, 2.0, 3), rng.normal(0.0, 2.0, 3)

    def derivative(_: float, y: Floats) -> Floats:
        rotation, w = y[:9].reshape(3, 3), y[9:]
        cross = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        return np.concatenate([(rotation @ cross).ravel(), np.cross(inertia * w, w) / inertia])

    end = solve_ivp(derivative, (0.0, 5.0), [*np.eye(3).ravel(), *rate_b], "DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    np.testing.assert_allclose(rates(inertia, rate_b, np.array(5.0)), end[9:], atol=1e-11)
    np.testing.assert_allclose(attitude(inertia, rate_b, 5.0), end[:9].reshape(3, 3), atol=1e-11)
