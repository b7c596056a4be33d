"""Checks of a scene that concern several keys at once: names, parents, levels and pairs."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from drone_engine.scene.picture import Camera, Light
    from drone_engine.scene.schema import Object, Scene

CAMERA_LIMIT = 64  # each has six topics, which every node of the graph discovers


def check(scene: "Scene") -> None:
    """Raises ValueError in one line, with the key, for the first flaw."""
    _check_frames(scene)
    if len(scene.cameras) > CAMERA_LIMIT:
        raise ValueError(f"cameras: expected at most {CAMERA_LIMIT}, got {len(scene.cameras)}")
    _check_levels(scene)
    _check_parents(scene)
    _check_pairs(scene)


def _things(scene: "Scene") -> Iterator[tuple[str, "Object | Light | Camera"]]:
    for kind in ("objects", "lights", "cameras"):
        for name, thing in getattr(scene, kind).items():
            yield f"{kind}.{name}", thing


def _check_frames(scene: "Scene") -> None:
    """Objects and cameras are frames of one tree, whose names must differ."""
    for key, _ in _things(scene):
        if key.endswith(".world"):
            raise ValueError(f"{key}: 'world' is the root frame; nothing else may have its name")
    frames = set(scene.objects)
    for name in scene.cameras:
        for frame in (name, f"{name}_optical"):
            if frame in frames:
                raise ValueError(f"cameras.{name}: another frame is called '{frame}'")
            frames.add(frame)


def _check_levels(scene: "Scene") -> None:
    """Planes and terrain are static, and there is one terrain at most."""
    for name, thing in scene.objects.items():
        level = scene.level(name)
        if thing.mass is not None and level in ("floor", "ground"):
            raise ValueError(f"objects.{name}.collision.level: a '{level}' is static, so it must not have a 'mass'")
    if len(grounds := [name for name in scene.objects if scene.level(name) == "ground"]) > 1:
        raise ValueError(f"objects.{grounds[1]}.collision.level: expected one 'ground' in a scene, and "
                         f"'{grounds[0]}' is it already")


def _check_parents(scene: "Scene") -> None:
    """Parents and targets exist; no object is its own ancestor; rotors belong to drones."""
    for key, thing in _things(scene):
        for what in ("parent", "look_at"):
            name = getattr(thing, what, None)
            if name is not None and name not in scene.objects:
                raise ValueError(f"{key}.{what}: no object is called '{name}'")
    sky = scene.render.sky
    if sky and sky.parent is not None and sky.parent not in scene.objects:
        raise ValueError(f"render.sky.parent: no object is called '{sky.parent}'")
    for name, thing in scene.objects.items():
        seen = {name}
        while thing.parent is not None:
            if thing.parent in seen:
                raise ValueError(f"objects.{name}.parent: is its own ancestor")
            seen.add(thing.parent)
            thing = scene.objects[thing.parent]
        if scene.objects[name].rotor and not thing.flight:
            raise ValueError(f"objects.{name}.rotor: '{scene.objects[name].parent}' does not fly")


def _check_pairs(scene: "Scene") -> None:
    """Pairs name objects, or groups of objects, without parents."""
    for i, pair in enumerate(scene.collision.pairs):
        for name in pair.between:
            if not scene.named(name):
                raise ValueError(f"collision.pairs.{i}.between: no object is called '{name}'")
            if any(scene.objects[object_].parent for object_ in scene.named(name)):
                raise ValueError(f"collision.pairs.{i}.between: '{name}' is part of another object; name that one")
