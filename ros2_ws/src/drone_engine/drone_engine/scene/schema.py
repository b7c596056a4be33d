"""The scene file: what it may say, and one-line errors for what it may not.

Lengths in m, angles in rad, masses in kg, time in s. World frame ENU; bodies and cameras look along +x with
z up (REP-103). A pose is [x, y, z] or [x, y, z, roll, pitch, yaw], in the parent's frame, the world's if none.
Effects stay as the scene words them: each effect validates its own parameters (drone_engine.effects).
"""

import hashlib
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PositiveFloat, TypeAdapter, ValidationError, model_validator

from drone_engine.assets import asset_path
from drone_engine.images import image_flaw
from drone_engine.scene.airframe import Airframe
from drone_engine.scene.fields import (
    FOUND,
    ORIGIN,
    Mass,
    Name,
    Pose,
    Rate,
    Strict,
    Topic,
    Unit,
    Vector,
    first_error,
    quoted,
)
from drone_engine.scene.picture import Camera, Light, Render
from drone_engine.scene.text import as_json

FILE_SIZE_LIMIT = 1 << 20  # bytes; a scene is text that a person wrote
CAMERA_LIMIT = 64  # each has six topics, which every node of the graph learns of

class SceneError(ValueError):
    """What is wrong with a scene, in one line: the file, the key, what was expected."""


class Rates(Strict):
    """Hz; physics and drawing do not depend on each other."""

    physics: Rate = 30.0
    draw: Rate = 60.0


Contacts = Literal["first", "all"]
MeetingLevel = Literal["sphere", "obb", "octree", "triangle"]  # each refines the one before
Level = Literal["none", "floor", "ground", MeetingLevel]


class Pair(Strict):
    """How two objects meet, whatever the scene and they themselves say; 'none': not at all."""

    between: tuple[Name, Name]  # a group's name stands for all of it
    level: Literal["none", MeetingLevel]
    contacts: Contacts | None = None


class Collision(Strict):
    """How contacts are found. Level 'none' is for what touches nothing, 'floor' for a horizontal plane,
    'ground' for the upper surface of a model."""

    level: Level = "obb"
    contacts: Contacts = "all"  # 'first': the deepest point of a pair alone
    pairs: tuple[Pair, ...] = ()


class OwnCollision(Strict):
    """What an object says of itself: the finer of two objects' words decides, the scene's where both are silent."""

    level: Level | None = None
    contacts: Contacts | None = None


class Dynamics(Strict):
    """How motion is integrated, and how well contacts are met."""

    integrator: Literal["semi_implicit_euler", "midpoint", "rk4"] = "midpoint"  # of order 1, 2, 4
    substeps: Annotated[int, Field(ge=1, le=64)] = 8  # of a step: forces, contacts and motion happen in each
    passes: Annotated[int, Field(ge=1, le=1000)] = 50  # over the calm contacts of a sub-step, at most
    sleep: bool = True  # whether what rests is left out until something touches it


class Flight(Strict):
    """Makes a body a drone: the topic that commands it, and what its rotors can do."""

    model: Literal["direct", "quadrotor"] = "direct"
    cmd_vel: Topic = "cmd_vel"
    max_speed: PositiveFloat = 8.0  # m/s
    max_acceleration: PositiveFloat = 8.0  # m/s^2, beyond what carries the weight
    max_yaw_rate: PositiveFloat = 2.5  # rad/s
    quadrotor: Airframe | None = None  # of the flight model of that name: what is not the published one's

    @model_validator(mode="after")
    def _airframe(self) -> Self:
        if self.quadrotor and self.model != "quadrotor":
            raise ValueError("'quadrotor' needs 'model: quadrotor'")
        return self


class Rotor(Strict):
    """Makes a child of a drone turn about its own z axis; direction 1 is counter-clockwise seen from above."""

    direction: Literal[1, -1]
    speed: PositiveFloat = 60.0  # rad/s in flight


class Patrol(Strict):
    """Where the program flies a drone: points in the world frame, one after the other, again and again."""

    waypoints: Annotated[tuple[Vector, ...], Field(min_length=2)]
    speed: PositiveFloat = 2.0  # m/s
    min_height: PositiveFloat = 1.0  # m above the floor


