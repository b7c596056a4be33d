"""Shorthands of scenes: 'poses' for several equal things, and poses of three numbers."""

import json
from typing import Any

from drone_engine.scene.errors import quoted


def as_json(data: Any) -> str:
    """A scene's data with its shorthands expanded, as JSON text. Raises ValueError in one line."""
    try:
        return json.dumps(expand(data), default=str)
    except TypeError as error:  # a key that JSON does not allow, such as a date
        raise ValueError(str(error)) from None


def expand(data: Any) -> Any:
    """One object, light or camera for each of its 'poses'; poses of three numbers get three angles of 0.

    Raises ValueError where a shorthand is ambiguous. Data that are no mapping are returned as they are.
    """
    if not isinstance(data, dict):
        return data
    expanded = dict(data)
    for kind in ("objects", "lights", "cameras"):
        if isinstance(data.get(kind), dict):
            expanded[kind] = {name: _with_angles(thing) for name, thing in _one_a_pose(kind, data[kind]).items()}
    return expanded


def _one_a_pose(kind: str, things: dict[Any, Any]) -> dict[Any, Any]:
    single = {name: thing for name, thing in things.items() if not (isinstance(thing, dict) and "poses" in thing)}
    expanded: dict[Any, Any] = {}
    for name, thing in things.items():
        if name in single:
            expanded[name] = thing
            continue
        if "pose" in thing:
            raise ValueError(f"{kind}.{name}: expected either 'pose' or 'poses', got both")
        poses = thing["poses"]
        if not isinstance(poses, list) or not poses:
            raise ValueError(f"{kind}.{name}.poses: expected a list of poses, got {quoted(poses)}")
        shared = {key: value for key, value in thing.items() if key != "poses"}
        several = {f"{name}_{i}": {**shared, "pose": pose} for i, pose in enumerate(poses)}
        if twice := several.keys() & {**single, **expanded}.keys():
            raise ValueError(f"{kind}.{min(twice)}: defined twice, once by the 'poses' of '{name}'")
        expanded |= several
    return expanded


def _with_angles(thing: Any) -> Any:
    if isinstance(thing, dict) and isinstance(thing.get("pose"), list) and len(thing["pose"]) == 3:
        return {**thing, "pose": [*thing["pose"], 0.0, 0.0, 0.0]}
    return thing
