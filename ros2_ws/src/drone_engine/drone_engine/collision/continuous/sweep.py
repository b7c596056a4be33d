"""Times of impact of pairs of bodies within a step, at the collision level of each pair.

Bodies move with constant velocity and constant angular velocity. Spheres are solved in closed form, boxes by
conservative advancement, meshes by branch and bound over pairs of octree nodes: the boxes of two nodes touch no later
than anything inside them, so the search inside starts at the time of impact of the boxes.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.continuous.advancement import (
    IMPACT,
    MAX_ITERATIONS,
    MOTION_SIZE,
    NO_IMPACT,
    POSES_SIZE,
    UNFINISHED,
    VELOCITY,
    box_time_of_impact,
    relative_motion,
)
from drone_engine.collision.continuous.triangle_advancement import triangle_time_of_impact
from drone_engine.collision.mesh.octree import EMPTY, MAX_DEPTH, Octree
from drone_engine.collision.ray.cast import ray_sphere
from drone_engine.collision_level import OBB, SPHERE, TRIANGLE
from drone_engine.kernel import kernel
from drone_engine.math.rigid_motion import max_point_speed

CCD_FRACTION = 0.25  # of its smallest side: a body that moves farther in a step needs CCD
TARGET_FRACTION = 1e-4  # of the smaller body's radius: the separation at the time of impact
ROUNDING = 256 * 2.0**-52  # of the lengths involved: the possible error of a separation, padding of leaves included
NODE_ITERATIONS = 8  # for a pair of nodes whose children are tested anyway
MAX_NODE_PAIRS = 20_000  # tested per pair of meshes: about 10 ms; reached only by very fast rotation
STACK_SIZE = 2 * MAX_DEPTH * 7 + 8  # opening a node takes one pair off the stack and puts at most eight on


class SweepScratch(NamedTuple):
    """Buffers of `sweep_pairs`."""

    motion: Floats  # (MOTION_SIZE,) of the pair
    poses: Floats  # (POSES_SIZE,) of the pair
    boxes: Floats  # (2, 6) of a and b
    stack: Integers  # (STACK_SIZE, 2) pairs of nodes
    safe_until: Floats  # (STACK_SIZE,) s, time until which each of these is known not to touch
    triangles: Floats  # (3, 3, 3) one of each body, and one that is a point


def scratch() -> SweepScratch:
    """New buffers for `sweep_pairs`; each thread needs its own."""
    return SweepScratch(np.empty(MOTION_SIZE), np.empty(POSES_SIZE), np.empty((2, 6)),
                        np.empty((STACK_SIZE, 2), np.int64), np.empty(STACK_SIZE), np.empty((3, 3, 3)))


@kernel
def needs_ccd(i, velocity, angular_velocity, half, dt):
    """Whether body i needs CCD: whether some point of it may move more than CCD_FRACTION of its smallest side in dt s.

    velocity, angular_velocity: (n, 3); half: (n, 3) half extents of the bodies' boxes, m.
    """
    radius = math.sqrt(half[i, 0] ** 2 + half[i, 1] ** 2 + half[i, 2] ** 2)
    return (max_point_speed(i, velocity, angular_velocity, radius) * dt
            > 2.0 * CCD_FRACTION * min(half[i, 0], half[i, 1], half[i, 2]))


@kernel
def _sphere_time_of_impact(motion, distance):
    """The time at which the bodies' positions are first `distance` m apart, s: 0 if they are closer at the start, inf
    if never."""
    x, y, z = motion[0], motion[1], motion[2]
    vx, vy, vz = motion[3], motion[4], motion[5]
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    if speed == 0.0:
        return 0.0 if x * x + y * y + z * z <= distance * distance else math.inf
    return ray_sphere(x, y, z, vx / speed, vy / speed, vz / speed, distance) / speed


@kernel
def _copy_box(box, node, row):
    """Copies the box of a node to row (6,)."""
    for k in range(6):
        row[k] = box[node, k]


@kernel
def _radius(box):
    """Upper bound of the distance of a box's farthest point from its body's position, m."""
    return (math.sqrt(box[0] ** 2 + box[1] ** 2 + box[2] ** 2) + math.sqrt(box[3] ** 2 + box[4] ** 2 + box[5] ** 2))


@kernel
def _leaf_time_of_impact(motion, poses, a, b, box_a, box_b, link, corners, start, end, target, level, triangles):
    """The time of impact of two leaves, (t, outcome), as `box_time_of_impact`: of their triangles at level TRIANGLE,
    else of their boxes. a, b: nodes; -1 is the box of a body without an octree, tested against the other's box, or its
    center, if the box has no extent, tested against the other's triangles."""
    if level == TRIANGLE and ((a < 0 and b >= 0 and _is_point(box_a)) or (b < 0 and a >= 0 and _is_point(box_b))):
        return _point_time_of_impact(motion, poses, a, b, box_a, box_b, link, corners, start, end, target, triangles)
    if level != TRIANGLE or a < 0 or b < 0:
        return box_time_of_impact(motion, poses, box_a, box_b, start, end, target, MAX_ITERATIONS)
    start, outcome = box_time_of_impact(motion, poses, box_a, box_b, start, end, target, NODE_ITERATIONS)
    if outcome == NO_IMPACT:
        return end, NO_IMPACT
    outcome = NO_IMPACT
    for i in range(link[a, 2], link[a, 2] + link[a, 3]):
        for j in range(link[b, 2], link[b, 2] + link[b, 3]):
            time, found = triangle_time_of_impact(motion, poses, corners[i], corners[j], start, end, target,
                                                  MAX_ITERATIONS, triangles)
            if found != NO_IMPACT:
                end, outcome = time, found
                if end <= start:
                    return end, outcome
    return end, outcome


