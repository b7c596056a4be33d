"""The scene file: what it may say, and one-line errors for what it may not.

Lengths in m, angles in rad, masses in kg, time in s. World frame ENU; bodies and cameras look along +x with
z up (REP-103). A pose is [x, y, z] or [x, y, z, roll, pitch, yaw], in the parent's frame, the world's if none.
Effects stay as the scene words them: each effect validates its own parameters (drone_sim.effects).
"""

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, ValidationError, model_validator

from drone_sim.assets import asset_path
from drone_sim.scene_text import as_json

FILE_SIZE_LIMIT = 1 << 20  # bytes; a scene is text that a person wrote

Vector = tuple[float, float, float]
Unit = Annotated[float, Field(ge=0.0, le=1.0)]
Colour = tuple[Unit, Unit, Unit]
Rate = Annotated[float, Field(gt=0.0, le=10_000.0)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=100)]
Topic = Annotated[str, Field(pattern=r"^/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*$", max_length=200)]
Mass = Annotated[float, Field(ge=1e-6, le=1e9)]  # kg
Pose = tuple[float, float, float, float, float, float]
ORIGIN: Pose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class SceneError(ValueError):
    """What is wrong with a scene, in one line: the file, the key, what was expected."""


class Strict(BaseModel):
    """Unknown keys, strings for numbers and non-finite numbers are errors; nothing changes after loading."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Rates(Strict):
    """Hz; physics and drawing do not depend on each other."""

    physics: Rate = 30.0
    draw: Rate = 60.0


class Collision(Strict):
    """How contacts are found. Level 'none' is for what touches nothing, 'floor' for a horizontal plane."""

    level: Literal["none", "floor", "obb"] = "obb"


class Dynamics(Strict):
    """How motion is integrated: the scheme, and how many times the contacts are solved within a step."""

    integrator: Literal["semi_implicit_euler"] = "semi_implicit_euler"
    substeps: Annotated[int, Field(ge=1, le=64)] = 8


class Flight(Strict):
    """Makes a body a drone: the topic that commands it, and what its rotors can do."""

    model: Literal["direct"] = "direct"
    cmd_vel: Topic = "cmd_vel"
    max_speed: PositiveFloat = 8.0  # m/s
    max_acceleration: PositiveFloat = 8.0  # m/s^2, beyond what carries the weight
    max_yaw_rate: PositiveFloat = 2.5  # rad/s


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
    collision: Collision | None = None  # the scene's, if not given
    flight: Flight | None = None
    rotor: Rotor | None = None
    patrol: Patrol | None = None
    shading: Literal["lit", "water"] = "lit"

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if self.parent is None and self.static == (self.mass is not None):
            raise ValueError("needs either 'mass' (it moves) or 'static: true' (it does not)")
        if self.parent is not None and (self.static or self.mass is not None or self.collision or self.flight):
            raise ValueError("has a 'parent', so 'static', 'mass', 'collision' and 'flight' belong there")
        if self.flight and self.static:
            raise ValueError("'flight' needs an object that moves")
        if self.patrol and not self.flight:
            raise ValueError("'patrol' needs 'flight'")
        if self.rotor and self.parent is None:
            raise ValueError("'rotor' needs a 'parent' that flies")
        return self


class Light(Strict):
    """A point light. It shines on everything around it but its own parent."""

    parent: Name | None = None
    pose: Pose = ORIGIN
    colour: Colour = (1.0, 1.0, 1.0)
    intensity: PositiveFloat = 1.0
    reach: PositiveFloat | None = None  # m at which half of it is left; without it, distance does not weaken it


class Orbit(Strict):
    """A circle around the parent, or around the pose where there is none, looking at its centre."""

    radius: PositiveFloat
    height: float
    period: PositiveFloat  # s


class Camera(Strict):
    """A pinhole camera. Its picture is <name>'s; its optical frame is <name>_optical."""

    parent: Name | None = None
    pose: Pose = ORIGIN
    size: tuple[int, int] = (640, 480)  # pixels
    fov: Annotated[float, Field(gt=0.05, lt=3.0)] = 1.2  # rad, horizontal
    near: PositiveFloat = 0.05  # m
    far: PositiveFloat = 1000.0  # m
    level: bool = False  # takes the parent's position and heading only, not its tilt
    look_at: Name | None = None  # turns towards this object
    orbit: Orbit | None = None

    @model_validator(mode="after")
    def _drawable(self) -> Self:
        if not all(16 <= side <= 4096 for side in self.size):
            raise ValueError("'size' needs two numbers of pixels from 16 to 4096")
        if self.near >= self.far:
            raise ValueError("'near' must be less than 'far'")
        return self


