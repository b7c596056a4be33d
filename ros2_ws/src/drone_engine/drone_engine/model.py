"""What a scene's things are, as arrays: nothing here changes while the scene runs.

Bodies are the objects without a parent that can be touched or can move, in the order of the scene. A body's own
point, whose motion is simulated, is the centre of its box, taken as its centre of mass; its inertia is that of what
its surface encloses.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision_level import LEVELS, OBB, TESTED, UNSET
from drone_engine.geometry import mesh
from drone_engine.geometry.mass_properties import moments
from drone_engine.math.rotation import from_rpy, rotate_all
from drone_engine.scene.fields import Pose
from drone_engine.scene.schema import Flight, Object, Scene, SceneError

FLAT_OR_NOT = ("floor", "ground")  # words of what carries everything
THINNEST, THICKEST = 1e-6, 1e6  # m; sides of what moves, so that its inertia is neither zero nor infinite


@dataclass(frozen=True)
class Bodies:
    """n bodies. SI units; frames: _w the world's, _b the object's own."""

    names: tuple[str, ...]
    movable: Booleans  # (n,)
    solid: Booleans  # (n,) found by the broad phase; not: floors, and what touches nothing
    half: Floats  # (n, 3) half extents of the box
    centre_b: Floats  # (n, 3) where the box's centre is in the object
    mass: Floats  # (n,) 0 for what does not move
    inverse_mass: Floats  # (n,) 0 for what does not move
    inertia_b: Floats  # (n, 3) moments about the axes of the box
    friction: Floats  # (n,)
    restitution: Floats  # (n,)
    start_w: Floats  # (n, 7) pose of the centre at the start

    @property
    def count(self) -> int:
        return len(self.names)


@dataclass(frozen=True)
class Floor:
    """A horizontal plane that carries everything above it; or, with a height of -inf, the scene's ground, which is as
    high as its model."""

    body: int
    height: float  # m


@dataclass(frozen=True)
class CollisionSettings:
    """Collision level and contacts of pairs of bodies: the pair's own, else the finer of the two bodies', else the
    scene's."""

    level: int  # of the scene
    all_contacts: int  # 1, or 0: the deepest point alone
    body_level: Integers  # (n,) of each body, or UNSET
    body_contacts: Integers  # (n,) 1, 0 or UNSET
    pairs: dict[tuple[int, int], tuple[int, int]]  # bodies a < b: level or DISABLED; 1, 0 or UNSET


@dataclass(frozen=True)
class Drones:
    """d bodies that fly."""

    body: Integers  # (d,) index among the bodies
    max_speed: Floats  # (d,) m/s
    max_acceleration: Floats  # (d,) m/s^2
    max_yaw_rate: Floats  # (d,) rad/s
    quadrotor: Booleans  # (d,) of that flight model, else of 'direct'
    flights: tuple[Flight, ...]  # (d,) as the scene says it


@dataclass(frozen=True)
class Rotors:
    """r children of drones that turn about their own z axis."""

    names: tuple[str, ...]
    parents: tuple[str, ...]
    paths: tuple[Path, ...]  # (r,) of their models
    drone: Integers  # (r,) index among the drones
    pose_p: Floats  # (r, 7) in the parent
    rate: Floats  # (r,) rad/s in flight; its sign is the direction


@dataclass(frozen=True)
class Fixed:
    """Everything else: what stands in the world, and children that do not turn."""

    names: tuple[str, ...]
    parents: tuple[str, ...]
    pose_p: Floats  # (k, 7) in the parent


@dataclass(frozen=True)
class Model:
    """A scene in arrays."""

    bodies: Bodies
    paths: tuple[Path, ...]  # (n,) of the bodies' models
    collision: CollisionSettings
    floors: tuple[Floor, ...]
    ground: int | None  # the body that is uneven ground
    drones: Drones
    rotors: Rotors
    fixed: Fixed


def build(scene: Scene) -> Model:
    """Reads the models that the scene names. Raises mesh.MeshError, and SceneError for what moves but is flat."""
    objects = scene.objects
    level = {name: scene.level(name) for name in objects}
    body_names = [name for name, thing in objects.items()
                  if thing.parent is None and (not thing.static or level[name] != "none")]
    drone_names = [name for name in body_names if objects[name].flight]
    rotor_names = [name for name, thing in objects.items() if thing.rotor]
    fixed_names = [name for name, thing in objects.items() if thing.static or (thing.parent and not thing.rotor)]
    return Model(
        bodies=_bodies(scene, body_names, level),
        paths=tuple(scene.model_path(name) for name in body_names),
        collision=_collision_settings(scene, body_names),
        floors=tuple(Floor(i, objects[name].pose[2] if level[name] == "floor" else -math.inf)
                     for i, name in enumerate(body_names) if level[name] in FLAT_OR_NOT),
        ground=next((i for i, name in enumerate(body_names) if level[name] == "ground"), None),
        drones=_drones(objects, body_names, drone_names),
        rotors=Rotors(
            names=tuple(rotor_names),
            parents=tuple(str(objects[name].parent) for name in rotor_names),
            paths=tuple(scene.model_path(name) for name in rotor_names),
            drone=np.array([drone_names.index(_root(objects, name)) for name in rotor_names], np.int64),
            pose_p=_poses(objects[name].pose for name in rotor_names),
            rate=np.array([r.direction * r.speed for name in rotor_names if (r := objects[name].rotor)]),
        ),
        fixed=Fixed(
            names=tuple(fixed_names),
            parents=tuple(objects[name].parent or "world" for name in fixed_names),
            pose_p=_poses(objects[name].pose for name in fixed_names),
        ),
    )


