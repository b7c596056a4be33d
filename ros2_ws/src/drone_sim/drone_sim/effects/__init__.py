"""What acts on bodies, one effect a file, built only if the scene names it.

An effect's module has `Parameters`, what the scene may say of it, and `build`, which returns the function that the
step calls. To add one, write its file and its line here.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

from pydantic import ValidationError

from drone_sim.arrays import Floats
from drone_sim.scene import Scene, SceneError
from drone_sim.strict import Strict, first_error

if TYPE_CHECKING:
    from drone_sim.model import Model
    from drone_sim.stage import Stage
    from drone_sim.state import State

EFFECTS = {
    "gravity": "drone_sim.effects.gravity",
    "drag": "drone_sim.effects.drag",
}


class Effect(Protocol):
    """What an effect's module offers."""

    Parameters: type[Strict]

    @staticmethod
    def build(parameters: Strict, model: "Model", state: "State", force_w: Floats, dt: float) -> "Stage":
        """The function that adds this effect's forces, (n, 3) N in the world, to force_w, once a step of dt s."""


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
