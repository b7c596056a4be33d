"""Problems of motion whose answer is known: what moves, for how long, and how far off an engine is at the end."""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from bench.dynamics.engines import Boxes, Ours
from drone_engine.arrays import Floats
from drone_engine.math.poses import rotate_all
from drone_engine.math.quaternion import from_rpy
from reference.box_world import Box, G, Setting, world_of
from reference.free_rotation import attitude
from reference.motion.free import MASS, RATE, SIZE, VELOCITY, angle_between

EDGE = 0.6  # m, of a crate
FRICTION, STEEPNESS = 0.5, 1.5  # of a slope, and its angle over that of friction
HEIGHT = 1.0  # m, that a crate falls before it bounces
COMMAND = (3.0, 1.0, 0.5, 0.8)  # m/s, rad/s
RENEWED = 0.2  # s between commands, which are forgotten after 0.5
REFERENCE = (3840.0, 16)  # Hz and sub-steps


class Problem(NamedTuple):
    """errors(positions, orientations) of what moves, after so many s; each with its unit."""

    title: str
    what: Boxes | None  # none of a quadrotor, which Quadrotor makes
    seconds: float
    errors: Callable[[Floats, Floats], Mapping[str, float]]


def flight() -> Problem:
    """The box of the benchmark 'boxes' of Gazebo, a meter for its ten centimeters: thrown, and tumbling."""
    seconds = 10.0
    inertia = MASS / 12 * (np.sum(np.square(SIZE)) - np.square(SIZE))
    place = VELOCITY * seconds - np.array([0.0, 0.0, 0.5 * G * seconds**2])
    turn = attitude(inertia, RATE, seconds)

    def errors(position: Floats, orientation: Floats) -> dict[str, float]:
        return {"position": float(np.linalg.norm(position[0] - place)), "attitude": angle_between(orientation[0], turn)}

    what = Boxes({"box": Box(SIZE, (0.0, 0.0, 0.0), MASS)}, velocity_w=VELOCITY[None], angular_w=RATE[None])
    return Problem("free flight", what, seconds, errors)


def bounce() -> Problem:
    """A crate that falls flat from a meter, again and again, and loses nothing."""
    seconds, speed = 4.0, math.sqrt(2 * G * HEIGHT)
    since = (seconds - speed / G) % (2 * speed / G)  # s since it left the floor
    height = 0.5 * EDGE + speed * since - 0.5 * G * since**2

    def errors(position: Floats, _: Floats) -> dict[str, float]:
        return {"position": float(np.linalg.norm(position[0] - [0.0, 0.0, height]))}

    box = Box((EDGE,) * 3, (0.0, 0.0, HEIGHT + 0.5 * EDGE), 5.0, 0.6, 1.0)
    return Problem("bounce", Boxes({"box": box}, 0.0, 0.6, 1.0), seconds, errors)


def incline() -> Problem:
    """A crate that slides down a slope, half as steep again as friction would hold."""
    seconds, angle = 4.0, STEEPNESS * math.atan(FRICTION)
    lean = np.array([from_rpy(0.0, angle, 0.0)])
    down, up = (rotate_all(lean, np.array([axis]))[0] for axis in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    start = 0.25 * EDGE * up
    end = start + down * 0.5 * G * (math.sin(angle) - FRICTION * math.cos(angle)) * seconds**2

    def errors(position: Floats, _: Floats) -> dict[str, float]:
        return {"position": float(np.linalg.norm(position[0] - end))}

    crate = Box((EDGE, EDGE, 0.5 * EDGE), (*start.tolist(), 0.0, angle, 0.0), 5.0, FRICTION)
    slope = Box((80.0, 10.0, 2.0), (*(-up).tolist(), 0.0, angle, 0.0), None, FRICTION)
    return Problem("incline", Boxes({"crate": crate, "slope": slope}), seconds, errors)


def stack() -> Problem:
    """Ten crates that stand on each other."""
    top = np.array([0.0, 0.0, 9.5 * EDGE])

    def errors(position: Floats, _: Floats) -> dict[str, float]:
        return {"position": float(np.linalg.norm(position[9] - top))}

    boxes = {f"box_{i}": Box((EDGE,) * 3, (0.0, 0.0, EDGE * (i + 0.5)), 5.0) for i in range(10)}
    return Problem("stack", Boxes(boxes, 0.0), 10.0, errors)


class Quadrotor(Ours):
    """A quadrotor with motor lag that is told to fly ahead and to turn, as an engine."""

    def __init__(self, setting: Setting) -> None:
        flight = "flight: {model: quadrotor, cmd_vel: cmd_vel}"
        self.world = world_of({"drone": Box((0.5, 0.5, 0.16), (0.0, 0.0, 100.0), 1.5, extra=flight)}, setting,
                              "gravity: {}, motor_lag: {}")
        self._what, self._count = Boxes({}), 1

    def run(self, steps: int) -> None:
        often = round(RENEWED / self.world.dt)
        for done in range(0, steps, often):
            self.world.command("drone", COMMAND)
            self.world.run(min(often, steps - done))


def quadrotor() -> Problem:
    """From hovering to flight in a curve, in two seconds; the reference is ours, with steps of 1 / REFERENCE s."""
    seconds = 2.0
    exact = Quadrotor(Setting(*REFERENCE, "rk4"))
    exact.run(round(seconds * REFERENCE[0]))
    place, turn = exact.positions()[0].copy(), exact.orientations()[0].copy()

    def errors(position: Floats, orientation: Floats) -> dict[str, float]:
        apart = min(np.linalg.norm(orientation[0] - turn), np.linalg.norm(orientation[0] + turn))
        return {"position": float(np.linalg.norm(position[0] - place)), "attitude": float(4.0 * np.arcsin(apart / 2.0))}

    return Problem("quadrotor with motor lag", None, seconds, errors)


PROBLEMS = {"flight": flight, "quadrotor": quadrotor, "bounce": bounce, "incline": incline, "stack": stack}
