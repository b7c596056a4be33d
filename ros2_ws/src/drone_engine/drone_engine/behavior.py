"""Behaviors of objects and controllers of drones: Python objects of a user's own package, called once a step.

A scene names them by module, with their parameters:

    objects:
      door: {model: crate, mass: 40, behavior: {my_package.door: {height: 2.0}}}
      user_drone: {model: drone, mass: 1.4, flight: {controller: {my_package.follow: {distance: 3.0}}}}

The module has `Parameters`, a Strict model, and a class `Behavior` or `Controller`. It is built with its parameters
and the `Thing` that it belongs to, again after every reset; `step()` is called at the beginning of every step. A
controller's `command()` is called instead and returns a velocity command (forward, left, up in m/s; yaw rate in
rad/s), or None.

A behavior that keeps no random state makes runs repeat bit for bit, since it sees only the state.
"""

import json
import math
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike
from pydantic import ValidationError

from drone_engine.arrays import Floats
from drone_engine.context import Context, Stages
from drone_engine.extension import ExtensionError, find, member
from drone_engine.kernel import kernel
from drone_engine.model import object_poses
from drone_engine.program.stage import in_python
from drone_engine.scene.errors import SceneError, first_error
from drone_engine.scene.schema import Scene

Command = tuple[float, float, float, float]
LIMIT = 1e9  # N, N m, m/s, rad/s: more is an error of the behavior


class BehaviorError(RuntimeError):
    """What a behavior did wrong in a step, in one line: scene, key, and the error. The cause has its traceback."""


class Surroundings(Protocol):
    """What a Thing sees of the world that it is in."""

    @property
    def time(self) -> float:
        """Simulated time, s."""

    def command(self, drone: str, command: Command) -> None:
        """Sets the command of a drone."""

    def wake(self, body: int) -> None:
        """Wakes a body by its index."""

    def touching(self, body: int) -> tuple[str, ...]:
        """Names of the objects that touch a body."""