def _bodies(scene: Scene, names: list[str], level: Mapping[str, str]) -> Bodies:
    things = [scene.objects[name] for name in names]
    box = {path: mesh.bounds(path) for path in {scene.model_path(name) for name in names}}
    low, high = (np.array([box[scene.model_path(name)][side] for name in names]).reshape(-1, 3) for side in (0, 1))
    half, centre_b = (high - low) / 2, (high + low) / 2
    mass = np.array([thing.mass or 0.0 for thing in things])
    movable = mass > 0.0
    for i in np.flatnonzero(movable & ((2 * half < THINNEST) | (2 * half > THICKEST)).any(axis=1)):
        size = " x ".join(f"{2 * side:g}" for side in half[i])
        raise SceneError(f"{scene.path}: objects.{names[i]}.model: {scene.model_path(names[i])} has no volume that "
                         f"can move: each side needs {THINNEST:g} to {THICKEST:g} m, got {size} m")
    per_mass = np.array([moments(scene.model_path(name)) if moves else (0.0, 0.0, 0.0)
                         for name, moves in zip(names, movable, strict=True)]).reshape(-1, 3)
    start_w = _poses(thing.pose for thing in things)
    start_w[:, :3] += rotate_all(start_w[:, 3:], centre_b)
    return Bodies(
        names=tuple(names),
        movable=movable,
        solid=np.array([level[name] in TESTED for name in names], bool),
        half=half,
        centre_b=centre_b,
        mass=mass,
        inverse_mass=np.divide(1.0, mass, out=np.zeros_like(mass), where=movable),
        inertia_b=mass[:, None] * per_mass,
        friction=np.array([thing.friction for thing in things]),
        restitution=np.array([thing.restitution for thing in things]),
        start_w=start_w,
    )


def _collision_settings(scene: Scene, names: list[str]) -> CollisionSettings:
    index = {name: i for i, name in enumerate(names)}
    words = [scene.objects[name].collision for name in names]
    pairs = {}
    for pair in scene.collision.pairs:
        for first, second in product(*(scene.named(name) for name in pair.between)):
            if first in index and second in index and first != second:
                a, b = sorted((index[first], index[second]))
                pairs[a, b] = LEVELS[pair.level], _contacts(pair.contacts)
    return CollisionSettings(
        level=LEVELS.get(scene.collision.level, OBB),
        all_contacts=_contacts(scene.collision.contacts),
        body_level=np.array([LEVELS.get(word.level or "", UNSET) for word in words], np.int64),
        body_contacts=np.array([_contacts(word.contacts) for word in words], np.int64),
        pairs=pairs,
    )


def _contacts(word: str | None) -> int:
    return UNSET if word is None else int(word == "all")


def _drones(objects: dict[str, Object], body_names: list[str], names: list[str]) -> Drones:
    flights = [flight for name in names if (flight := objects[name].flight)]
    return Drones(
        body=np.array([body_names.index(name) for name in names], np.int64),
        max_speed=np.array([flight.max_speed for flight in flights]),
        max_acceleration=np.array([flight.max_acceleration for flight in flights]),
        max_yaw_rate=np.array([flight.max_yaw_rate for flight in flights]),
        quadrotor=np.array([flight.model == "quadrotor" for flight in flights], bool),
        flights=tuple(flights),
    )


def _root(objects: dict[str, Object], name: str) -> str:
    while parent := objects[name].parent:
        name = parent
    return name


def _poses(poses: Iterable[Pose]) -> Floats:
    rows = [(*pose[:3], *from_rpy(*pose[3:])) for pose in poses]
    return np.array(rows, np.float64).reshape(-1, 7)


def object_poses(bodies: Bodies, position: Floats, orientation: Floats) -> Floats:
    """Poses (n, 7) of the objects' own origins in the world, from those of the centres of their boxes."""
    origin = position - rotate_all(orientation, bodies.centre_b)
    return np.concatenate([origin, orientation], axis=1)


