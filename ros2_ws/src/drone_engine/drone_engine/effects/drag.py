"""Quadratic air drag on the box of each body: F = -1/2 rho C A |v| v (Anderson, Fundamentals of Aerodynamics, 1.5)."""

from pydantic import Field

from drone_engine.context import Context, Stages
from drone_engine.effects import STABLE
from drone_engine.kernel import inlined, kernel
from drone_engine.math.rotation import matrix
from drone_engine.scene.fields import Strict


class Parameters(Strict):
    """Keys of the effect in a scene file."""

    density: float = Field(1.225, ge=0.0, le=2000.0)  # kg/m^3; sea level, 15 degrees Celsius (ISO 2533)
    coefficient: float = Field(1.0, ge=0.0, le=10.0)  # about 1.05 for a cube, 0.5 to 1.2 for bluff bodies


@kernel
def drag(awake, orientation, velocity, air_velocity, half, mass, factor, h, force):
    """Adds the drag of awake boxes to force (n, 3), N. A is the box's projected area along its velocity through the
    air.

    half: (n, 3) m; mass: (n,) kg; factor: rho C / 2, kg/m^3; air_velocity: (n, 3) m/s, or (0, 3) where the air is at
    rest; h: s of a sub-step.
    """
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        vx, vy, vz = velocity[i, 0], velocity[i, 1], velocity[i, 2]
        if air_velocity.shape[0]:
            vx, vy, vz = vx - air_velocity[i, 0], vy - air_velocity[i, 1], vz - air_velocity[i, 2]
        x, y, z = resistance(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3], vx, vy, vz,
                             half[i, 0], half[i, 1], half[i, 2], mass[i], factor, h)
        force[i, 0] -= x
        force[i, 1] -= y
        force[i, 2] -= z


@inlined
def resistance(qx, qy, qz, qw, vx, vy, vz, hx, hy, hz, mass, factor, h):
    """The drag on a box with half extents hx, hy, hz (m) and orientation q that moves through the air at v (m/s): the
    vector (N, world) to subtract from the force. No branches."""
    m = matrix(qx, qy, qz, qw)
    area_speed = (4.0 * hy * hz * abs(m[0] * vx + m[3] * vy + m[6] * vz)
                    + 4.0 * hz * hx * abs(m[1] * vx + m[4] * vy + m[7] * vz)
                    + 4.0 * hx * hy * abs(m[2] * vx + m[5] * vy + m[8] * vz))
    # Limited, so that it does not reverse the motion within a sub-step of h s.
    rate = min(factor * area_speed, STABLE * mass / h)
    return rate * vx, rate * vy, rate * vz


def build(parameters: Parameters, context: Context) -> Stages:
    """The stages of this effect."""
    factor = 0.5 * parameters.density * parameters.coefficient
    return Stages(force=(context.stage("drag", drag, factor=factor),))
