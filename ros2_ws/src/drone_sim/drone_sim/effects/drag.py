"""Quadratic air drag on the box of each body: F = -1/2 rho C A |v| v (Anderson, Fundamentals of Aerodynamics, 1.5)."""

import math

import numpy as np
from pydantic import Field

from drone_sim.arrays import Floats
from drone_sim.kernel import kernel
from drone_sim.model import Model
from drone_sim.rotation import matrix
from drone_sim.stage import Stage
from drone_sim.state import State
from drone_sim.strict import Strict


class Parameters(Strict):
    density: float = Field(1.225, ge=0.0, le=2000.0)  # kg/m^3; sea level, 15 degrees Celsius (ISO 2533)
    coefficient: float = Field(1.0, ge=0.0, le=10.0)  # about 1.05 for a cube, 0.5 to 1.2 for bluff bodies


@kernel
def drag(orientation, velocity, half, mass, factor, dt, force):
    """Adds the drag of n boxes, `factor` = rho C / 2, to force (n, 3). A is the box's shadow along the velocity."""
    for i in range(velocity.shape[0]):
        vx, vy, vz = velocity[i, 0], velocity[i, 1], velocity[i, 2]
        speed = math.sqrt(vx * vx + vy * vy + vz * vz)
        if speed == 0.0 or mass[i] == 0.0:
            continue
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        area_speed = 0.0
        for k in range(3):
            face = 4.0 * half[i, (k + 1) % 3] * half[i, (k + 2) % 3]
            area_speed += face * abs(m[k] * vx + m[3 + k] * vy + m[6 + k] * vz)
        # No more than stops the body within this step: a long step must not turn drag into thrust.
        rate = min(factor * area_speed, mass[i] / dt)
        force[i, 0] -= rate * vx
        force[i, 1] -= rate * vy
        force[i, 2] -= rate * vz


def build(parameters: Parameters, model: Model, state: State, force_w: Floats, dt: float) -> Stage:
    bodies, factor = model.bodies, np.float64(0.5 * parameters.density * parameters.coefficient)

    def slow_down() -> None:
        drag(state.orientation_w, state.velocity_w, bodies.half, bodies.mass, factor, dt, force_w)

    return slow_down