class Sky(Strict):
    """What is seen where nothing stands: colours from the horizon up, and clouds that drift."""

    horizon: Colour = (0.76, 0.86, 0.94)
    zenith: Colour = (0.22, 0.45, 0.78)
    clouds: str | None = None  # a texture; its alpha is the cover
    drift: tuple[float, float] = (0.004, 0.001)  # of the texture per s


class Water(Strict):
    """How objects with 'shading: water' look."""

    deep: Colour = (0.02, 0.16, 0.24)
    shallow: Colour = (0.10, 0.45, 0.48)
    wave_height: Unit = 0.15  # of the wave's length
    wave_speed: float = 1.0


class Render(Strict):
    """What the picture is made of; what is not named is not in any shader."""

    ambient: Colour = (0.30, 0.34, 0.40)
    sky: Sky | None = None
    water: Water | None = None
    normal_mapping: dict[str, None] | None = None
    specular: dict[str, None] | None = None

    def features(self) -> list[str]:
        """Names of what the scene calls for."""
        return [name for name in ("sky", "water", "normal_mapping", "specular") if getattr(self, name) is not None]


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
    effects: dict[Name, dict[str, Any]] = {}
    render: Render = Render()
    objects: dict[Name, Object]
    lights: dict[Name, Light] = {}
    cameras: dict[Name, Camera] = {}

    name: str = "scene"
    path: Path = Path("scene.yaml")
    hash: str = ""  # SHA-256 over this file and the models that it names, hexadecimal

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
    def _floors(self) -> Self:
        for name, thing in self.objects.items():
            if thing.mass is not None and (thing.collision or self.collision).level == "floor":
                raise ValueError(f"objects.{name}.collision.level: a 'floor' does not move, so it has no 'mass'")
        return self

    @model_validator(mode="after")
    def _parents(self) -> Self:
        for key, thing in self._things():
            for what in ("parent", "look_at"):
                name = getattr(thing, what, None)
                if name is not None and name not in self.objects:
                    raise ValueError(f"{key}.{what}: no object is called '{name}'")
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

    def _things(self) -> Iterator[tuple[str, Object | Light | Camera]]:
        for kind in ("objects", "lights", "cameras"):
            for name, thing in getattr(self, kind).items():
                yield f"{kind}.{name}", thing

    def model_path(self, name: str) -> Path:
        """File of the model of an object: in the folder models beside the scene's, or among the assets.

        Raises SceneError if there is none.
        """
        return asset_path("models", f"{self.objects[name].model}.obj", SceneError, beside=self.path.parent.parent)


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
        raise SceneError(f"{path}: {first_error(error)}") from None
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
    return scene.model_copy(update={"hash": digest.hexdigest()})


def first_error(error: ValidationError, prefix: tuple[str, ...] = (), model: type[BaseModel] | None = None) -> str:
    """The first thing that is wrong, in one line: its key, and what was expected."""
    first = error.errors(include_url=False)[0]
    loc = (*prefix, *first["loc"])
    message = first["msg"].removeprefix("Value error, ")
    if first["type"] == "extra_forbidden":
        message = "unknown key"
        if model := model or _model_at(loc[:-1]):
            message += "; allowed are " + (", ".join(sorted(model.model_fields)) or "none")
    elif first["type"] not in ("value_error", "missing"):
        message += f", got {str(first['input'])[:60]!r}"
    key = ".".join(str(part) for part in loc)
    return f"{key}: {message}" if key else message


def _model_at(loc: tuple[int | str, ...]) -> type[BaseModel] | None:
    """The part of the scene that a key path stands in."""
    kinds: dict[str, type[BaseModel]] = {
        "rates": Rates, "collision": Collision, "dynamics": Dynamics, "render": Render, "flight": Flight,
        "rotor": Rotor, "patrol": Patrol, "orbit": Orbit, "sky": Sky, "water": Water}
    named: dict[str, type[BaseModel]] = {"objects": Object, "lights": Light, "cameras": Camera}
    if not loc:
        return Scene
    if len(loc) == 2 and loc[0] in named:
        return named[str(loc[0])]
    return kinds.get(str(loc[-1]))