@kernel
def _is_point(box):
    """Whether a box (6,) has no extent."""
    return box[3] == box[4] == box[5] == 0.0


@kernel
def _point_time_of_impact(motion, poses, a, b, box_a, box_b, link, corners, start, end, target, triangles):
    """The time of impact of a point, the box of side -1, and the triangles of the other side's leaf: (t, outcome)."""
    leaf, box = (b, box_a) if a < 0 else (a, box_b)
    point = triangles[2]
    for i in range(3):
        for c in range(3):
            point[i, c] = box[c]
    outcome = NO_IMPACT
    for i in range(link[leaf, 2], link[leaf, 2] + link[leaf, 3]):
        if a < 0:
            time, found = triangle_time_of_impact(motion, poses, point, corners[i], start, end, target,
                                                  MAX_ITERATIONS, triangles)
        else:
            time, found = triangle_time_of_impact(motion, poses, corners[i], point, start, end, target,
                                                  MAX_ITERATIONS, triangles)
        if found != NO_IMPACT:
            end, outcome = time, found
            if end <= start:
                return end, outcome
    return end, outcome


@kernel
def _tree_time_of_impact(work, tree, root_a, root_b, start, end, target, level):
    """The time of impact of the leaves of two octrees, or of an octree and the box of a body without one (root -1), as
    `box_time_of_impact`.

    work: SweepScratch; its motion and boxes are those of the pair, the boxes are overwritten. The stack holds the pairs
    of nodes that are still to be tested, of siblings the earliest on top.
    """
    motion, poses, triangles = work.motion, work.poses, work.triangles
    stack, safe_until = work.stack, work.safe_until
    box, link, corners = tree.box, tree.link, tree.corners
    best, outcome, tested = end, NO_IMPACT, 0
    box_a, box_b = work.boxes[0], work.boxes[1]
    stack[0, 0], stack[0, 1], safe_until[0] = root_a, root_b, start
    top = 1
    while top > 0:
        top -= 1
        a, b, t = stack[top, 0], stack[top, 1], safe_until[top]
        if t >= best:
            continue
        if tested > MAX_NODE_PAIRS:
            best, outcome = t, UNFINISHED
            continue
        if a >= 0:  # otherwise the box is that of the whole body throughout
            _copy_box(box, a, box_a)
        if b >= 0:
            _copy_box(box, b, box_b)
        leaf_a, leaf_b = a < 0 or link[a, 1] == 0, b < 0 or link[b, 1] == 0
        if leaf_a and leaf_b:
            time, found = _leaf_time_of_impact(motion, poses, a, b, box_a, box_b, link, corners, t, best, target,
                                               level, triangles)
            if found != NO_IMPACT:
                best, outcome = time, found
            continue
        split_a = not leaf_a and (leaf_b or box_a[3] + box_a[4] + box_a[5] >= box_b[3] + box_b[4] + box_b[5])
        node = a if split_a else b
        tested += link[node, 1]
        base = top
        for child in range(link[node, 0], link[node, 0] + link[node, 1]):
            _copy_box(box, child, box_a if split_a else box_b)
            time, found = box_time_of_impact(motion, poses, box_a, box_b, t, best, target, NODE_ITERATIONS)
            if found != NO_IMPACT:
                at = top
                while at > base and safe_until[at - 1] < time:
                    safe_until[at], stack[at, 0], stack[at, 1] = safe_until[at - 1], stack[at - 1, 0], stack[at - 1, 1]
                    at -= 1
                safe_until[at], stack[at, 0], stack[at, 1] = time, child if split_a else a, b if split_a else child
                top += 1
    return best, outcome


