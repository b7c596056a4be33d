"""A running scene: arrays, and a step that is a tuple of stages; without ROS.

    world = World(load("island"))
    for _ in range(300):
        world.step({"user_drone": (1.0, 0.0, 0.0, 0.0)})
    print(world.pose("user_drone"))
"""

import math
from collections.abc import Callable, Mapping
from copy import deepcopy
from itertools import count
from typing import Any

import numpy as np

from drone_engine import effects, flight, model
from drone_engine.arrays import Floats
from drone_engine.behavior import Behaviors
from drone_engine.collision.events import (
    NO_PAIRS,
    ContactEvents,
    ContactPoints,
    Event,
    EventDetector,
    Phase,
    all_touches,
    concatenated,
    contact_points,
    event_list,
)
from drone_engine.collision.pipeline import Detection
from drone_engine.collision_level import LEVELS, TESTED
from drone_engine.context import Context, Forces
from drone_engine.dynamics.motion import Motion
from drone_engine.dynamics.sleep import Sleep
from drone_engine.flight import pilot, rotors
from drone_engine.geometry import mesh
from drone_engine.kernel import kernel
from drone_engine.program.profile import Laps, times
from drone_engine.program.program import Program
from drone_engine.program.stage import Stage
from drone_engine.scene.schema import Scene
from drone_engine.state import State


@kernel
def clear_forces(awake, force, torque, air_velocity):
    """Clears the forces (n, 3) and torques (n, 3) of awake bodies, and the air's velocity."""
    for k in range(1, 1 + awake[0]):
        for c in range(3):
            force[awake[k], c] = torque[awake[k], c] = 0.0
    air_velocity[:] = 0.0


@kernel
def age(silence):
    """Counts the steps since each drone got a command, silence (d,)."""
    for d in range(silence.shape[0]):
        silence[d] += 1


@kernel
def tick(step):
    """Counts the steps since the start, step (1,)."""
    step[0] += 1


LIMIT = 1e6  # of commands: beyond any speed, and squares stay finite
Command = tuple[float, float, float, float]  # forward, left, up in m/s; yaw rate in rad/s


