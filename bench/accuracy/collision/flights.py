"""Headless flights through the scenes: poses of the drone and of the bodies that the broad phase finds near it.

The drone is commanded toward one object after another, through its center and past it, and keeps pushing for a while if
something stops it; between two objects it climbs and flies above all objects. The seed determines headings and offsets.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drone_engine import load
from drone_engine.arrays import Floats
from drone_engine.collision.broad_phase.grid import Grid, set_all_bounds
from drone_engine.collision.placement import set_all_axes
from drone_engine.scene.schema import Collision
from drone_engine.state import State
from drone_engine.world import World

DRONE = "user_drone"
SPEED, TRANSFER = 1.5, 6.0  # m/s, past a target and on the way to the next
CRUISE = 6.0  # m, height on the way to the next target
CLEARANCE = 0.8  # m between the goals and the target's box, before and behind it
STUCK = 1.0  # s without progress until the drone gives up a goal
EVERY = 15  # steps between recorded states
NEAR = 0.1  # m, distance of bounds that counts as near
PASS_HEIGHTS = {"ring": (1.2, 1.2), "archway": (1.0, 1.2), "table": (0.35, 1.0)}  # m, heights of the first two passes

Goal = tuple[float, float, float]


@dataclass(frozen=True)
class Encounter:
    """Two models and their poses (n, 7) over time; row i of both arrays belongs to time[i]."""

    path_a: Path
    path_b: Path
    time: Floats  # (n,) s
    poses_a: Floats
    poses_b: Floats


class Flight:
    """A world with a drone that flies from goal to goal, and a record of the bodies that it comes near."""

    def __init__(self, scene: str, seed: int) -> None:
        finest = {"collision": Collision.model_validate({"level": "triangle"})}
        self.world = World(load(scene).model_copy(update=finest))
        self._random = np.random.default_rng(seed)
        bodies = self.world.model.bodies
        self._grid = Grid(bodies.half[bodies.solid])
        self._radius = np.linalg.norm(bodies.half, axis=1)
        self._low, self._high = np.empty((2, bodies.count, 3))
        self._axes = np.empty((bodies.count, 3, 3))
        self._near: dict[int, list[tuple[float, Floats, Floats]]] = {}
        self.states: list[State] = []  # of every EVERY-th step

    def passes(self, targets: Iterable[str], count: int) -> Iterator[tuple[str, int]]:
        """Flies at each target `count` times; yields its name and the number of the pass before each."""
        bodies = self.world.model.bodies
        for name in targets:
            i = bodies.names.index(name)
            for number in range(count):
                yield name, number
                self._pass(i, number)

    def _pass(self, i: int, number: int) -> None:
        """One pass at body i."""
        bodies, state = self.world.model.bodies, self.world.state
        middle, half = state.position_w[i].copy(), bodies.half[i]
        q = state.orientation_w[i]
        yaw = math.atan2(2 * (q[3] * q[2] + q[0] * q[1]), 1 - 2 * (q[1] ** 2 + q[2] ** 2))
        quarter = number // 2 % 2  # along its x axis, then along its y axis
        heading = yaw + quarter * math.pi / 2
        side, height = 0.0, middle[2]
        heights = PASS_HEIGHTS.get(bodies.names[i], ())
        if number < len(heights):
            height = heights[number]
        elif number:
            heading += self._random.uniform(-0.2, 0.2)
            side = self._random.uniform(-1.1, 1.1) * half[1 - quarter]
            height = middle[2] + self._random.uniform(-0.8, 1.1) * half[2]
        height = min(max(height, 0.35), CRUISE)
        along = np.array([math.cos(heading), math.sin(heading)])
        aim = middle[:2] + side * np.array([-along[1], along[0]])
        distance = np.linalg.norm(half[:2]) + self._radius[bodies.names.index(DRONE)] + CLEARANCE
        start, end = aim - distance * along, aim + distance * along
        self._fly((start[0], start[1], CRUISE + 1.0), TRANSFER)
        self._fly((start[0], start[1], height), SPEED)
        yaw_rate = self._random.uniform(-0.5, 0.5) if number else 0.0
        self._fly((end[0], end[1], height), SPEED, yaw_rate)
        here = state.position_w[bodies.names.index(DRONE)]
        self._fly((here[0] - along[0], here[1] - along[1], here[2]), SPEED)
        self._fly((here[0], here[1], CRUISE + 1.0), TRANSFER)

    def _fly(self, goal: Goal, speed: float, yaw_rate: float = 0.0) -> None:
        """Steps until the drone reaches the goal or is stuck; yaw_rate: commanded, rad/s."""
        world = self.world
        drone = world.model.bodies.names.index(DRONE)
        best, since = math.inf, 0.0
        while since < STUCK:
            direction = np.array(goal) - world.state.position_w[drone]
            left = float(np.linalg.norm(direction))
            if left < 0.1:
                return
            if left < best - 0.02:
                best, since = left, 0.0
            since += world.dt
            q = world.state.orientation_w[drone]
            yaw = math.atan2(2 * (q[3] * q[2] + q[0] * q[1]), 1 - 2 * (q[1] ** 2 + q[2] ** 2))
            x, y, z = direction * min(speed, 2.0 * left) / left
            forward, sideways = x * math.cos(yaw) + y * math.sin(yaw), y * math.cos(yaw) - x * math.sin(yaw)
            world.step({DRONE: (forward, sideways, z, yaw_rate)})
            self._record()
            if int(world.state.step[0]) % EVERY == 0:
                self.states.append(world.state.copy())

    def _record(self) -> None:
        """Records the poses of the drone and of all bodies that the broad phase finds near it."""
        bodies, state = self.world.model.bodies, self.world.state
        set_all_axes(state.orientation_w, self._axes)
        set_all_bounds(state.position_w, self._axes, bodies.half, self._radius, state.velocity_w, 0.0, NEAR, self._low,
                       self._high)
        poses = self.world.object_poses()
        drone = bodies.names.index(DRONE)
        for pair in zip(*self._grid.pairs(self._low, self._high, bodies.solid, bodies.movable), strict=True):
            if drone in pair:
                other = int(pair[0] + pair[1]) - drone
                self._near.setdefault(other, []).append((self.world.time, poses[drone], poses[other]))

    def encounters(self) -> list[Encounter]:
        """The poses recorded so far, one encounter per body."""
        names, paths = self.world.model.bodies.names, self.world.model.paths
        own = paths[names.index(DRONE)]
        return [Encounter(own, paths[i], *(np.array(column) for column in zip(*rows, strict=True)))
                for i, rows in sorted(self._near.items())]


def targets(world: World) -> list[str]:
    """Names of the bodies to fly at: the nearest one of each model, in order of distance."""
    bodies, own = world.model.bodies, world.model.bodies.names.index(DRONE)
    distance = np.linalg.norm(bodies.start_w[:, :2] - bodies.start_w[own, :2], axis=1)
    chosen: dict[Path, str] = {}
    for i in np.argsort(distance, kind="stable"):
        if bodies.solid[i] and i != own:
            chosen.setdefault(world.model.paths[i], bodies.names[i])
    return list(chosen.values())