class Object(Strict):
    """One thing of the scene. With a parent it is part of that, and has no mass or collision of its own."""

    model: str
    parent: Name | None = None
    pose: Pose = ORIGIN
    static: bool = False
    mass: Mass | None = None
    friction: Annotated[float, Field(ge=0.0)] = 0.6
    restitution: Unit = 0.2
    collision: OwnCollision = OwnCollision()
    flight: Flight | None = None
    rotor: Rotor | None = None
    patrol: Patrol | None = None
    shading: Literal["lit", "water"] = "lit"

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if self.parent is None and self.static == (self.mass is not None):
            raise ValueError("needs either 'mass' (it moves) or 'static: true' (it does not)")
        if self.parent is not None and (self.static or self.mass is not None or "collision" in self.model_fields_set
                                        or self.flight):
            raise ValueError("has a 'parent', so 'static', 'mass', 'collision' and 'flight' belong there")
        if self.flight and self.static:
            raise ValueError("'flight' needs an object that moves")
        if self.patrol and not self.flight:
            raise ValueError("'patrol' needs 'flight'")
        if self.rotor and self.parent is None:
            raise ValueError("'rotor' needs a 'parent' that flies")
        return self


class Scene(Strict):
    """A whole scene; `load` reads one from a file.

    An object with 'poses' in the file, instead of a 'pose', is here several: <name>_0, <name>_1, ...
    """

    version: Literal[1]
    description: str = ""
    seed: Annotated[int, Field(ge=0, lt=1 << 63)] = 0
    rates: Rates = Rates()
    collision: Collision = Collision()
    dynamics: Dynamics = Dynamics()
    effects: dict[Name, dict[str, Any]] = Field(default_factory=dict)
    render: Render = Render()
    objects: dict[Name, Object]
    lights: dict[Name, Light] = Field(default_factory=dict)
    cameras: dict[Name, Camera] = Field(default_factory=dict)

    name: Annotated[str, FOUND] = "scene"
    path: Annotated[Path, FOUND] = Path("scene.yaml")
    hash: Annotated[str, FOUND] = ""  # SHA-256 over this file and the models that it names, hexadecimal

    @model_validator(mode="after")
    def _frames(self) -> Self:
        for key, _ in self._things():
            if key.endswith(".world"):
                raise ValueError(f"{key}: everything stands in the frame 'world', so nothing else is called that")
        frames = set(self.objects)
        for name in self.cameras:
            for frame in (name, f"{name}_optical"):
                if frame in frames:
                    raise ValueError(f"cameras.{name}: another frame is called '{frame}'")
                frames.add(frame)
        return self

    @model_validator(mode="after")
    def _few_cameras(self) -> Self:
        if len(self.cameras) > CAMERA_LIMIT:
            raise ValueError(f"cameras: {len(self.cameras)} are more than the {CAMERA_LIMIT} that a scene may have")
        return self

    @model_validator(mode="after")
    def _floors(self) -> Self:
        for name, thing in self.objects.items():
            level = self.level(name)
            if thing.mass is not None and level in ("floor", "ground"):
                raise ValueError(f"objects.{name}.collision.level: a '{level}' does not move, so it has no 'mass'")
        if len(grounds := [name for name in self.objects if self.level(name) == "ground"]) > 1:
            raise ValueError(f"objects.{grounds[1]}.collision.level: '{grounds[0]}' is the scene's 'ground' already")
        return self

    @model_validator(mode="after")
    def _parents(self) -> Self:
        for key, thing in self._things():
            for what in ("parent", "look_at"):
                name = getattr(thing, what, None)
                if name is not None and name not in self.objects:
                    raise ValueError(f"{key}.{what}: no object is called '{name}'")
        if self.render.sky and self.render.sky.parent is not None and self.render.sky.parent not in self.objects:
            raise ValueError(f"render.sky.parent: no object is called '{self.render.sky.parent}'")
        for name, thing in self.objects.items():
            seen = {name}
            while thing.parent is not None:
                if thing.parent in seen:
                    raise ValueError(f"objects.{name}.parent: is its own ancestor")
                seen.add(thing.parent)
                thing = self.objects[thing.parent]
            if self.objects[name].rotor and not thing.flight:
                raise ValueError(f"objects.{name}.rotor: '{self.objects[name].parent}' does not fly")
        return self

    @model_validator(mode="after")
    def _pairs(self) -> Self:
        for i, pair in enumerate(self.collision.pairs):
            for name in pair.between:
                if not self.named(name):
                    raise ValueError(f"collision.pairs.{i}.between: no object is called '{name}'")
                if any(self.objects[object_].parent for object_ in self.named(name)):
                    raise ValueError(f"collision.pairs.{i}.between: '{name}' is a part of another object; name that")
        return self

    def level(self, name: str) -> Level:
        """The collision level of an object, its own or the scene's."""
        return self.objects[name].collision.level or self.collision.level

    def named(self, name: str) -> list[str]:
        """The object of that name, or the objects of the group."""
        group = re.compile(rf"{re.escape(name)}_\d+")
        return [name] if name in self.objects else [other for other in self.objects if group.fullmatch(other)]

    def with_cameras(self, text: str) -> "Scene":
        """The same with more cameras, in YAML as under 'cameras'; equal names replace. Raises SceneError."""
        if len(text) > FILE_SIZE_LIMIT:
            raise SceneError(f"cameras: more than {FILE_SIZE_LIMIT} characters, which no camera needs")
        kind = dict[Name, Camera]
        try:
            words = json.loads(as_json(text.encode(), "cameras"))["cameras"]
            if not words or not isinstance(words, dict):
                raise SceneError("cameras: needs one or more by their names, such as 'side: {pose: [0, 0, 2]}', got "
                                 + quoted(words or None))
            added = TypeAdapter(kind).validate_json(json.dumps(words), strict=True)
        except ValidationError as error:
            raise SceneError(first_error(error, kind, ("cameras",))) from None
        except ValueError as error:
            raise SceneError(str(error)) from None
        try:
            return Scene.model_validate({**dict(self), "cameras": {**self.cameras, **added}})
        except ValidationError as error:
            raise SceneError(first_error(error, Scene)) from None

    def _things(self) -> Iterator[tuple[str, Object | Light | Camera]]:
        for kind in ("objects", "lights", "cameras"):
            for name, thing in getattr(self, kind).items():
                yield f"{kind}.{name}", thing

    def model_path(self, name: str) -> Path:
        """File of the model of an object: in the folder models beside the scene's, or among the assets.

        Raises SceneError if there is none.
        """
        return asset_path("models", f"{self.objects[name].model}.obj", SceneError, beside=self.path.parent.parent)

    def texture_path(self, name: Path) -> Path:
        """File of a texture, named with or without its ending: in the folder textures beside the scene's, or among the
        assets. Raises SceneError if there is none."""
        file = str(name) if name.suffix else f"{name}.png"
        return asset_path("textures", file, SceneError, beside=self.path.parent.parent)

    def with_textures(self) -> "Scene":
        """The same with the files of the sky's textures instead of their names. Raises SceneError."""
        if self.render.sky is None:
            return self
        files = {}
        for key in ("colours", "stars", "clouds"):
            if (name := getattr(self.render.sky, key)) is not None:
                try:
                    files[key] = self.texture_path(name)
                except SceneError as error:
                    raise SceneError(f"render.sky.{key}: {error}") from None
                if flaw := image_flaw(files[key]):
                    raise SceneError(f"render.sky.{key}: {files[key]} is not readable: {flaw}")
        sky = self.render.sky.model_copy(update=files)
        return self.model_copy(update={"render": self.render.model_copy(update={"sky": sky})})


