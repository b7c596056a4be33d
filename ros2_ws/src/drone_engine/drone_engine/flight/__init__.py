"""How drones turn commands into forces."""

from collections.abc import Mapping
from itertools import chain
from pathlib import Path

import numpy as np

from drone_engine.effects import Setting, Stages, weight
from drone_engine.flight import direct, pilot, quadrotor
from drone_engine.scene.fields import Strict


def build(setting: Setting, active: Mapping[str, Strict], path: Path) -> Stages:
    """The pilot, and the flight models that the scene's drones have; active: its effects. Raises SceneError."""
    drones, carried = setting.model.drones, weight(active)
    wanted = np.zeros((len(drones.body), 4))
    models = [Stages(step=(pilot.build(setting, wanted),))]
    if not drones.quadrotor.all():
        models.append(direct.build(setting, np.flatnonzero(~drones.quadrotor), wanted, carried))
    if drones.quadrotor.any():
        models.append(quadrotor.build(setting, np.flatnonzero(drones.quadrotor), wanted, active, carried, path))
    step, force, substep = (tuple(chain(*stages)) for stages in zip(*(each[:3] for each in models), strict=True))
    return Stages(step, force, substep)
