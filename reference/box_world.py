"""Worlds of plain boxes for measurements, and what is read off a world: energy, depth, speed."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.math.rotation import inverse, rotate_all
from drone_engine.scene.schema import Dynamics, Scene, parse
from drone_engine.world import World

G = 9.80665  # m/s^2
GRAVITY = "gravity: {}"
DEFAULT = Dynamics().integrator


@dataclass(frozen=True)
class Box:
    """One body, by its middle: size (3,) m, pose [x, y, z] or [x, y, z, roll, pitch, yaw], kg or None if static."""

    size: tuple[float, float, float]
    pose: tuple[float, ...]
    mass: float | None = None
    friction: float = 0.6
    restitution: float = 0.0
    extra: str = ""  # more keys of the object, as YAML


@dataclass(frozen=True)
class Setting:
    """How motion is computed."""

    rate: float = 30.0  # Hz
    substeps: int = 8
    integrator: str = DEFAULT
    sleep: bool = False
    passes: int = Dynamics().passes

    def yaml(self) -> str:
        return (f"rates: {{physics: {self.rate!r}}}\ndynamics: {{integrator: {self.integrator}, "
                f"substeps: {self.substeps}, passes: {self.passes}, sleep: {str(self.sleep).lower()}}}\n")

    def __str__(self) -> str:
        sleep = ", bodies may sleep" if self.sleep else ""
        return f"{self.integrator.replace('_', ' ')}, {self.rate:g} Hz x {self.substeps}{sleep}"


@contextmanager
def scene_of(boxes: Mapping[str, Box], setting: Setting = Setting(), effects: str = GRAVITY,
             floor: float | None = None, friction: float = 0.6, restitution: float = 0.0) -> Iterator[Scene]:
    """A scene of these boxes; floor: height of a floor of that friction, m. Its models are there until it is left."""
    objects = dict(boxes)
    if floor is not None:
        objects["floor"] = Box((1.0, 1.0, 0.01), (0.0, 0.0, floor), None, friction, restitution,
                               "collision: {level: floor}")
    with TemporaryDirectory() as folder:
        yield parse(_written(Path(folder), objects, setting, effects), Path(folder) / "scenes/boxes.yaml")


def world_of(boxes: Mapping[str, Box], setting: Setting = Setting(), effects: str = GRAVITY,
             floor: float | None = None, friction: float = 0.6, restitution: float = 0.0) -> World:
    """A world of these boxes, ready to step."""
    with scene_of(boxes, setting, effects, floor, friction, restitution) as scene:
        return World(scene)


def _written(folder: Path, boxes: Mapping[str, Box], setting: Setting, effects: str) -> str:
    """The scene's text; its models are in the folder."""
    (folder / "models").mkdir()
    models: dict[tuple[float, float, float], str] = {}
    lines = [f"version: 1\n{setting.yaml()}effects: {{{effects}}}\nobjects:"]
    for name, box in boxes.items():
        if box.size not in models:
            models[box.size] = f"box_{len(models)}"
            (folder / f"models/{models[box.size]}.obj").write_text(_obj(box.size))
        moves = f"mass: {box.mass!r}" if box.mass else "static: true"
        keys = [f"model: {models[box.size]}", f"pose: {[float(x) for x in box.pose]}", moves,
                f"friction: {box.friction!r}", f"restitution: {box.restitution!r}"]
        lines.append(f"  {name}: {{{', '.join(keys + [box.extra] * bool(box.extra))}}}")
    return "\n".join(lines) + "\n"


def _obj(size: tuple[float, float, float]) -> str:
    x, y, z = (side / 2 for side in size)
    corners = [(i * x, j * y, k * z) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
    faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    return "".join([*(f"v {a!r} {b!r} {c!r}\n" for a, b, c in corners),
                    *(f"f {a} {b} {c}\nf {a} {c} {d}\n" for a, b, c, d in faces)])


def with_dynamics(scene: Scene, setting: Setting) -> Scene:
    """The scene, moved in that way; it keeps its own rate."""
    how = Dynamics.model_validate({"integrator": setting.integrator, "substeps": setting.substeps,
                                   "sleep": setting.sleep})
    return scene.model_copy(update={"dynamics": how})


def advance(world: World, seconds: float, every: int = 1) -> Iterator[float]:
    """Runs the world and stops after every so many steps, to be looked at; yields the time since the start, s."""
    steps = round(seconds / world.dt)
    for done in range(every, steps + 1, every):
        world.run(every)
        yield done * world.dt


def energy(world: World) -> float:
    """Kinetic and potential energy of all that moves, J."""
    bodies, s = world.model.bodies, world.state
    angular_b = rotate_all(inverse(s.orientation_w), s.angular_velocity_w)
    moving = bodies.movable
    per_body = (0.5 * bodies.mass * (s.velocity_w**2).sum(1) + 0.5 * (bodies.inertia_b * angular_b**2).sum(1)
                + bodies.mass * G * s.position_w[:, 2] * ("gravity" in world.scene.effects))
    return float(per_body[moving].sum())


def angular_momentum(world: World) -> Floats:
    """Of body 0 about its own centre, (3,) kg m^2/s in the world."""
    q = world.state.orientation_w[:1]
    angular_b = rotate_all(inverse(q), world.state.angular_velocity_w[:1])
    return np.asarray(rotate_all(q, world.model.bodies.inertia_b[:1] * angular_b)[0])


def depth(world: World) -> float:
    """The deepest penetration that the last step found, m; 0 where nothing overlaps."""
    found = world.detection.manifolds
    points = np.arange(found.separation.shape[1]) < found.points[: found.count, None]
    return max(0.0, -float(found.separation[: found.count][points].min(initial=0.0)))


def fastest(world: World) -> float:
    """Highest speed of a centre, m/s."""
    return float(np.linalg.norm(world.state.velocity_w, axis=1).max(initial=0.0))
