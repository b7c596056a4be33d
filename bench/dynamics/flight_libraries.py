"""Quadrotor steps in crazyflow and RotorPy."""

from collections.abc import Callable
from typing import Any

import numpy as np
from crazyflow.control import Control
from crazyflow.dynamics import Dynamics
from crazyflow.sim import Sim
from rotorpy.vehicles.crazyflie_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor

RATE = 500  # Hz, the default of crazyflow
MANY, BATCH = 1000, 100
# gym-pybullet-drones is not installed; published steps per second, from the machine of Box3D's figures.
PUBLISHED = {"gym-pybullet-drones, given": 44e3, "with aerodynamics, given": 20e3}


def crazyflow(worlds: int, steps: int) -> Callable[[], None]:
    """A call of `steps` steps of one drone in each of `worlds` worlds, on the CPU, with the attitude controller."""
    sim = Sim(n_worlds=worlds, n_drones=1, dynamics=Dynamics.first_principles, control=Control.attitude, freq=RATE,
              device="cpu")
    sim.reset()
    sim.attitude_control(np.tile(np.array([0, 0, 0, 0.35], np.float32), (worlds, 1, 1)))

    def call() -> None:
        sim.step(steps)
        sim.data.states.pos.block_until_ready()
        if not np.isfinite(sim.data.states.pos).all():
            raise SystemExit("crazyflow: the positions are not finite")

    return call


def rotorpy() -> Callable[[], None]:
    """A call that runs one step of the Crazyflie, without a controller, with RotorPy's integrator."""
    drone = Multirotor(dict(quad_params))
    hover = float(np.sqrt(quad_params["mass"] * 9.81 / (4 * quad_params["k_eta"])))
    state: dict[str, Any] = {"x": np.zeros(3), "v": np.zeros(3), "q": np.array([0, 0, 0, 1.0]), "w": np.zeros(3),
                             "wind": np.zeros(3), "rotor_speeds": np.full(4, hover)}
    command = {"cmd_motor_speeds": hover * np.array([1.002, 1.001, 1.002, 1.001])}

    def call() -> None:
        state.update(drone.step(state, command, 1.0 / RATE))

    return call
