"""Linear drag: F = -m R D R^T v, D = diag(rates along the body's axes).

This is the drag of rotors (Faessler, Franchi, Scaramuzza 2018, Differential Flatness of Quadrotor Dynamics Subject to
Rotor Drag, eq. 1); the default rates are those identified there. For other bodies it is plain
damping.
"""

from typing import Annotated, Literal

from pydantic import Field

from drone_engine.context import Context, Stages
from drone_engine.effects import STABLE
from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix
from drone_engine.scene.fields import Strict

PerSecond = Annotated[float, Field(ge=0.0, le=1000.0)]


class Parameters(Strict):
    """Keys of the effect in a scene file."""

    rate: tuple[PerSecond, PerSecond, PerSecond] = (0.544, 0.386, 0.0)  # 1/s, along x, y, z of the body
    spin: PerSecond = 0.0  # 1/s, of the angular velocity
    bodies: Literal["drones", "all"] = "drones"


@kernel
def damp(awake, acts, orientation, velocity, angular_velocity, air_velocity, mass, body_inertia, x, y, z, rotation_rate,
         h, force, torque):
    """Adds the drag of the bodies in the mask `acts` (n,) to force (N) and torque (N m), (n, 3) in the world.

    x, y, z: 1/s, rates along the body's axes; rotation_rate: 1/s, of the angular velocity; mass: (n,) kg; body_inertia:
    (n, 3) kg m^2; air_velocity: (n, 3) m/s, or (0, 3) where the air is at rest; h: s of a sub-step.
    """
    most = STABLE / h  # limited, so that it does not reverse the motion within a sub-step
    x, y, z, rate = min(x, most), min(y, most), min(z, most), min(rotation_rate, most)
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        if not acts[i]:
            continue
        vx, vy, vz = velocity[i, 0], velocity[i, 1], velocity[i, 2]
        if air_velocity.shape[0]:
            vx, vy, vz = vx - air_velocity[i, 0], vy - air_velocity[i, 1], vz - air_velocity[i, 2]
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        bx = x * (m[0] * vx + m[3] * vy + m[6] * vz)
        by = y * (m[1] * vx + m[4] * vy + m[7] * vz)
        bz = z * (m[2] * vx + m[5] * vy + m[8] * vz)
        wx, wy, wz = angular_velocity[i, 0], angular_velocity[i, 1], angular_velocity[i, 2]
        tx = rate * body_inertia[i, 0] * (m[0] * wx + m[3] * wy + m[6] * wz)
        ty = rate * body_inertia[i, 1] * (m[1] * wx + m[4] * wy + m[7] * wz)
        tz = rate * body_inertia[i, 2] * (m[2] * wx + m[5] * wy + m[8] * wz)
        for c in range(3):
            force[i, c] -= mass[i] * (m[3 * c] * bx + m[3 * c + 1] * by + m[3 * c + 2] * bz)
            torque[i, c] -= m[3 * c] * tx + m[3 * c + 1] * ty + m[3 * c + 2] * tz


def build(parameters: Parameters, context: Context) -> Stages:
    """The stages of this effect."""
    acts = context.model.bodies.movable.copy()
    if parameters.bodies == "drones":
        acts[:] = False
        acts[context.model.drones.body] = True
    if not acts.any():
        return Stages(idle="no drone in the scene" if parameters.bodies == "drones" else "nothing in the scene moves")
    x, y, z = parameters.rate
    return Stages(force=(context.stage("linear_drag", damp, acts=acts, x=x, y=y, z=z, rotation_rate=parameters.spin),))