class Thing:
    """One object of a running scene, as its behavior sees and moves it. World frame, SI units."""

    def __init__(self, name: str, body: int, context: Context, world: Surroundings, pushes: Floats) -> None:
        """body: its index; pushes: (2, n, 3) force and torque of the coming step, shared by all behaviors."""
        self.name, self.dt = name, context.dt
        self._body, self._context, self._world, self._pushes = body, context, world, pushes

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self._world.time

    @property
    def pose(self) -> Floats:
        """Pose (7,) of the object: x y z in m and a quaternion x y z w."""
        return self.pose_of(self.name)

    @property
    def velocity(self) -> Floats:
        """Velocity (3,) of the center of the box, m/s."""
        velocity: Floats = self._context.state.velocity_w[self._body].copy()
        return velocity

    @property
    def angular_velocity(self) -> Floats:
        """Angular velocity (3,), rad/s."""
        angular_velocity: Floats = self._context.state.angular_velocity_w[self._body].copy()
        return angular_velocity

    @property
    def mass(self) -> float:
        """kg."""
        return float(self._context.model.bodies.mass[self._body])

    @property
    def touching(self) -> tuple[str, ...]:
        """Names of the objects that touched this one in the last step."""
        return self._world.touching(self._body)

    def pose_of(self, name: str) -> Floats:
        """Pose (7,) of any object without a parent. Raises ValueError."""
        bodies, state = self._context.model.bodies, self._context.state
        if name not in bodies.names:
            raise ValueError(f"no object is called '{name}'; there are {', '.join(bodies.names)}")
        pose: Floats = object_poses(bodies, state.position_w, state.orientation_w)[bodies.names.index(name)]
        return pose

    def push(self, force: ArrayLike = (0.0, 0.0, 0.0), torque: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Adds a force (3,), N, at the center of the box, and a torque (3,), N m, for the whole coming step. Raises
        ValueError."""
        self._pushes[0, self._body] += _vector("force", force)
        self._pushes[1, self._body] += _vector("torque", torque)
        self._world.wake(self._body)

    def move(self, velocity: ArrayLike, angular_velocity: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Sets the velocity (3,), m/s, and the angular velocity (3,), rad/s. Contacts may change them within the step.
        Raises ValueError."""
        velocity, angular_velocity = _vector("velocity", velocity), _vector("angular_velocity", angular_velocity)
        self._context.state.velocity_w[self._body] = velocity
        self._context.state.angular_velocity_w[self._body] = angular_velocity
        self._world.wake(self._body)

    def command(self, command: Sequence[float]) -> None:
        """Commands a drone, as a Twist does: forward, left, up in m/s; yaw rate in rad/s. Raises ValueError."""
        forward, left, up, yaw_rate = command
        self._world.command(self.name, (forward, left, up, yaw_rate))

    def remember(self, name: str, start: ArrayLike) -> Floats:
        """An array that is part of the state and its hash, and starts with these numbers after a reset; write into
        it."""
        return self._context.state.remember(f"{self.name}.{name}", np.array(start, np.float64))


@kernel
def add_pushes(pushes, force, torque):  # type: ignore[no-untyped-def]
    """Adds the pushes (2, n, 3), N and N m, of the step to force and torque (n, 3)."""
    for i in range(force.shape[0]):
        for c in range(3):
            force[i, c] += pushes[0, i, c]
            torque[i, c] += pushes[1, i, c]


class Behaviors:
    """The behaviors and controllers of a scene, and the stages that call them."""

    def __init__(self, context: Context, scene: Scene, world: Surroundings) -> None:
        """Raises SceneError for a module that cannot be used, or parameters that are not valid."""
        self._scene = scene
        names = context.model.bodies.names
        self._pushes: Floats = np.zeros((2, len(names), 3))
        self._make: list[tuple[str, Callable[[], Callable[[], Any]]]] = []
        for name, thing in scene.objects.items():
            for key, kind, method, named in (
                    (f"objects.{name}.behavior", "Behavior", "step", thing.behavior),
                    (f"objects.{name}.flight.controller", "Controller", "command",
                     thing.flight.controller if thing.flight else {})):
                for module, parameters in named.items():
                    handle = Thing(name, names.index(name), context, world, self._pushes)
                    self._make.append((f"{key}.{module}", self._factory(key, module, kind, method, parameters, handle)))
        self._calls: list[tuple[str, Callable[[], Any]]] = []
        self.stages = Stages()
        if self._make:
            writes = ("velocity", "angular_velocity", "command", "silence", "awake", "still", "pushes")
            self.stages = Stages(step=(in_python("behaviors", self._run, writes),),
                                 force=(context.stage("behaviors", add_pushes, pushes=self._pushes),))
            self.reset()

    def _factory(self, key: str, module: str, kind: str, method: str, parameters: dict[str, Any],
                 thing: Thing) -> Callable[[], Callable[[], Any]]:
        """What builds a behavior and gives the function to call once a step. Raises SceneError."""
        where = f"{self._scene.path}: {key}.{module}"
        try:
            found = find("behaviors" if kind == "Behavior" else "controllers", module, self._scene.folder)
            schema, maker = member(found, module, "Parameters"), member(found, module, kind)
            valid = schema.model_validate_json(json.dumps(parameters), strict=True)
        except ExtensionError as error:
            raise SceneError(f"{where}: {error}") from error.__cause__
        except ValidationError as error:
            message = first_error(error, schema, (*key.split("."), module))
            raise SceneError(f"{self._scene.path}: {message}") from None

        def make() -> Callable[[], Any]:
            call: Callable[[], Any] = member(maker(valid, thing), f"{module}.{kind}", method)
            if kind == "Behavior":
                return call

            def command() -> None:
                if (answer := call()) is not None:
                    thing.command(answer)

            return command

        return make

    def reset(self) -> None:
        """Builds all behaviors again, as at the start. Raises BehaviorError."""
        self._pushes[:] = 0.0
        self._calls = [(where, self._guarded(where, make)) for where, make in self._make]

    def _run(self) -> None:
        """Calls every behavior, in the order of the scene. Raises BehaviorError."""
        self._pushes[:] = 0.0
        for where, call in self._calls:
            self._guarded(where, call)

    def _guarded(self, where: str, call: Callable[[], Any]) -> Any:
        try:
            return call()
        except Exception as error:
            line = (str(error).splitlines() or [""])[0]
            raise BehaviorError(f"{self._scene.path}: {where}: {type(error).__name__}: {line}") from error


def _vector(name: str, value: ArrayLike) -> Floats:
    """Three finite numbers. Raises ValueError."""
    vector: Floats = np.asarray(value, np.float64)
    if vector.shape != (3,) or not all(math.isfinite(part) and abs(part) <= LIMIT for part in vector):
        raise ValueError(f"{name}: expected three finite numbers of at most {LIMIT:g}, got {vector.tolist()}")
    return vector