@kernel
def sweep_pairs(pair_a, pair_b, position, orientation, velocity, angular_velocity, half, level, root, tree, dt, toi,
                outcome, work):
    """Writes the time of impact of each pair, as a fraction of dt, to toi (k,), and the outcome to outcome (k,).

    pair_a, pair_b: (k,) bodies. position, velocity, angular_velocity: (n, 3); orientation: (n, 4) x y z w; world frame.
    half: (n, 3) half extents of the boxes of bodies without an octree, m. level: (k,) of each pair. root: (n,) node of
    `tree`, -1: none. tree: Octree. dt: s. work: SweepScratch.
    """
    motion, boxes = work.motion, work.boxes
    box = tree.box
    for k in range(pair_a.shape[0]):
        a, b = pair_a[k], pair_b[k]
        relative_motion(position, orientation, velocity, angular_velocity, a, b, motion)
        for side in range(2):
            body = a if side == 0 else b
            for c in range(3):
                boxes[side, c], boxes[side, 3 + c] = 0.0, half[body, c]
            if root[body] >= 0:
                _copy_box(box, root[body], boxes[side])
        radius_a, radius_b = _radius(boxes[0]), _radius(boxes[1])
        lengths = radius_a + radius_b
        for c in range(3):
            lengths += abs(position[a, c]) + abs(position[b, c]) + abs(motion[VELOCITY + c]) * dt
        target = TARGET_FRACTION * min(radius_a, radius_b) + ROUNDING * lengths
        toi[k], outcome[k] = 1.0, NO_IMPACT
        start = _sphere_time_of_impact(motion, radius_a + radius_b + target)
        if start > dt:
            continue
        if level[k] == SPHERE:
            end, found = start, IMPACT
        elif level[k] == OBB:
            end, found = box_time_of_impact(motion, work.poses, boxes[0], boxes[1], start, dt, target, MAX_ITERATIONS)
        else:
            end, found = _tree_time_of_impact(work, tree, root[a], root[b], start, dt, target, level[k])
        if found != NO_IMPACT:
            toi[k], outcome[k] = end / dt, found


class TimesOfImpact(NamedTuple):
    """The results of k pairs."""

    time: Floats  # (k,) time of impact as a fraction of the step; 1 without an impact
    outcome: Integers  # (k,) NO_IMPACT; IMPACT; UNFINISHED: no contact until `time`, unknown afterwards


def times_of_impact(pairs: ArrayLike, positions: ArrayLike, orientations: ArrayLike, velocities: ArrayLike,
                    angular_velocities: ArrayLike, half: ArrayLike, dt: float,
                    levels: Sequence[int] | Integers | int = OBB, forest: Octree | None = None,
                    roots: Sequence[int] | Integers | int = -1) -> TimesOfImpact:
    """The times of impact of pairs (k, 2) of n bodies within dt s; 0 for pairs that touch at the start.

    World frame, SI units. positions, velocities, angular_velocities: (n, 3); orientations: (n, 4) x y z w; half: (n, 3)
    half extents of the boxes of bodies without an octree; levels: of each pair, or one for all; roots: (n,) nodes of
    the forest, -1: no octree. Raises ValueError for wrong shapes, values or indices.
    """
    pair = np.ascontiguousarray(pairs, np.int64).reshape(-1, 2)
    bodies = [np.ascontiguousarray(of, np.float64) for of in (positions, orientations, velocities, angular_velocities)]
    n, k = len(bodies[0]), len(pair)
    for name, width, array in zip(("positions", "orientations", "velocities", "angular_velocities"), (3, 4, 3, 3),
                                  bodies, strict=True):
        if array.shape != (n, width):
            raise ValueError(f"{name}: expected ({n}, {width}), got {array.shape}")
        if not np.isfinite(array).all():
            bad = int(np.argwhere(~np.isfinite(array))[0, 0])
            raise ValueError(f"{name}: expected finite numbers, got {array[bad].tolist()} for body {bad}")
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
    result = TimesOfImpact(np.empty(k), np.empty(k, np.int64))
    position, orientation, velocity, angular_velocity = bodies
    sweep_pairs(pair[:, 0].copy(), pair[:, 1].copy(), position, orientation, velocity, angular_velocity, extent, level,
                root, EMPTY if forest is None else forest, dt, result.time, result.outcome, scratch())
    return result
