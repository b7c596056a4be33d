"""How drones turn commands into forces."""

from collections.abc import Mapping
from itertools import chain
from pathlib import Path

import numpy as np

from drone_sim.effects import Setting, Stages
from drone_sim.effects.gravity import Parameters as Gravity
from drone_sim.flight import direct, pilot, quadrotor
from drone_sim.strict import Strict


def build(setting: Setting, active: Mapping[str, Strict], path: Path) -> Stages:
    """The pilot, and the flight models that the scene's drones have; active: its effects. Raises SceneError."""
    drones, gravity = setting.model.drones, active.get("gravity")
    weight = gravity.acceleration if isinstance(gravity, Gravity) else 0.0
    wanted = np.zeros((len(drones.body), 4))
    models = [Stages(step=(pilot.build(setting, wanted),))]
    if not drones.quadrotor.all():
        models.append(direct.build(setting, np.flatnonzero(~drones.quadrotor), wanted, weight))
    if drones.quadrotor.any():
        models.append(quadrotor.build(setting, np.flatnonzero(drones.quadrotor), wanted, active, weight, path))
    return Stages(*(tuple(chain(*stages)) for stages in zip(*models, strict=True)))
