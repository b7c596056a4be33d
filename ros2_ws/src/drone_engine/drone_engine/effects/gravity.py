"""Uniform gravity: weight = m g, downwards."""

from pydantic import Field

from drone_engine.effects import Setting, Stages
from drone_engine.kernel import kernel
from drone_engine.program.stage import Stage
from drone_engine.scene.fields import Strict


class Parameters(Strict):
    acceleration: float = Field(9.80665, ge=0.0, le=300.0)  # m/s^2; standard gravity (CGPM 1901)


@kernel
def pull(awake, mass, acceleration, force):
    """Adds the weight of the bodies that are awake to force (n, 3)."""
    for k in range(1, 1 + awake[0]):
        force[awake[k], 2] -= acceleration * mass[awake[k]]


def build(parameters: Parameters, setting: Setting) -> Stages:
    mass = setting.model.bodies.mass
    return Stages(force=(Stage("gravity", pull, (setting.state.awake, mass, parameters.acceleration,
                                                 setting.forces.force_w)),))