class World:
    """A scene with its state. Two worlds of one scene that get the same commands stay equal, bit for bit."""

    def __init__(self, scene: Scene, timed: bool = False) -> None:
        """timed: measures the stages, for `stage_times`; the motion is the same.

        Raises SceneError for effects and extensions that do not exist, and MeshError for models that cannot be read.
        """
        self.scene = scene
        self._timed = timed
        self._laps: dict[str, Laps] = {}
        self.dt = 1.0 / scene.rates.physics
        self.model = model.build(scene)
        self.state = State.of(self.model)
        s, names = self.state, self.model.bodies.names
        self._inputs: dict[str, tuple[int, Any, Any]] = {  # by drone; a number is written fastest through memoryviews
            names[i]: (i, s.command_b[d].data, s.silence[d : d + 1].data) for d, i in enumerate(self.model.drones.body)}
        self._build()
        self._start = self.state.copy()

    def _build(self) -> None:
        """Builds the stages that the scene needs, and no others."""
        m, s, dynamics = self.model, self.state, self.scene.dynamics
        active = effects.parameters(self.scene)
        moves_air = [name for name in active if effects.moves_air(name, self.scene)]
        self.forces = Forces.none(m, bool(moves_air))
        context = Context(m, s, self.forces, self.dt, dynamics.substeps, self.scene.seed, active)
        self.detection = Detection(context)
        self._events = EventDetector(self.detection.manifolds, lambda: self.sleep.touching if self.sleep else NO_PAIRS)

        self.effects = {name: effects.effect(name, self.scene).build(p, context) for name, p in active.items()}
        flying = len(m.drones.body) > 0
        # Flight models push against the air, so they come after the effects that move it.
        self.behaviors = Behaviors(context, self.scene, self)
        built = [*(stages for name, stages in self.effects.items() if name in moves_air),
                 *([flight.build(context, self.scene)] if flying else []),
                 *(stages for name, stages in self.effects.items() if name not in moves_air)]
        called = self.behaviors.stages
        self.force_program = self._program("force", [
            context.stage("clear forces", clear_forces), *called.force,
            *(stage for each in built for stage in each.force)])
        self.substep_program = self._program("substep", [stage for each in built for stage in each.substep])
        self.motion = Motion(dynamics.integrator, context, self.force_program, self.substep_program, dynamics.passes)
        self._isolated = m.bodies.solid.sum() + len(m.planes) < 2  # nothing can touch anything
        may_sleep = dynamics.sleep and not self._isolated and not any(
            effects.unsteady(name, self.scene) for name in active)
        self.sleep = Sleep(context, self.detection) if may_sleep else None

        self._before = [*called.step, *([context.stage("commands", age)] if flying else [])]
        self._before += [stage for each in built for stage in each.step]
        self._after = [self.sleep.falling_asleep] if self.sleep else []
        if flying and not self._isolated:
            self._after += [pilot.build_landing(context)]
        self._after += rotors.build(context)
        self._after += [context.stage("clock", tick)]
        self._assemble()

    def _assemble(self) -> None:
        """Puts the stages of a step together, in order."""
        detection = () if self._isolated else self.detection.stages
        waking = (self.sleep.waking,) if self.sleep else ()
        catch = () if self._isolated else (self.detection.catch,)
        self.program = self._program("step", [
            *self._before, *detection, *waking, self.motion.stage, *catch, *self._after])
        self.detection.belong_to(self.program)
        self.motion.belong_to(self.program)
        self._ready = False

    def _program(self, name: str, stages: list[Stage]) -> Program:
        """The program of these stages, with clock readings between them if the world is timed."""
        if self._timed:
            self._laps[name] = Laps(stages)
            stages = self._laps[name].stages
        return Program(stages)

    def step(self, commands: Mapping[str, Command] = {}) -> None:
        """One physics step. commands: by drone name, those given since the last step. Raises ValueError, and
        BehaviorError for what a behavior of the scene does wrong."""
        for name, command in commands.items():
            self.command(name, command)
        self.run(1)

    def run(self, steps: int) -> None:
        """Many steps with the last commands, without returning to Python between them where the scene allows that.
        Raises BehaviorError."""
        if not self._ready:
            self.compile()
        self.program.run(steps)

    def detect(self) -> None:
        """Finds the contacts of the present state, as a step does before the motion."""
        if not self._ready:
            self.compile()
        if not self._isolated:
            self.program.run_through(self.detection.keep, self.detection.warm_start)

    def command(self, drone: str, command: Command) -> None:
        """Sets the velocity of a drone, in its heading frame, for the next SILENCE s. Raises ValueError for numbers
        that are not finite and for unknown drones."""
        x, y, z, yaw_rate = command
        if not (-LIMIT <= x <= LIMIT and -LIMIT <= y <= LIMIT and -LIMIT <= z <= LIMIT and -LIMIT <= yaw_rate <= LIMIT):
            if not all(map(math.isfinite, command)):
                raise ValueError(f"{drone}: a command needs four finite numbers, got {command}")
            x, y, z, yaw_rate = (min(max(part, -LIMIT), LIMIT) for part in command)
        inputs = self._inputs.get(drone)
        if inputs is None:
            raise ValueError(f"no drone is called '{drone}'; there are {', '.join(self._inputs) or 'none'}")
        body, stored, silence = inputs
        stored[0], stored[1], stored[2], stored[3] = x, y, z, yaw_rate
        silence[0] = -1  # the next step makes it 0
        if any(command):
            self.wake(body)

    def set_collision_level(self, level: str, a: str = "", b: str = "") -> None:
        """Sets the collision level of a pair of objects, of one object, or the default (neither a nor b).

        level: sphere, obb, octree or triangle. Valid until the scene is reset. Raises ValueError and MeshError.
        """
        if level not in TESTED:
            raise ValueError(f"level: expected one of {', '.join(TESTED)}, got '{level}'")
        if b and not a:
            raise ValueError("a: expected an object where b names one")
        names = self.model.bodies.names
        for which, name in (("a", a), ("b", b)):
            if name and name not in names:
                raise ValueError(f"{which}: no body is called '{name}'; there are {', '.join(names)}")
        if a == b != "":
            raise ValueError(f"b: expected another object than '{a}'")
        before, self.detection.levels = self.detection.levels, deepcopy(self.detection.levels)
        self.detection.levels.set(LEVELS[level], *(names.index(name) for name in (a, b) if name))
        try:
            self.detection.prepare()
        except mesh.MeshError:
            self.detection.levels = before
            raise
        if self.sleep:
            self.sleep.wake(np.flatnonzero(self.model.bodies.movable))
        self._assemble()
        self.compile()

    def reset(self) -> None:
        """Returns to the start, as if just loaded."""
        self.state.assign(self._start)
        bodies = self.model.bodies
        self.forces.inverse_mass[:], self.forces.inertia[:] = bodies.inverse_mass, bodies.inertia_b
        self.detection.clear()
        if self.sleep:
            self.sleep.forget()
        if self.detection.levels.clear():
            self.detection.prepare()
            self._assemble()
        self.behaviors.reset()

    def compile(self, report: Callable[[int, int, str], None] = lambda done, total, name: None) -> None:
        """Compiles all kernels of the step, without a step. report: called with (done, total, next stage)."""
        programs = (self.force_program, self.substep_program, self.program)
        total, done = sum(not stage.timer for each in programs for stage in each.stages), count()
        for program in programs:
            program.compile(lambda _, __, name: report(next(done), total, name) if name else None)
        self.detection.compile()
        self._ready = True

    def stage_names(self) -> list[str]:
        """The stages of a step in order; the stages of sub-steps and forces follow 'motion', as 'motion: <name>'."""
        inner = [f"motion: {name}" for name in (*_names(self.substep_program), *_names(self.force_program))]
        names = _names(self.program)
        at = names.index("motion") + 1
        return list(dict.fromkeys([*names[:at], *inner, *names[at:]]))

    def stage_times(self) -> dict[str, float]:
        """us per step of each stage since the last call, by `stage_names`; empty unless the world is timed."""
        if not self._timed:
            return {}
        return times(self._laps["step"], "motion", [self._laps[name] for name in ("substep", "force")])

    @property
    def time(self) -> float:
        """Simulated time in s."""
        return int(self.state.step[0]) * self.dt

    def contact_counts(self) -> dict[str, int]:
        """Number of manifolds per collision level, speculative and sleeping ones included; meshes may have several per
        pair."""
        found = self.detection.manifolds
        asleep = self.sleep.touching if self.sleep else NO_PAIRS
        level = np.concatenate([found.level[: found.count], asleep.level])
        return dict(zip(TESTED, np.bincount(level, minlength=4).tolist(), strict=True))

    @property
    def events(self) -> list[Event]:
        """Begin, persist and end events of the contacts of the last step."""
        return event_list(self.contact_events)

    @property
    def contact_events(self) -> ContactEvents:
        """The events as arrays, at a tenth of the cost."""
        return self._events.current

    @property
    def contacts(self) -> ContactPoints:
        """The contact points of touching bodies, sleeping ones included."""
        m = self.detection.manifolds
        count, touch = m.count, np.empty((m.count, 5))
        all_touches(count, m.points, m.point_w, m.separation, m.total, touch)
        asleep = self.sleep.contacts if self.sleep else None
        if asleep is not None:  # bodies that fell asleep in this step are in both
            sleeping = self.model.bodies.movable & ~self.state.is_awake
            touch[sleeping[m.pair[:count]].any(axis=1), 3:] = -np.inf
        now = contact_points(m.pair[:count], m.points[:count], m.normal_w[:count], m.anchor_w[:count],
                             m.separation[:count], touch)
        return now if asleep is None else concatenated(now, asleep)

    def object_poses(self) -> Floats:
        """Poses (n, 7) of the bodies' objects in the world: x y z qx qy qz qw."""
        return model.object_poses(self.model.bodies, self.state.position_w, self.state.orientation_w)

    def pose(self, name: str) -> Floats:
        """Pose (7,) in the world of an object that is a body: x y z qx qy qz qw. Raises ValueError for another name."""
        names = self.model.bodies.names
        if name not in names:
            raise ValueError(f"no body is called '{name}'; there are {', '.join(names) or 'none'}")
        pose: Floats = self.object_poses()[names.index(name)]
        return pose

    def wake(self, body: int) -> None:
        """Wakes a body, by its index, and the bodies that it rests on or that rest on it."""
        if self.sleep and self.detection.sleeping[body]:
            self.sleep.wake(np.array([body]))

    def touching(self, body: int) -> tuple[str, ...]:
        """Names of the bodies that touched a body, given by its index, in the last step."""
        events = self.contact_events
        pair = np.stack([events.pairs.key >> 32, events.pairs.key & 0xFFFFFFFF], axis=1)
        mine = pair[(pair == body).any(axis=1) & (events.phase != Phase.END)]
        return tuple(self.model.bodies.names[other] for other in mine[mine != body])


def _names(program: Program) -> list[str]:
    return [stage.name for stage in program.stages if not stage.timer]
