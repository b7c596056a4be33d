"""Uniform gravity: weight = m g, downwards."""

from pydantic import Field

from drone_engine.context import Context, Stages
from drone_engine.kernel import kernel
from drone_engine.scene.fields import Strict


class Parameters(Strict):
    """Keys of the effect in a scene file."""

    acceleration: float = Field(9.80665, ge=0.0, le=300.0)  # m/s^2; standard gravity (CGPM 1901)


@kernel
def pull(awake, mass, acceleration, force):
    """Adds the weight of awake bodies to force (n, 3), N; mass: (n,) kg; acceleration: m/s^2."""
    for k in range(1, 1 + awake[0]):
        force[awake[k], 2] -= acceleration * mass[awake[k]]


def build(parameters: Parameters, context: Context) -> Stages:
    """The stages of this effect."""
    return Stages(force=(context.stage("gravity", pull, acceleration=parameters.acceleration),))
