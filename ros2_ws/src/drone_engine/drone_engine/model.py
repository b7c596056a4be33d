"""A scene as arrays that do not change while it runs: bodies, drones, rotors and frames.

A body is an object without a parent that can move or be touched; bodies keep the order of the scene. The point of a
body that is simulated is the center of its bounding box, taken as its center of mass; its moments of inertia are those
of the solid that its surface encloses (geometry/mass_properties.py).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision_level import LEVELS, OBB, TESTED, UNSET
from drone_engine.geometry import mesh
from drone_engine.geometry.mass_properties import moments
from drone_engine.math.poses import poses_from_rpy, rotate_all
from drone_engine.scene.errors import SceneError
from drone_engine.scene.schema import Flight, Object, Scene

GROUND_LEVELS = ("floor", "ground")  # collision levels of objects that support all bodies above them
MIN_SIDE, MAX_SIDE = 1e-6, 1e6  # m; sides of a moving body's box, so that its inertia is neither 0 nor infinite


@dataclass(frozen=True)
class Bodies:
    """Constants of n bodies. SI units; frames: _w is the world's, _b the object's own."""

    names: tuple[str, ...]
    movable: Booleans  # (n,)
    solid: Booleans  # (n,) takes part in the broad phase; false for planes, terrain and objects without collision
    half: Floats  # (n, 3) m, half extents of the bounding box
    center_b: Floats  # (n, 3) m, center of the bounding box
    mass: Floats  # (n,) kg, 0 for static bodies
    inverse_mass: Floats  # (n,) 1/kg, 0 for static bodies
    inertia_b: Floats  # (n, 3) kg m^2, moments about the axes of the box through its center
    friction: Floats  # (n,) coefficient
    restitution: Floats  # (n,) coefficient
    start_w: Floats  # (n, 7) pose of the center at the start, x y z qx qy qz qw

    @property
    def count(self) -> int:
        """Number of bodies, n."""
        return len(self.names)


@dataclass(frozen=True)
class Plane:
    """A horizontal plane that supports all bodies above it.

    The scene's terrain is listed as a plane of height -inf: its real height varies from place to place.
    """

    body: int
    height: float  # m


@dataclass(frozen=True)
class CollisionSettings:
    """Collision level and contacts of pairs of n bodies: those of the pair, else the finer of the two bodies', else the
    scene's. Levels are the numbers of collision_level.py; contacts are 1 (all), or 0 (the deepest point only)."""

    level: int  # of the scene
    all_contacts: int  # of the scene
    body_level: Integers  # (n,) or UNSET
    body_contacts: Integers  # (n,) or UNSET
    pairs: dict[tuple[int, int], tuple[int, int]]  # bodies a < b: level or DISABLED, contacts or UNSET


@dataclass(frozen=True)
class Drones:
    """d bodies that fly."""

    body: Integers  # (d,) index of the body
    max_speed: Floats  # (d,) m/s
    max_acceleration: Floats  # (d,) m/s^2
    max_yaw_rate: Floats  # (d,) rad/s
    quadrotor: Booleans  # (d,) whether the flight model is 'quadrotor'; else it is 'direct'
    flights: tuple[Flight, ...]  # (d,) settings in the scene


@dataclass(frozen=True)
class Rotors:
    """r children of drones that rotate about their own z axis."""

    names: tuple[str, ...]
    parents: tuple[str, ...]
    paths: tuple[Path, ...]  # (r,) files of their models
    drone: Integers  # (r,) index of the drone
    pose_p: Floats  # (r, 7) in the parent's frame
    rate: Floats  # (r,) rad/s in flight, positive counter-clockwise seen from above


@dataclass(frozen=True)
class Fixed:
    """k objects whose pose in their parent never changes: static objects, and children that are no rotors."""

    names: tuple[str, ...]
    parents: tuple[str, ...]  # 'world' if it has none
    pose_p: Floats  # (k, 7) in the parent's frame


@dataclass(frozen=True)
class Model:
    """A scene as arrays, for n bodies."""

    bodies: Bodies
    paths: tuple[Path, ...]  # (n,) files of the bodies' models
    collision: CollisionSettings
    planes: tuple[Plane, ...]
    terrain: int | None  # the body whose surface is the height field
    drones: Drones
    rotors: Rotors
    fixed: Fixed


