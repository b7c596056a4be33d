"""Continuous collision: when within a step two bodies meet, at the pair's level, so that none passes through another.

Bodies move with constant velocity and turn with constant angular velocity. Their balls are solved in closed form,
boxes by conservative advancement, meshes by branch and bound over pairs of nodes: a pair's boxes meet no later than
anything in them, so what is inside starts where they ended.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.continuous.advancement import (
    IMPACT,
    ITERATIONS,
    MOTION,
    NONE,
    PLACE,
    UNFINISHED,
    boxes_meet,
    relative,
)
from drone_engine.collision.continuous.triangle_advancement import triangles_meet
from drone_engine.collision.mesh.octree import DEPTH, EMPTY, Octree
from drone_engine.collision.ray.cast import ray_sphere
from drone_engine.collision_level import OBB, SPHERE, TRIANGLE
from drone_engine.kernel import kernel

FRACTION = 0.25  # of its smallest side: a body that moves more in a step is swept
TARGET = 1e-4  # of the smaller body's radius: how far apart two bodies are at the time of impact
ROUNDING = 256 * 2.0**-52  # of the lengths in play: what a separation may be wrong by, the padding of leaves included
COARSE = 8  # iterations for a pair of nodes whose children are looked at anyway
BUDGET = 20_000  # pairs of nodes looked at for a pair of meshes: about 10 ms; only wild spins come to that
STACK = 2 * DEPTH * 7 + 8  # opening a node takes one pair off the stack and puts at most eight on


@kernel
def fast(i, velocity, spin, half, dt):
    """Whether body i may move some point by more than FRACTION of its smallest side in dt s."""
    speed = math.sqrt(velocity[i, 0] ** 2 + velocity[i, 1] ** 2 + velocity[i, 2] ** 2)
    turning = math.sqrt(spin[i, 0] ** 2 + spin[i, 1] ** 2 + spin[i, 2] ** 2)
    radius = math.sqrt(half[i, 0] ** 2 + half[i, 1] ** 2 + half[i, 2] ** 2)
    return (speed + turning * radius) * dt > 2.0 * FRACTION * min(half[i, 0], half[i, 1], half[i, 2])


@kernel
def balls_meet(motion, distance):
    """When the bodies' positions are first this far apart, s; 0 if they are nearer at the start, inf if never."""
    x, y, z = motion[0], motion[1], motion[2]
    vx, vy, vz = motion[3], motion[4], motion[5]
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    if speed == 0.0:
        return 0.0 if x * x + y * y + z * z <= distance * distance else math.inf
    return ray_sphere(x, y, z, vx / speed, vy / speed, vz / speed, distance) / speed


@kernel
def _copy_box(box, node, row):
    for k in range(6):
        row[k] = box[node, k]


@kernel
def _radius(box):
    """How far a box's farthest point is at most from its body's position."""
    return (math.sqrt(box[0] ** 2 + box[1] ** 2 + box[2] ** 2) + math.sqrt(box[3] ** 2 + box[4] ** 2 + box[5] ** 2))


@kernel
def leaves_meet(motion, place, a, b, box_a, box_b, link, corners, start, end, target, level, world):
    """As boxes_meet, for two leaves: their triangles at level TRIANGLE, else their boxes; -1: a box without triangles,
    which the other's box is held against."""
    if level != TRIANGLE or a < 0 or b < 0:
        return boxes_meet(motion, place, box_a, box_b, start, end, target, ITERATIONS)
    start, outcome = boxes_meet(motion, place, box_a, box_b, start, end, target, COARSE)
    if outcome == NONE:
        return end, NONE
    outcome = NONE
    for i in range(link[a, 2], link[a, 2] + link[a, 3]):
        for j in range(link[b, 2], link[b, 2] + link[b, 3]):
            time, found = triangles_meet(motion, place, corners[i], corners[j], start, end, target, ITERATIONS, world)
            if found != NONE:
                end, outcome = time, found
                if end <= start:
                    return end, outcome
    return end, outcome


@kernel
def trees_meet(motion, place, root_a, root_b, whole, box, link, corners, start, end, target, level, stack,
               entry, world):
    """As boxes_meet, for what is in the leaves of two trees, or of a tree and the box of a body without one (root -1).

    whole: (2, 6) the boxes of the two, overwritten. stack: (STACK, 2) and entry: (STACK,) hold pairs of nodes that are
    yet to be looked at and the time until which each is known to be safe, of siblings the earliest on top.
    """
    best, outcome, looked_at = end, NONE, 0
    box_a, box_b = whole[0], whole[1]
    stack[0, 0], stack[0, 1], entry[0] = root_a, root_b, start
    top = 1
    while top > 0:
        top -= 1
        a, b, t = stack[top, 0], stack[top, 1], entry[top]
        if t >= best:
            continue
        if looked_at > BUDGET:
            best, outcome = t, UNFINISHED
            continue
        if a >= 0:  # else it is the whole body's from the start
            _copy_box(box, a, box_a)
        if b >= 0:
            _copy_box(box, b, box_b)
        leaf_a, leaf_b = a < 0 or link[a, 1] == 0, b < 0 or link[b, 1] == 0
        if leaf_a and leaf_b:
            time, found = leaves_meet(motion, place, a, b, box_a, box_b, link, corners, t, best, target,
                                      level, world)
            if found != NONE:
                best, outcome = time, found
            continue
        split_a = not leaf_a and (leaf_b or box_a[3] + box_a[4] + box_a[5] >= box_b[3] + box_b[4] + box_b[5])
        node = a if split_a else b
        looked_at += link[node, 1]
        base = top
        for child in range(link[node, 0], link[node, 0] + link[node, 1]):
            _copy_box(box, child, box_a if split_a else box_b)
            time, found = boxes_meet(motion, place, box_a, box_b, t, best, target, COARSE)
            if found != NONE:
                at = top
                while at > base and entry[at - 1] < time:
                    entry[at], stack[at, 0], stack[at, 1] = entry[at - 1], stack[at - 1, 0], stack[at - 1, 1]
                    at -= 1
                entry[at], stack[at, 0], stack[at, 1] = time, child if split_a else a, b if split_a else child
                top += 1
    return best, outcome


