"""How drones turn commands into forces."""

from itertools import chain

import numpy as np

from drone_engine.context import Context, Stages
from drone_engine.effects import weight
from drone_engine.flight import direct, pilot, quadrotor
from drone_engine.scene.schema import Scene


def build(context: Context, scene: Scene) -> Stages:
    """The stages of the pilot and of the flight models that the scene's drones have. Raises SceneError."""
    drones, carried = context.model.drones, weight(context.active)
    wanted = np.zeros((len(drones.body), 4))
    models = [Stages(step=(pilot.build(context, wanted),))]
    if not drones.quadrotor.all():
        models.append(direct.build(context, np.flatnonzero(~drones.quadrotor), wanted, carried))
    if drones.quadrotor.any():
        models.append(quadrotor.build(context, np.flatnonzero(drones.quadrotor), wanted, carried, scene.path))
    return Stages(step=tuple(chain(*(each.step for each in models))),
                  substep=tuple(chain(*(each.substep for each in models))),
                  force=tuple(chain(*(each.force for each in models))))