def build(scene: Scene) -> Model:
    """Reads the models of a scene into arrays.

    Raises mesh.MeshError, and SceneError for a moving body whose bounding box has no volume.
    """
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
        planes=tuple(Plane(i, objects[name].pose[2] if level[name] == "floor" else -math.inf)
                     for i, name in enumerate(body_names) if level[name] in GROUND_LEVELS),
        terrain=next((i for i, name in enumerate(body_names) if level[name] == "ground"), None),
        drones=_drones(objects, body_names, drone_names),
        rotors=Rotors(
            names=tuple(rotor_names),
            parents=tuple(str(objects[name].parent) for name in rotor_names),
            paths=tuple(scene.model_path(name) for name in rotor_names),
            drone=np.array([drone_names.index(_root(objects, name)) for name in rotor_names], np.int64),
            pose_p=poses_from_rpy(objects[name].pose for name in rotor_names),
            rate=np.array([r.direction * r.speed for name in rotor_names if (r := objects[name].rotor)]),
        ),
        fixed=Fixed(
            names=tuple(fixed_names),
            parents=tuple(objects[name].parent or "world" for name in fixed_names),
            pose_p=poses_from_rpy(objects[name].pose for name in fixed_names),
        ),
    )


def _bodies(scene: Scene, names: list[str], level: Mapping[str, str]) -> Bodies:
    things = [scene.objects[name] for name in names]
    box = {path: mesh.bounds(path) for path in {scene.model_path(name) for name in names}}
    low, high = (np.array([box[scene.model_path(name)][side] for name in names]).reshape(-1, 3) for side in (0, 1))
    half, center_b = (high - low) / 2, (high + low) / 2
    mass = np.array([thing.mass or 0.0 for thing in things])
    movable = mass > 0.0
    for i in np.flatnonzero(movable & ((2 * half < MIN_SIDE) | (2 * half > MAX_SIDE)).any(axis=1)):
        size = " x ".join(f"{2 * side:g}" for side in half[i])
        raise SceneError(f"{scene.path}: objects.{names[i]}.model: {scene.model_path(names[i])}: a moving "
                         f"object needs a volume: expected sides from {MIN_SIDE:g} to {MAX_SIDE:g} m, got {size} m")
    per_mass = np.array([moments(scene.model_path(name)) if moves else (0.0, 0.0, 0.0)
                         for name, moves in zip(names, movable, strict=True)]).reshape(-1, 3)
    start_w = poses_from_rpy(thing.pose for thing in things)
    start_w[:, :3] += rotate_all(start_w[:, 3:], center_b)
    return Bodies(
        names=tuple(names),
        movable=movable,
        solid=np.array([level[name] in TESTED for name in names], bool),
        half=half,
        center_b=center_b,
        mass=mass,
        inverse_mass=np.divide(1.0, mass, out=np.zeros_like(mass), where=movable),
        inertia_b=mass[:, None] * per_mass,
        friction=np.array([thing.friction for thing in things]),
        restitution=np.array([thing.restitution for thing in things]),
        start_w=start_w,
    )


def _collision_settings(scene: Scene, names: list[str]) -> CollisionSettings:
    index = {name: i for i, name in enumerate(names)}
    settings = [scene.objects[name].collision for name in names]
    pairs = {}
    for pair in scene.collision.pairs:
        for first, second in product(*(scene.named(name) for name in pair.between)):
            if first in index and second in index and first != second:
                a, b = sorted((index[first], index[second]))
                pairs[a, b] = LEVELS[pair.level], _contacts(pair.contacts)
    return CollisionSettings(
        level=LEVELS.get(scene.collision.level, OBB),
        all_contacts=_contacts(scene.collision.contacts),
        body_level=np.array([LEVELS.get(own.level or "", UNSET) for own in settings], np.int64),
        body_contacts=np.array([_contacts(own.contacts) for own in settings], np.int64),
        pairs=pairs,
    )


def _contacts(contacts: str | None) -> int:
    return UNSET if contacts is None else int(contacts == "all")


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


def object_poses(bodies: Bodies, position: Floats, orientation: Floats) -> Floats:
    """Poses (n, 7) of the objects' origins in the world, from those of the centers: (n, 3) and quaternions (n, 4)."""
    origin = position - rotate_all(orientation, bodies.center_b)
    return np.concatenate([origin, orientation], axis=1)