@kernel
def sweep_pairs(pair_a, pair_b, position, orientation, velocity, spin, half, level, root, box, link, corners, dt,
                toi, outcome, motion, place, whole, stack, entry, world):
    """Writes for each pair the time of impact, as a part of dt, and the outcome. half: (n, 3), for bodies without a
    tree; level: (k,) of each pair; root: (n,) node or -1. motion: (MOTION,), place: (PLACE,), whole: (2, 6), stack:
    (STACK, 2), entry: (STACK,) and world: (2, 3, 3) are room to work in.
    """
    for k in range(pair_a.shape[0]):
        a, b = pair_a[k], pair_b[k]
        relative(position, orientation, velocity, spin, a, b, motion)
        for side in range(2):
            body = a if side == 0 else b
            whole[side] = 0.0
            whole[side, 3:] = half[body]
            if root[body] >= 0:
                _copy_box(box, root[body], whole[side])
        radius_a, radius_b = _radius(whole[0]), _radius(whole[1])
        lengths = radius_a + radius_b
        for c in range(3):
            lengths += abs(position[a, c]) + abs(position[b, c]) + abs(motion[3 + c]) * dt
        target = TARGET * min(radius_a, radius_b) + ROUNDING * lengths
        toi[k], outcome[k] = 1.0, NONE
        start = balls_meet(motion, radius_a + radius_b + target)
        if start > dt:
            continue
        if level[k] == SPHERE:
            end, found = start, IMPACT
        elif level[k] == OBB:
            end, found = boxes_meet(motion, place, whole[0], whole[1], start, dt, target, ITERATIONS)
        else:
            end, found = trees_meet(motion, place, root[a], root[b], whole, box, link, corners, start, dt, target,
                                    level[k], stack, entry, world)
        if found != NONE:
            toi[k], outcome[k] = end / dt, found


def room() -> tuple[Floats, Floats, Floats, Integers, Floats, Floats]:
    """What `sweep_pairs` works in: its last six arguments."""
    return (np.empty(MOTION), np.empty(PLACE), np.empty((2, 6)), np.empty((STACK, 2), np.int64), np.empty(STACK),
            np.empty((2, 3, 3)))


class Impacts(NamedTuple):
    """Of k pairs."""

    time: Floats  # (k,) part of the step after which they meet, a hair apart; 1 if they do not
    outcome: Integers  # (k,) NONE; IMPACT; UNFINISHED: safe until `time`, then not known


def times(pairs: ArrayLike, positions: ArrayLike, orientations: ArrayLike, velocities: ArrayLike,
          angular_velocities: ArrayLike, half: ArrayLike, dt: float, levels: Sequence[int] | Integers | int = OBB,
          forest: Octree | None = None, roots: Sequence[int] | Integers | int = -1) -> Impacts:
    """When the pairs (k, 2) of n bodies meet within dt s; the world's frame, SI units. Those that touch meet at 0.

    positions, velocities, angular_velocities: (n, 3); orientations: (n, 4) xyzw; half: (n, 3) half extents of bodies
    without a tree; levels: of each pair; roots: nodes of the forest, or -1. Raises ValueError.
    """
    pair = np.ascontiguousarray(pairs, np.int64).reshape(-1, 2)
    bodies = [np.ascontiguousarray(of, np.float64) for of in (positions, orientations, velocities, angular_velocities)]
    n, k = len(bodies[0]), len(pair)
    for name, width, array in zip(("positions", "orientations", "velocities", "angular_velocities"), (3, 4, 3, 3),
                                  bodies, strict=True):
        if array.shape != (n, width):
            raise ValueError(f"{name}: expected ({n}, {width}), got {array.shape}")
        if not np.isfinite(array).all():
            raise ValueError(f"{name}: expected finite numbers, body {int(np.argwhere(~np.isfinite(array))[0, 0])}"
                             " has others")
    extent = np.ascontiguousarray(np.broadcast_to(np.asarray(half, np.float64), (n, 3)))
    level = np.ascontiguousarray(np.broadcast_to(np.asarray(levels, np.int64), k))
    root = np.ascontiguousarray(np.broadcast_to(np.asarray(roots, np.int64), n))
    nodes = 0 if forest is None else len(forest.box)
    if not 0.0 < dt < math.inf:
        raise ValueError(f"dt: expected seconds above 0, got {dt}")
    if k and not (pair.min() >= 0 and pair.max() < n):
        raise ValueError(f"pairs: expected bodies 0 to {n - 1}, got {pair.min()} to {pair.max()}")
    if (root >= nodes).any():
        raise ValueError(f"roots: expected nodes of a forest of {nodes}, got {root.max()}")
    box, link, corners, *_ = EMPTY if forest is None else forest
    impacts = Impacts(np.empty(k), np.empty(k, np.int64))
    position, orientation, velocity, spin = bodies
    sweep_pairs(pair[:, 0].copy(), pair[:, 1].copy(), position, orientation, velocity, spin, extent, level, root,
                box, link, corners, dt, impacts.time, impacts.outcome, *room())
    return impacts
