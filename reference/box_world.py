"""Worlds of plain boxes for measurements, and quantities computed from a world: energy, penetration, speed."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from drone_engine import Scene, parse
from drone_engine.arrays import Floats
from drone_engine.math.poses import inverse, rotate_all
from drone_engine.scene.schema import Dynamics
from drone_engine.world import World

G = 9.80665  # m/s^2
GRAVITY = "gravity: {}"
DEFAULT = Dynamics().integrator


@dataclass(frozen=True)
class Box:
    """One box.

    size: edge lengths (3,) in m; pose of its center: [x, y, z] or [x, y, z, roll, pitch, yaw], m and rad;
    mass: kg, None if static.
    """

    size: tuple[float, float, float]
    pose: tuple[float, ...]
    mass: float | None = None
    friction: float = 0.6
    restitution: float = 0.0
    extra: str = ""  # further keys of the object, as YAML


@dataclass(frozen=True)
class Setting:
    """How motion is computed: rate of the steps in Hz, sub-steps per step, solver iterations, integrator, sleeping."""

    rate: float = 30.0  # Hz
    substeps: int = 8
    integrator: str = DEFAULT
    sleep: bool = False
    iterations: int = Dynamics().passes

    def yaml(self) -> str:
        """The sections "rates" and "dynamics" of a scene."""
        return (f"rates: {{physics: {self.rate!r}}}\ndynamics: {{integrator: {self.integrator}, "
                f"substeps: {self.substeps}, passes: {self.iterations}, sleep: {str(self.sleep).lower()}}}\n")

    def __str__(self) -> str:
        sleep = ", bodies may sleep" if self.sleep else ""
        return f"{self.integrator.replace('_', ' ')}, {self.rate:g} Hz x {self.substeps}{sleep}"


@contextmanager
def scene_of(boxes: Mapping[str, Box], setting: Setting = Setting(), effects: str = GRAVITY,
             floor: float | None = None, friction: float = 0.6, restitution: float = 0.0) -> Iterator[Scene]:
    """A scene of these boxes, valid until the context ends, since its models are temporary files.

    effects: contents of the scene's section, as YAML; floor: height in m of an infinite floor with that friction and
    restitution, None for no floor.
    """
    objects = dict(boxes)
    if floor is not None:
        objects["floor"] = Box((1.0, 1.0, 0.01), (0.0, 0.0, floor), None, friction, restitution,
                               "collision: {level: floor}")
    with TemporaryDirectory() as folder:
        yield parse(_written(Path(folder), objects, setting, effects), Path(folder) / "scenes/boxes.yaml")


def world_of(boxes: Mapping[str, Box], setting: Setting = Setting(), effects: str = GRAVITY,
             floor: float | None = None, friction: float = 0.6, restitution: float = 0.0) -> World:
    """A world of these boxes, ready to step; parameters as for `scene_of`."""
    with scene_of(boxes, setting, effects, floor, friction, restitution) as scene:
        return World(scene)


def _written(folder: Path, boxes: Mapping[str, Box], setting: Setting, effects: str) -> str:
    """The scene as YAML; writes its models into the folder."""
    (folder / "models").mkdir()
    models: dict[tuple[float, float, float], str] = {}
    lines = [f"version: 1\n{setting.yaml()}effects: {{{effects}}}\nobjects:"]
    for name, box in boxes.items():
        if box.size not in models:
            models[box.size] = f"box_{len(models)}"
            (folder / f"models/{models[box.size]}.obj").write_text(_obj(box.size))
        motion = f"mass: {box.mass!r}" if box.mass else "static: true"
        keys = [f"model: {models[box.size]}", f"pose: {[float(x) for x in box.pose]}", motion,
                f"friction: {box.friction!r}", f"restitution: {box.restitution!r}"]
        lines.append(f"  {name}: {{{', '.join(keys + [box.extra] * bool(box.extra))}}}")
    return "\n".join(lines) + "\n"


def _obj(size: tuple[float, float, float]) -> str:
    """An OBJ file of a box about the origin."""
    x, y, z = (side / 2 for side in size)
    corners = [(i * x, j * y, k * z) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
    faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    return "".join([*(f"v {a!r} {b!r} {c!r}\n" for a, b, c in corners),
                    *(f"f {a} {b} {c}\nf {a} {c} {d}\n" for a, b, c, d in faces)])


def with_dynamics(scene: Scene, setting: Setting) -> Scene:
    """The scene with integrator, sub-steps and sleeping of the setting; it keeps its own rate."""
    dynamics = Dynamics.model_validate({"integrator": setting.integrator, "substeps": setting.substeps,
                                   "sleep": setting.sleep})
    return scene.model_copy(update={"dynamics": dynamics})


def advance(world: World, seconds: float, every: int = 1) -> Iterator[float]:
    """Runs the world, yielding the time since the start in s after every `every` steps."""
    steps = round(seconds / world.dt)
    for done in range(every, steps + 1, every):
        world.run(every)
        yield done * world.dt


def energy(world: World) -> float:
    """Kinetic and potential energy of all movable bodies, J."""
    bodies, s = world.model.bodies, world.state
    angular_b = rotate_all(inverse(s.orientation_w), s.angular_velocity_w)
    movable = bodies.movable
    per_body = (0.5 * bodies.mass * (s.velocity_w**2).sum(1) + 0.5 * (bodies.inertia_b * angular_b**2).sum(1)
                + bodies.mass * G * s.position_w[:, 2] * ("gravity" in world.scene.effects))
    return float(per_body[movable].sum())


def angular_momentum(world: World) -> Floats:
    """Angular momentum of body 0 about its own center, (3,) kg m^2/s in the world frame."""
    q = world.state.orientation_w[:1]
    angular_b = rotate_all(inverse(q), world.state.angular_velocity_w[:1])
    return np.asarray(rotate_all(q, world.model.bodies.inertia_b[:1] * angular_b)[0])


def depth(world: World) -> float:
    """Deepest penetration among the contacts of the last step, m; 0 without overlap."""
    manifolds = world.detection.manifolds
    points = np.arange(manifolds.separation.shape[1]) < manifolds.points[: manifolds.count, None]
    return max(0.0, -float(manifolds.separation[: manifolds.count][points].min(initial=0.0)))


def highest_speed(world: World) -> float:
    """Highest speed of a body's center of mass, m/s."""
    return float(np.linalg.norm(world.state.velocity_w, axis=1).max(initial=0.0))
