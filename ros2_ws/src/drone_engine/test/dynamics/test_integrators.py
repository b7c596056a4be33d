"""The integrators of angular velocity and orientation, alone."""

import math

import numpy as np
import pytest

from drone_engine.dynamics.integrators import cayley, euler_angular_velocity, midpoint_angular_velocity
from drone_engine.math.rotation import matrix, rotate

INERTIA = np.array([0.01, 0.02, 0.05])
H = 1.0 / 240.0


def energy(w: np.ndarray) -> float:
    """Of a rotation w, rad/s in the body frame, J."""
    return float(0.5 * (INERTIA * w**2).sum())


@pytest.mark.parametrize("speed", [0.5, 20.0, 500.0])
def test_midpoint_conserves_energy_and_angular_momentum(speed: float) -> None:
    w, q = speed * np.array([0.1, 1.0, 0.2]), (0.0, 0.0, 0.0, 1.0)
    start, momentum = energy(w), INERTIA * w
    for _ in range(1000):
        new = np.array(midpoint_angular_velocity(*INERTIA, *w, 0.0, 0.0, 0.0, H))
        q = cayley(*q, *(0.5 * (w + new)), H)
        w = new
    assert energy(w) == pytest.approx(start, rel=1e-11)
    np.testing.assert_allclose(rotate(*q, *(INERTIA * w)), momentum, rtol=0, atol=1e-11 * np.linalg.norm(momentum))


@pytest.mark.parametrize("speed", [0.5, 20.0, 100.0])
def test_euler_gains_no_energy(speed: float) -> None:
    w = speed * np.array([0.1, 1.0, 0.2])
    identity = matrix(0.0, 0.0, 0.0, 1.0)
    assert energy(np.array(euler_angular_velocity(identity, *INERTIA, *w, 0.0, 0.0, 0.0, H))) <= energy(w)


def test_torque_about_a_principal_axis() -> None:
    torque = np.array([0.0, 0.0, 0.3])
    expected = torque * H / INERTIA
    identity = matrix(0.0, 0.0, 0.0, 1.0)
    zero = (0.0, 0.0, 0.0)
    np.testing.assert_allclose(euler_angular_velocity(identity, *INERTIA, *zero, *torque, H), expected, rtol=1e-14)
    np.testing.assert_allclose(midpoint_angular_velocity(*INERTIA, *zero, *torque, H), expected, rtol=1e-14)


def test_cayley_rotates_about_the_axis_by_twice_the_arc_tangent() -> None:
    angle = 2.0 * math.atan(0.5 * 3.0 * H)
    np.testing.assert_allclose(cayley(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 3.0, H),
                               (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)), rtol=1e-14, atol=1e-16)
