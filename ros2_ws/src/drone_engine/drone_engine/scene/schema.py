"""Schema of a scene file.

Lengths in m, angles in rad, masses in kg, time in s. World frame ENU; bodies and cameras look along +x with z up
(REP-103). A pose is [x, y, z] or [x, y, z, roll, pitch, yaw] in the parent's frame, the world's if there is none.
Parameters of effects are kept as they are: each effect validates its own (drone_engine.effects).
"""

import json
import re
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PositiveFloat, TypeAdapter, ValidationError, model_validator

from drone_engine.scene import files, validation
from drone_engine.scene.airframe import Airframe
from drone_engine.scene.errors import SceneError, first_error, quoted
from drone_engine.scene.fields import FOUND, ORIGIN, Extension, Mass, Name, Pose, Rate, Strict, Topic, Unit, Vector
from drone_engine.scene.picture import Camera, Light, Render
from drone_engine.scene.shorthand import as_json
from drone_engine.scene.strict_yaml import read_yaml

FILE_SIZE_LIMIT = 1 << 20  # bytes; a scene file is written by hand


class Rates(Strict):
    """Steps of the physics and pictures, in Hz; neither depends on the other."""

    physics: Rate = 30.0
    draw: Rate = 60.0


Contacts = Literal["first", "all"]
PairLevel = Literal["sphere", "obb", "octree", "triangle"]  # from coarse to exact
Level = Literal["none", "floor", "ground", PairLevel]


class Pair(Strict):
    """Collision level of two objects, whatever the scene and the objects set; 'none': they pass through each other."""

    between: tuple[Name, Name]  # objects, or groups made by 'poses'
    level: Literal["none", PairLevel]
    contacts: Contacts | None = None


class Collision(Strict):
    """How contacts are found. Level 'none': touches nothing; 'floor': a horizontal plane; 'ground': a height field, the
    upper surface of a model."""

    level: Level = "obb"
    contacts: Contacts = "all"  # 'first': only the deepest point of each pair
    pairs: tuple[Pair, ...] = ()


class ObjectCollision(Strict):
    """Setting of one object: of two objects the finer applies; where neither has one, the scene's."""

    level: Level | None = None
    contacts: Contacts | None = None


class Dynamics(Strict):
    """How motion is integrated and contacts are solved."""

    integrator: Literal["semi_implicit_euler", "midpoint", "rk4"] = "midpoint"  # of order 1, 2, 4
    substeps: Annotated[int, Field(ge=1, le=64)] = 8  # per step: each evaluates forces and solves contacts
    passes: Annotated[int, Field(ge=1, le=1000)] = 50  # solver iterations per sub-step over contacts at rest, at most
    sleep: bool = True  # whether bodies at rest are skipped until something touches them


FLIGHT_MODELS = ("direct", "quadrotor")  # built in


class Flight(Strict):
    """Makes an object a drone: the topic of its commands, and its limits."""

    model: Extension = "direct"  # one of FLIGHT_MODELS, or a user's own
    parameters: dict[str, Any] = Field(default_factory=dict)  # of a user's own flight model, which validates them
    controller: dict[Extension, dict[str, Any]] = Field(default_factory=dict)  # a user's own; gives the commands
    cmd_vel: Topic = "cmd_vel"
    max_speed: PositiveFloat = 8.0  # m/s
    max_acceleration: PositiveFloat = 8.0  # m/s^2, in addition to hovering
    max_yaw_rate: PositiveFloat = 2.5  # rad/s
    quadrotor: Airframe | None = None  # for 'model: quadrotor': differences from the default airframe

    @model_validator(mode="after")
    def _airframe(self) -> Self:
        if self.quadrotor and self.model != "quadrotor":
            raise ValueError("'quadrotor' needs 'model: quadrotor'")
        if self.parameters and self.model in FLIGHT_MODELS:
            raise ValueError(f"'parameters' are of a flight model of your own, not of '{self.model}'")
        if len(self.controller) > 1:
            raise ValueError(f"controller: expected one, got {', '.join(self.controller)}")
        return self


class Rotor(Strict):
    """Makes a child of a drone rotate about its z axis; direction 1 is counter-clockwise seen from above."""

    direction: Literal[1, -1]
    speed: PositiveFloat = 60.0  # rad/s in flight


class Patrol(Strict):
    """Waypoints in the world frame that the computer's pilot visits in turn, endlessly."""

    waypoints: Annotated[tuple[Vector, ...], Field(min_length=2)]
    speed: PositiveFloat = 2.0  # m/s
    min_height: PositiveFloat = 1.0  # m above the floor


