"""What acts on bodies: one effect a file, built only for scenes that name it.

To add one, write a module with `Parameters` and `build`, and its line in EFFECTS. Its stages see all arrays; they add to
forces.force_w and torque_w, or to forces.air_w if it stirs the air. What goes on from step to step is kept by
`state.remember`, so that it is part of the state and its hash; randomness comes from `setting.seed` (see noise.py).
"""

from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple, Protocol, cast

from pydantic import ValidationError

from drone_sim.arrays import Floats
from drone_sim.scene import Scene, SceneError
from drone_sim.stage import Stage
from drone_sim.strict import Strict, first_error

if TYPE_CHECKING:
    from drone_sim.model import Model
    from drone_sim.state import State

EFFECTS = {
    "gravity": "drone_sim.effects.gravity",
    "drag": "drone_sim.effects.drag",
    "motor_lag": "drone_sim.effects.motor_lag",
}
AIR = ()  # those that stir the air, before anything asks how it moves


class Forces(NamedTuple):
    """What acts on n bodies with r rotors at one instant of a step, in arrays that effects share. World frame, SI."""

    force_w: Floats  # (n, 3) N, at the centres of mass
    torque_w: Floats  # (n, 3) N m
    air_w: Floats  # (n, 3) m/s, the air's velocity around each body; (0, 3) where nothing stirs it
    thrust: Floats  # (r,) N along the rotors' z axes, as the flight model has it, before what effects make of it
    clock: Floats  # (1,) s since the step began


class Setting(NamedTuple):
    """What an effect is built into."""

    model: "Model"
    state: "State"
    forces: Forces
    dt: float  # s, of a step
    seed: int  # the scene's
    names: tuple[str, ...]  # of all effects of the scene
    substeps: int  # of a step


class Stages(NamedTuple):
    """What an effect does: once a step, before all else; for every instant at which forces are asked for; and at the
    beginning of every sub-step, before forces are asked for."""

    step: tuple[Stage, ...] = ()
    force: tuple[Stage, ...] = ()
    substep: tuple[Stage, ...] = ()


class Effect(Protocol):
    """What an effect's module offers."""

    Parameters: type[Strict]

    @staticmethod
    def build(parameters: Strict, setting: Setting) -> Stages:
        """The stages that this effect adds."""


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
                valid[name] = effect(name).Parameters.model_validate(scene.effects[name], strict=True)
            except ValidationError as error:
                message = first_error(error, effect(name).Parameters, ("effects", name))
                raise SceneError(f"{scene.path}: {message}") from None
    return valid
