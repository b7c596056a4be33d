"""An effect: a pull towards the origin, F = -k x. In a scene: `effects: {my_drone.spring: {stiffness: 4.0}}`."""

from pydantic import Field

from drone_engine.context import Context, Stages
from drone_engine.kernel import kernel
from drone_engine.scene.fields import Strict

UNSTEADY = False  # nothing at rest is set in motion, so bodies may sleep


class Parameters(Strict):
    """Validates the effect's part of the scene."""

    stiffness: float = Field(1.0, ge=0.0, le=1000.0)  # N/m


@kernel
def pull(awake, position, stiffness, force):
    """Adds the pull on awake bodies to force (n, 3), N; position: (n, 3) m; stiffness: N/m."""
    for k in range(1, 1 + awake[0]):
        for c in range(3):
            force[awake[k], c] -= stiffness * position[awake[k], c]


def build(parameters: Parameters, context: Context) -> Stages:
    """The stages of this effect. The kernel's other parameters are bound by name."""
    return Stages(force=(context.stage("spring", pull, stiffness=parameters.stiffness),))
