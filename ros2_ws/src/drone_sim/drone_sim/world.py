"""A scene that runs: arrays, and a step that is a tuple of named stages. No ROS here.

    world = World(load("island"))
    for _ in range(300):
        world.step({"user_drone": (1.0, 0.0, 0.0, 0.0)})
    print(world.pose("user_drone"))
"""

import math
from collections.abc import Callable, Mapping
from time import perf_counter_ns

import numpy as np

from drone_sim import effects, model
from drone_sim.arrays import Floats
from drone_sim.collision.detection import Detection
from drone_sim.collision.events import Event, Events
from drone_sim.dynamics.solver import Motion
from drone_sim.effects.gravity import Parameters as Gravity
from drone_sim.flight import direct, rotors
from drone_sim.scene import Scene
from drone_sim.stage import Named
from drone_sim.state import State

Command = tuple[float, float, float, float]  # forward, left, up in m/s; yaw rate in rad/s


class World:
    """One scene with its state. Two worlds of one scene that get the same commands stay equal bit for bit."""

    def __init__(self, scene: Scene) -> None:
        """Raises SceneError for effects that do not exist, and mesh.MeshError for models that cannot be read."""
        self.scene = scene
        self.dt = 1.0 / scene.rates.physics
        self.model = model.build(scene)
        self.state = State.of(self.model)
        self._start = self.state.copy()
        self._drone_of = {self.model.bodies.names[i]: d for d, i in enumerate(self.model.drones.body)}
        self.stages = self._build_stages()
        self._marks = [0] * (len(self.stages) + 1)  # ns, when each stage of the last step began

    def _build_stages(self) -> tuple[Named, ...]:
        """What this scene calls for, and nothing else, in the order in which it happens."""
        m, s, dt = self.model, self.state, self.dt
        force_w, torque_w = np.zeros((2, m.bodies.count, 3))
        active = effects.parameters(self.scene)
        self.detection = Detection(m, s, dt)
        self._events = Events(self.detection)
        gravity = active.get("gravity")
        weight = gravity.acceleration if isinstance(gravity, Gravity) else 0.0
        flying, spinning = len(m.drones.body) > 0, len(m.rotors.names) > 0

        def rest() -> None:
            force_w.fill(0.0)
            torque_w.fill(0.0)

        stages = [("forces", rest)]
        if flying:
            stages += [("commands", self._age_commands),
                       ("flight", direct.build_steering(m, s, force_w, torque_w, weight, dt))]
        stages += [(name, effects.effect(name).build(p, m, s, force_w, dt)) for name, p in active.items()]
        stages += [("detection", self.detection),
                   ("motion", Motion(m, s, self.detection, force_w, torque_w, dt, self.scene.dynamics.substeps)),
                   ("events", self._events)]
        if flying:
            stages += [("landing", direct.build_landing(m, s, self.detection, dt))]
        if spinning:
            stages += [("rotors", rotors.build(m, s, dt))]
        return tuple(Named(name, run) for name, run in stages)

    def step(self, commands: Mapping[str, Command] = {}) -> None:
        """One physics step. commands: by drone, those that came since the last step. Raises ValueError."""
        for name, command in commands.items():
            self.command(name, command)
        for i, stage in enumerate(self.stages):
            self._marks[i] = perf_counter_ns()
            stage.run()
        self._marks[-1] = perf_counter_ns()
        self.state.step += 1

    def command(self, drone: str, command: Command) -> None:
        """Gives a drone its velocity for the next SILENCE s. Raises ValueError for one that is not finite."""
        if not all(map(math.isfinite, command)):
            raise ValueError(f"{drone}: a command needs four finite numbers, got {command}")
        if drone not in self._drone_of:
            raise ValueError(f"no drone is called '{drone}'; there are {', '.join(self._drone_of) or 'none'}")
        d = self._drone_of[drone]
        self.state.command_b[d] = np.clip(command, -1e6, 1e6)  # beyond any speed, and squares stay finite
        self.state.silence[d] = -1  # which the next step makes 0

    def set_collision_level(self, level: str, a: str = "", b: str = "") -> None:
        """Changes the level that objects meet at: a pair, one with all others, or all that say nothing of their own.

        level: sphere, obb, octree or triangle. Holds until the scene is reset. Raises ValueError, and mesh.MeshError.
        """
        if level not in model.MEETING:
            raise ValueError(f"level: expected one of {', '.join(model.MEETING)}, got '{level}'")
        if b and not a:
            raise ValueError("a: expected an object where b names one")
        names = self.model.bodies.names
        for which, name in (("a", a), ("b", b)):
            if name and name not in names:
                raise ValueError(f"{which}: no body is called '{name}'; there are {', '.join(names)}")
        if a == b != "":
            raise ValueError(f"b: expected another object than '{a}'")
        self.detection.levels.set(model.LEVELS[level], *(names.index(name) for name in (a, b) if name))
        self.detection.prepare()
        self.detection.compile()

    def _age_commands(self) -> None:
        self.state.silence += 1

    def reset(self) -> None:
        """Back to the start, as if just loaded."""
        self.state.assign(self._start)
        self.detection.clear()
        self.detection.levels.clear()
        self.detection.prepare()
        self._events.clear()

    def compile(self, report: Callable[[int, int, str], None] = lambda done, total, name: None) -> None:
        """Compiles all kernels of the step, telling which comes next, and leaves the world at its start."""
        for i, stage in enumerate(self.stages):
            report(i, len(self.stages), stage.name)
            stage.run()
            if stage.run is self.detection:
                self.detection.compile()
        self.reset()

    @property
    def time(self) -> float:
        """Simulated time in s."""
        return int(self.state.step[0]) * self.dt

    def stage_times(self) -> dict[str, float]:
        """Wall time in us that each stage of the last step took."""
        return {stage.name: (self._marks[i + 1] - self._marks[i]) / 1000 for i, stage in enumerate(self.stages)}

    def contact_counts(self) -> dict[str, int]:
        """By level: the contacts of bodies that touch or are about to. Pairs of meshes may have several."""
        found = self.detection.manifolds
        return dict(zip(model.MEETING, np.bincount(found.level[: found.count], minlength=4).tolist(), strict=True))

    @property
    def events(self) -> list[Event]:
        """What began, went on and ended to touch in the last step."""
        return self._events.current

    def object_poses(self) -> Floats:
        """Poses (n, 7) of the bodies' objects in the world: x y z qx qy qz qw."""
        return model.object_poses(self.model.bodies, self.state.position_w, self.state.orientation_w)

    def pose(self, name: str) -> Floats:
        """Pose (7,) of an object that is a body."""
        pose: Floats = self.object_poses()[self.model.bodies.names.index(name)]
        return pose