class Object(Strict):
    """One thing in the scene. With a parent it is a part of that, without mass and collision of its own."""

    model: str
    parent: Name | None = None
    pose: Pose = ORIGIN
    static: bool = False
    mass: Mass | None = None
    friction: Annotated[float, Field(ge=0.0)] = 0.6
    restitution: Unit = 0.2
    collision: ObjectCollision = ObjectCollision()
    flight: Flight | None = None
    rotor: Rotor | None = None
    patrol: Patrol | None = None
    behavior: dict[Extension, dict[str, Any]] = Field(default_factory=dict)  # a user's own objects, called every step
    shading: Literal["lit", "water"] = "lit"

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if self.parent is None and self.static == (self.mass is not None):
            raise ValueError("expected either 'mass' (it moves) or 'static: true' (it does not)")
        if self.parent is not None and (self.static or self.mass is not None or "collision" in self.model_fields_set
                                        or self.flight):
            raise ValueError("has a 'parent', so 'static', 'mass', 'collision' and 'flight' must be set there")
        if self.flight and self.static:
            raise ValueError("'flight' needs an object that moves")
        if self.behavior and (self.parent is not None or self.static):
            raise ValueError("'behavior' needs an object that moves, so one with 'mass'")
        if self.patrol and not self.flight:
            raise ValueError("'patrol' needs 'flight'")
        if self.rotor and self.parent is None:
            raise ValueError("'rotor' needs a 'parent' that flies")
        return self


class Scene(Strict):
    """A whole scene; loading.py reads one from a file, or makes one from data in Python.

    A thing with 'poses' in the file, instead of a 'pose', is several things here: <name>_0, <name>_1, ...
    """

    version: Literal[1]
    description: str = ""
    seed: Annotated[int, Field(ge=0, lt=1 << 63)] = 0
    rates: Rates = Rates()
    collision: Collision = Collision()
    dynamics: Dynamics = Dynamics()
    effects: dict[Extension, dict[str, Any]] = Field(default_factory=dict)
    render: Render = Render()
    objects: dict[Name, Object]
    lights: dict[Name, Light] = Field(default_factory=dict)
    cameras: dict[Name, Camera] = Field(default_factory=dict)

    name: Annotated[str, FOUND] = "scene"
    path: Annotated[Path, FOUND] = Path("scene.yaml")  # the file; of a scene made in Python, its name
    hash: Annotated[str, FOUND] = ""  # SHA-256 over the file, or the data, and the models, in hexadecimal
    folder: Annotated[Path, FOUND] = Path()  # where modules of the user's own effects are searched
    assets: Annotated[Path | None, FOUND] = None  # its folders models/ and textures/ are searched before the shipped
    files: Annotated[dict[str, Path], FOUND] = Field(default_factory=dict)  # of models and textures given by path

    @model_validator(mode="after")
    def _checked(self) -> Self:
        validation.check(self)
        return self

    def level(self, name: str) -> Level:
        """The collision level of an object: its own, else the scene's."""
        return self.objects[name].collision.level or self.collision.level

    def named(self, name: str) -> list[str]:
        """Names of the objects that a name stands for: the object, or else the group made by its 'poses'."""
        group = re.compile(rf"{re.escape(name)}_\d+")
        return [name] if name in self.objects else [other for other in self.objects if group.fullmatch(other)]

    def model_path(self, name: str) -> Path:
        """File of the model of an object. Raises SceneError if there is none."""
        return files.model_path(self, name)

    def with_cameras(self, text: str) -> "Scene":
        """The scene with more cameras, in YAML as under 'cameras'; equal names replace. Raises SceneError."""
        if len(text) > FILE_SIZE_LIMIT:
            raise SceneError(f"cameras: expected at most {FILE_SIZE_LIMIT} characters")
        kind = dict[Name, Camera]
        try:
            given = json.loads(as_json({"cameras": read_yaml(text.encode())}))["cameras"]
            if not given or not isinstance(given, dict):
                raise SceneError("cameras: expected one or more by name, such as 'side: {pose: [0, 0, 2]}', got "
                                 + quoted(given or None))
            added = TypeAdapter(kind).validate_json(json.dumps(given), strict=True)
        except ValidationError as error:
            raise SceneError(first_error(error, kind, ("cameras",))) from None
        except ValueError as error:
            raise SceneError(str(error)) from None
        try:
            return Scene.model_validate({**dict(self), "cameras": {**self.cameras, **added}})
        except ValidationError as error:
            raise SceneError(first_error(error, Scene)) from None
