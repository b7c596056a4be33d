"""What acts on bodies: one effect a file, built only for scenes that name it.

To add one, write a module with `Parameters` and `build`, and its line in EFFECTS. Its stages see all arrays; they add
to forces.force_w and torque_w, or to forces.air_w if it stirs the air. What goes on from step to step is kept by
`state.remember`, so that it is part of the state and its hash; randomness comes from `setting.seed` (see noise.py).
"""

import json
from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple, Protocol, cast

from pydantic import ValidationError

from drone_engine.arrays import Floats
from drone_engine.program.stage import Stage
from drone_engine.scene.fields import Strict, first_error
from drone_engine.scene.schema import Scene, SceneError

if TYPE_CHECKING:
    from drone_engine.model import Model
    from drone_engine.state import State

EFFECTS = {  # in the order in which they act: first those that stir the air
    "wind": "drone_engine.effects.wind",
    "gusts": "drone_engine.effects.gusts",
    "downwash": "drone_engine.effects.downwash",
    "gravity": "drone_engine.effects.gravity",
    "drag": "drone_engine.effects.drag",
    "linear_drag": "drone_engine.effects.linear_drag",
    "ground_effect": "drone_engine.effects.ground_effect",
    "water": "drone_engine.effects.water",
    "motor_lag": "drone_engine.effects.motor_lag",
}
AIR = ("wind", "gusts", "downwash")  # those that stir the air, before anything asks how it moves
THRUST = ("downwash", "ground_effect")  # those that need to know what each rotor pushes with
STABLE = 0.4  # of what stops a body within a sub-step: the most that one drag takes, as several may act at once
UNSTEADY = ("gusts", "downwash")  # those that may move what has come to rest: with them, nobody sleeps


class Forces(NamedTuple):
    """What acts on n bodies with r rotors at one instant of a step, in arrays that effects share. World frame, SI."""

    force_w: Floats  # (n, 3) N, at the centres of mass
    torque_w: Floats  # (n, 3) N m
    air_w: Floats  # (n, 3) m/s, the air's velocity around each body; (0, 3) where nothing stirs it
    thrust: Floats  # (r,) N along the rotors' z axes, as the flight model has it, before what effects make of it
    clock: Floats  # (1,) s since the step began
    inverse_mass: Floats  # (n,) of what moves: the bodies, and what they take along
    inertia_b: Floats  # (n, 3) likewise


class Setting(NamedTuple):
    """What an effect is built into."""

    model: "Model"
    state: "State"
    forces: Forces
    dt: float  # s, of a step
    seed: int  # the scene's
    active: Mapping[str, Strict]  # all effects of the scene, and their parameters
    substeps: int  # of a step

    @property
    def h(self) -> float:
        """s, of a sub-step: forces are asked for at least as often."""
        return self.dt / self.substeps


class Stages(NamedTuple):
    """What an effect does: once a step, before all else; for every instant at which forces are asked for; and at the
    beginning of every sub-step, before forces are asked for."""

    step: tuple[Stage, ...] = ()
    force: tuple[Stage, ...] = ()
    substep: tuple[Stage, ...] = ()
    idle: str = ""  # why there is nothing to do, where there is not


class Effect(Protocol):
    """What an effect's module offers."""

    Parameters: type[Strict]

    @staticmethod
    def build(parameters: Strict, setting: Setting) -> Stages:
        """The stages that this effect adds."""


def weight(active: Mapping[str, Strict]) -> float:
    """The gravity that these effects hold, m/s^2; 0 without any."""
    return float(getattr(active.get("gravity"), "acceleration", 0.0))


def effect(name: str) -> Effect:
    """The module of an effect, imported when it is asked for."""
    return cast(Effect, import_module(EFFECTS[name]))


def parameters(scene: Scene) -> dict[str, Strict]:
    """The scene's effects in the order of EFFECTS, validated. Raises SceneError."""
    for name in scene.effects:
        if name not in EFFECTS:
            raise SceneError(f"{scene.path}: effects.{name}: unknown effect; there are {', '.join(EFFECTS)}")
    valid = {}
    for name in EFFECTS:
        if name in scene.effects:
            try:
                words = json.dumps(scene.effects[name])  # as a file has them: lists for tuples
                valid[name] = effect(name).Parameters.model_validate_json(words, strict=True)
            except ValidationError as error:
                message = first_error(error, effect(name).Parameters, ("effects", name))
                raise SceneError(f"{scene.path}: {message}") from None
    return valid
