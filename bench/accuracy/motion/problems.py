"""Problems of motion with known solutions: scene, duration and the error of an engine at the end."""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from bench.dynamics.engines import BoxScene, Ours
from drone_engine.arrays import Floats
from drone_engine.math.poses import rotate_all
from drone_engine.math.quaternion import from_rpy
from reference.box_world import Box, G, Setting, world_of
from reference.free_rotation import attitude
from reference.motion.free import MASS, RATE, SIZE, VELOCITY, angle_between

EDGE = 0.6  # m, of a crate
FRICTION, STEEPNESS = 0.5, 1.5  # of a slope, and its angle relative to the friction angle
HEIGHT = 1.0  # m, of the fall before the first bounce
COMMAND = (3.0, 1.0, 0.5, 0.8)  # m/s, rad/s
COMMAND_INTERVAL = 0.2  # s between commands, which time out after 0.5 s
REFERENCE = (3840.0, 16)  # Hz and sub-steps of the reference run


class Problem(NamedTuple):
    """errors(positions, orientations): errors of the movable bodies after `seconds` s, by name; m and rad."""

    title: str
    scene: BoxScene | None  # None for Quadrotor, which has its own scene
    seconds: float
    errors: Callable[[Floats, Floats], Mapping[str, float]]


def flight() -> Problem:
    """The box of Gazebo's benchmark 'boxes', scaled from 10 cm to 1 m: thrown and tumbling."""
    seconds = 10.0
    inertia = MASS / 12 * (np.sum(np.square(SIZE)) - np.square(SIZE))
    end_position = VELOCITY * seconds - np.array([0.0, 0.0, 0.5 * G * seconds**2])
    end_attitude = attitude(inertia, RATE, seconds)

    def errors(position: Floats, orientation: Floats) -> dict[str, float]:
        return {"position": float(np.linalg.norm(position[0] - end_position)),
                "attitude": angle_between(orientation[0], end_attitude)}

    scene = BoxScene({"box": Box(SIZE, (0.0, 0.0, 0.0), MASS)}, velocity_w=VELOCITY[None],
                     angular_velocity_w=RATE[None])
    return Problem("free flight", scene, seconds, errors)


def bounce() -> Problem:
    """A crate that falls flat from 1 m, with restitution 1."""
    seconds, speed = 4.0, math.sqrt(2 * G * HEIGHT)
    since = (seconds - speed / G) % (2 * speed / G)  # s since the last bounce
    height = 0.5 * EDGE + speed * since - 0.5 * G * since**2

    def errors(position: Floats, _: Floats) -> dict[str, float]:
        return {"position": float(np.linalg.norm(position[0] - [0.0, 0.0, height]))}

    box = Box((EDGE,) * 3, (0.0, 0.0, HEIGHT + 0.5 * EDGE), 5.0, 0.6, 1.0)
    return Problem("bounce", BoxScene({"box": box}, 0.0, 0.6, 1.0), seconds, errors)


def incline() -> Problem:
    """A crate that slides down a slope at 1.5 times the friction angle."""
    seconds, angle = 4.0, STEEPNESS * math.atan(FRICTION)
    orientation = np.array([from_rpy(0.0, angle, 0.0)])
    down, up = (rotate_all(orientation, np.array([axis]))[0] for axis in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    start = 0.25 * EDGE * up
    end = start + down * 0.5 * G * (math.sin(angle) - FRICTION * math.cos(angle)) * seconds**2

    def errors(position: Floats, _: Floats) -> dict[str, float]:
        return {"position": float(np.linalg.norm(position[0] - end))}

    crate = Box((EDGE, EDGE, 0.5 * EDGE), (*start.tolist(), 0.0, angle, 0.0), 5.0, FRICTION)
    slope = Box((80.0, 10.0, 2.0), (*(-up).tolist(), 0.0, angle, 0.0), None, FRICTION)
    return Problem("incline", BoxScene({"crate": crate, "slope": slope}), seconds, errors)


def stack() -> Problem:
    """Ten crates stacked on each other."""
    top = np.array([0.0, 0.0, 9.5 * EDGE])

    def errors(position: Floats, _: Floats) -> dict[str, float]:
        return {"position": float(np.linalg.norm(position[9] - top))}

    boxes = {f"box_{i}": Box((EDGE,) * 3, (0.0, 0.0, EDGE * (i + 0.5)), 5.0) for i in range(10)}
    return Problem("stack", BoxScene(boxes, 0.0), 10.0, errors)


class Quadrotor(Ours):
    """A quadrotor with motor lag and a constant command, forward with yaw, as an engine."""

    def __init__(self, setting: Setting) -> None:
        flight = "flight: {model: quadrotor, cmd_vel: cmd_vel}"
        self.world = world_of({"drone": Box((0.5, 0.5, 0.16), (0.0, 0.0, 100.0), 1.5, extra=flight)}, setting,
                              "gravity: {}, motor_lag: {}")
        self._scene, self._count = BoxScene({}), 1

    def run(self, steps: int) -> None:
        """Runs `steps` steps, with a command every COMMAND_INTERVAL s."""
        interval = round(COMMAND_INTERVAL / self.world.dt)
        for done in range(0, steps, interval):
            self.world.command("drone", COMMAND)
            self.world.run(min(interval, steps - done))


def quadrotor() -> Problem:
    """From hovering into a curve in 2 s; the reference is our own run with steps as in REFERENCE."""
    seconds = 2.0
    exact = Quadrotor(Setting(*REFERENCE, "rk4"))
    exact.run(round(seconds * REFERENCE[0]))
    end_position, end_attitude = exact.positions()[0].copy(), exact.orientations()[0].copy()

    def errors(position: Floats, orientation: Floats) -> dict[str, float]:
        distance = min(np.linalg.norm(orientation[0] - end_attitude), np.linalg.norm(orientation[0] + end_attitude))
        return {"position": float(np.linalg.norm(position[0] - end_position)),
                "attitude": float(4.0 * np.arcsin(distance / 2.0))}

    return Problem("quadrotor with motor lag", None, seconds, errors)


PROBLEMS = {"flight": flight, "quadrotor": quadrotor, "bounce": bounce, "incline": incline, "stack": stack}
