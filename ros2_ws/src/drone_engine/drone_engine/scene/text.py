"""The text of a scene file as JSON: YAML without its traps, and with the shorthands of a scene spelt out."""

import json
import re
from typing import Any

import yaml

DEPTH_LIMIT = 32  # levels; far below what overflows the stack of PyYAML, which recurses in C


def as_json(text: bytes, under: str | None = None) -> str:
    """The same in JSON, with one object for each of several 'poses'; with `under`, as what a scene says under that key.

    Raises ValueError in one line: where, and what is wrong with it.
    """
    try:
        _check_events(text)
        data = yaml.load(text, Loader=_StrictLoader)
        return json.dumps(_spell_out(data if under is None else {under: data}), default=str)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        lines = len(text.splitlines()) or 1  # what is left open is missed behind the last one
        where = f"line {min(mark.line + 1, lines)}: " if mark else ""
        raise ValueError(f"{where}{getattr(error, 'problem', None) or str(error).splitlines()[0]}") from None
    except TypeError as error:  # a key that is none in JSON, such as a date
        raise ValueError(str(error)) from None


def _check_events(text: bytes) -> None:
    """Raises YAMLError for aliases and for what is nested too deep."""
    depth = 0
    for event in yaml.parse(text, Loader=yaml.CSafeLoader):
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > DEPTH_LIMIT:
            raise _error(f"nested in more than {DEPTH_LIMIT} levels", event.start_mark)
        if isinstance(event, yaml.AliasEvent):
            raise _error(f"YAML aliases are not allowed ('*{event.anchor}')", event.start_mark)


def _error(problem: str, mark: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=mark)


class _StrictLoader(yaml.CSafeLoader):
    """PyYAML keeps the last of two equal keys without a word; here that is an error, as is every bad scalar. And 1e3 is
    a number, as in YAML 1.2."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                if key.value in seen:
                    raise _error(f"'{key.value}' stands here twice", key.start_mark)
                seen.add(key.value)
        return super().construct_mapping(node, deep)

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ArithmeticError, AttributeError, LookupError, ValueError):  # which PyYAML lets through
            problem = f"not a valid {node.tag.rpartition(':')[2]}: {str(node.value)[:60]!r}"
            raise _error(problem, node.start_mark) from None


_StrictLoader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)[eE][-+]?\d+$"), list("-+.0123456789"))


def _spell_out(data: Any) -> Any:
    """Objects with 'poses' become one object a pose, and poses of three numbers get their three angles.

    Raises ValueError where that is not clear.
    """
    if not isinstance(data, dict):
        return data
    spelt = dict(data)
    for kind in ("objects", "lights", "cameras"):
        if isinstance(data.get(kind), dict):
            spelt[kind] = {name: _with_angles(thing) for name, thing in _one_a_pose(kind, data[kind]).items()}
    return spelt


def _one_a_pose(kind: str, things: dict[Any, Any]) -> dict[Any, Any]:
    single = {name: thing for name, thing in things.items() if not (isinstance(thing, dict) and "poses" in thing)}
    spelt: dict[Any, Any] = {}
    for name, thing in things.items():
        if name in single:
            spelt[name] = thing
            continue
        if "pose" in thing:
            raise ValueError(f"{kind}.{name}: has both 'pose' and 'poses'")
        poses = thing["poses"]
        if not isinstance(poses, list) or not poses:
            raise ValueError(f"{kind}.{name}.poses: needs a list of poses")
        shared = {key: value for key, value in thing.items() if key != "poses"}
        several = {f"{name}_{i}": {**shared, "pose": pose} for i, pose in enumerate(poses)}
        if twice := several.keys() & {**single, **spelt}.keys():
            raise ValueError(f"{kind}.{min(twice)}: stands here twice, once among the poses of '{name}'")
        spelt |= several
    return spelt


def _with_angles(thing: Any) -> Any:
    if isinstance(thing, dict) and isinstance(thing.get("pose"), list) and len(thing["pose"]) == 3:
        return {**thing, "pose": [*thing["pose"], 0.0, 0.0, 0.0]}
    return thing