def load(scene: str | Path) -> Scene:
    """Reads a scene, given by its name among the assets ('island') or by its file. Raises SceneError."""
    path = Path(scene)
    if path.suffix not in (".yaml", ".yml"):
        path = asset_path("scenes", f"{scene}.yaml", SceneError)
    try:
        with path.open("rb") as file:
            text = file.read(FILE_SIZE_LIMIT + 1)
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror}") from None
    return parse(text, path)


def parse(text: bytes | str, path: Path) -> Scene:
    """Validates the text of a scene file; `path` is what errors name. Raises SceneError."""
    text = text.encode() if isinstance(text, str) else text
    if len(text) > FILE_SIZE_LIMIT:
        raise SceneError(f"{path}: larger than {FILE_SIZE_LIMIT} bytes, which no scene needs")
    try:
        scene = Scene.model_validate_json(as_json(text), strict=True)
    except ValidationError as error:
        raise SceneError(f"{path}: {first_error(error, Scene)}") from None
    except ValueError as error:
        raise SceneError(f"{path}: {error}") from None
    if written := {"name", "path", "hash"} & scene.model_fields_set:
        raise SceneError(f"{path}: {min(written)}: is not for the file to say")
    scene = scene.model_copy(update={"name": path.stem, "path": path.absolute()})
    digest = hashlib.sha256(text)
    for name in scene.objects:
        try:
            digest.update(scene.model_path(name).read_bytes())
        except (OSError, ValueError) as error:
            raise SceneError(f"{path}: objects.{name}.model: {error}") from None
    try:
        scene = scene.with_textures()
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    return scene.model_copy(update={"hash": digest.hexdigest()})
