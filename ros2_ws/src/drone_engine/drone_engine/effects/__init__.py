"""Effects on bodies: one effect a file, built only for scenes that name it.

An effect is a module with `Parameters`, a Strict model that validates its part of the scene file, and `build`, which
returns its stages. Force stages add to the shared arrays `force` and `torque`, or to `air_velocity` if the module says
`MOVES_AIR = True`. What an effect keeps from step to step belongs into `state.remember`, so that it is part of the
state and its hash; random numbers come from `context.seed` (see noise.py).

To add one to the engine, write the module and its line in EFFECTS. A user's own effect needs neither: the scene names
its module (`effects: {my_package.spring: {...}}`), see docs/extending.md.
"""

import json
from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

from pydantic import ValidationError

from drone_engine.extension import ExtensionError, find, member
from drone_engine.scene.errors import SceneError, first_error
from drone_engine.scene.fields import Strict
from drone_engine.scene.schema import Scene

if TYPE_CHECKING:
    from drone_engine.context import Context, Stages

EFFECTS = {  # in the order in which they run: first those that move the air
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
AIR = ("wind", "gusts", "downwash")  # built-in effects that move the air; they run before all others
THRUST = ("downwash", "ground_effect")  # built-in effects that need the thrust of each rotor
UNSTEADY = ("gusts", "downwash")  # built-in effects that may move bodies at rest, so that nothing may sleep
STABLE = 0.4  # largest share of a body's momentum that one drag may remove in a sub-step, as several may act at once


class Effect(Protocol):
    """The contents of an effect's module."""

    Parameters: type[Strict]

    @staticmethod
    def build(parameters: Strict, context: "Context") -> "Stages":
        """The stages that this effect adds."""


def weight(active: Mapping[str, Strict]) -> float:
    """The acceleration of gravity of these effects, m/s^2; 0 without gravity."""
    return float(getattr(active.get("gravity"), "acceleration", 0.0))


def effect(name: str, scene: Scene | None = None) -> Effect:
    """The module of an effect, imported on first use; a user's one needs the scene that names it. Raises SceneError."""
    if name in EFFECTS or scene is None:
        return cast(Effect, import_module(EFFECTS[name]))
    try:
        module = find("effects", name, scene.folder, tuple(EFFECTS))
        for key in ("Parameters", "build"):
            member(module, name, key)
    except ExtensionError as error:
        raise SceneError(f"{scene.path}: effects.{name}: {error}") from error.__cause__
    return cast(Effect, module)


def moves_air(name: str, scene: Scene) -> bool:
    """Whether an effect changes the velocity of the air. Raises SceneError."""
    return name in AIR or (name not in EFFECTS and bool(getattr(effect(name, scene), "MOVES_AIR", False)))


def unsteady(name: str, scene: Scene) -> bool:
    """Whether an effect may move bodies at rest; a user's effect does, unless it says `UNSTEADY = False`."""
    return name in UNSTEADY or (name not in EFFECTS and bool(getattr(effect(name, scene), "UNSTEADY", True)))


def needs_thrust(active: Mapping[str, Strict]) -> bool:
    """Whether any effect needs the thrust of each rotor: user's effects may."""
    return any(name in THRUST or name not in EFFECTS for name in active)


def parameters(scene: Scene) -> dict[str, Strict]:
    """The parameters of the scene's effects, validated, in the order in which the effects run: those of EFFECTS, then
    the user's as in the scene. Raises SceneError."""
    for name in scene.effects:
        effect(name, scene)
    own = [name for name in scene.effects if name not in EFFECTS]
    valid = {}
    for name in [*(name for name in EFFECTS if name in scene.effects), *own]:
        schema = effect(name, scene).Parameters
        try:
            text = json.dumps(scene.effects[name])  # as in a file: lists for tuples
            valid[name] = schema.model_validate_json(text, strict=True)
        except ValidationError as error:
            raise SceneError(f"{scene.path}: {first_error(error, schema, ('effects', name))}") from None
    return valid
