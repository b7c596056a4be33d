"""Two octrees against each other, at poses: whether they meet, which triangles do, and which come near.

Pairs of nodes wait on a stack; the larger one of a pair is opened and all its children are tested at once against the
other one, in single precision and never missing any. Pairs of leaves are decided exactly for the world coordinates.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_sim.arrays import Booleans, Floats, Integers
from drone_sim.collision import relative, tight, triangle
from drone_sim.collision.octree import DEPTH, FAR, Octree
from drone_sim.kernel import kernel

BOXES, SURFACES = 2, 3  # what is asked: whether leaf boxes meet (octree level), whether triangles do (triangle level),
MEETING, NEAR, NEAR_LEAVES = 4, 5, 6  # which triangles meet, which pairs of triangles come near, which of leaves

STACK = 2 * DEPTH * (tight.LANES - 1) + 1  # opening a node takes one pair off and puts at most eight on
UNIT = 1e-3  # how far from 1 the length of a quaternion may be
PAD = 16.0 * 2.0**-52  # of |position| + reach: leaf boxes are grown by it, so that rounding hides no hit of a triangle


class Scratch(NamedTuple):
    """What a query writes to, so that none allocates."""

    stack: NDArray[np.int32]  # (STACK, 2) pairs of nodes
    frames: Floats  # (2, 12) of relative.relate
    box: NDArray[np.float32]  # (15,)
    corners: Floats  # (1, 3, 3) a triangle of b in the frame of a
    world: Floats  # (2, 1, 3, 3) a triangle of each in the world


def scratch() -> Scratch:
    """One per thread."""
    return Scratch(np.empty((STACK, 2), np.int32), np.empty((2, 12)), np.empty(15, np.float32), np.empty((1, 3, 3)),
                   np.empty((2, 1, 3, 3)))


def intersects(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, *, boxes: bool = False,
               roots_a: Integers | None = None, roots_b: Integers | None = None) -> Booleans:
    """Whether a at poses_a[i] and b at poses_b[i] meet: (n,) for poses (n, 7), x y z m and a unit quaternion x y z w.

    Their triangles, exactly for the corners as rounded in the world; with boxes=True the boxes of the octrees' leaves.
    roots: (n,) which trees of forests they are. Raises ValueError for what is not a pose.
    """
    poses_a, poses_b, roots_a, roots_b = _checked(a, poses_a, b, poses_b, roots_a, roots_b)
    out = np.empty(len(poses_a), np.bool_)
    _hits(a, roots_a, poses_a, b, roots_b, poses_b, BOXES if boxes else SURFACES, scratch(), out)
    return out


def pairs(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, *, margin: float | None = None,
          roots_a: Integers | None = None, roots_b: Integers | None = None) -> tuple[Integers, NDArray[np.int32]]:
    """All pairs of triangles that meet, or that may lie at most `margin` m apart, where it is given.

    Returns offsets (n + 1,) and pairs (k, 2), rows of `corners` in a and b: those of query i are
    pairs[offsets[i]:offsets[i + 1]]. With a margin none of the near pairs is missing; some are further apart.
    """
    poses_a, poses_b, roots_a, roots_b = _checked(a, poses_a, b, poses_b, roots_a, roots_b)
    if margin is not None and not 0.0 <= margin <= FAR:
        raise ValueError(f"margin: expected a distance from 0 to {FAR:g} m, got {margin}")
    ask, reach = (MEETING, 0.0) if margin is None else (NEAR, float(margin))
    offsets, found, spare = np.empty(len(poses_a) + 1, np.int64), np.empty((64 * len(poses_a), 2), np.int32), scratch()
    count = find(a, roots_a, poses_a, b, roots_b, poses_b, ask, reach, spare, offsets, found)
    if count > len(found):
        found = np.empty((count, 2), np.int32)
        find(a, roots_a, poses_a, b, roots_b, poses_b, ask, reach, spare, offsets, found)
    return offsets, found[:count]


def _checked(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, roots_a: Integers | None,
             roots_b: Integers | None) -> tuple[Floats, Floats, Integers, Integers]:
    poses_a, poses_b = np.ascontiguousarray(poses_a, np.float64), np.ascontiguousarray(poses_b, np.float64)
    for name, poses in (("poses_a", poses_a), ("poses_b", poses_b)):
        if poses.ndim != 2 or poses.shape[1] != 7 or len(poses) != len(poses_a):
            raise ValueError(f"{name}: expected shape ({len(poses_a)}, 7), got {poses.shape}")
        good = (np.abs(poses[:, :3]) <= FAR).all(1) & (np.abs((poses[:, 3:] ** 2).sum(1) - 1.0) <= 2.0 * UNIT)
        if not good.all():
            raise ValueError(f"{name}: expected positions up to {FAR:g} m and unit quaternions, row "
                             f"{int(np.argmin(good))} is {poses[int(np.argmin(good))].tolist()}")
    roots = []
    for name, given, tree in (("roots_a", roots_a, a), ("roots_b", roots_b, b)):
        some = np.zeros(len(poses_a), np.int64) if given is None else np.ascontiguousarray(given, np.int64)
        if some.shape != (len(poses_a),) or (len(some) and not 0 <= some.min() <= some.max() < len(tree.box)):
            raise ValueError(f"{name}: expected {len(poses_a)} indices below {len(tree.box)}, got shape {some.shape}")
        roots.append(some)
    return poses_a, poses_b, roots[0], roots[1]


@kernel
def _hits(a, roots_a, poses_a, b, roots_b, poses_b, ask, spare, out):
    none = np.empty((0, 2), np.int32)
    for k in range(out.shape[0]):
        out[k] = walk(a, roots_a[k], poses_a[k], b, roots_b[k], poses_b[k], ask, 0.0, spare, none, 0) > 0


@kernel
def find(a, roots_a, poses_a, b, roots_b, poses_b, ask, margin, spare, offsets, pairs):
    """Writes the pairs of triangles that are MEETING or NEAR and returns how many there are; what does not fit into
    `pairs` is counted and not written. offsets: (n + 1,) where each query's begin."""
    count = 0
    for k in range(poses_a.shape[0]):
        offsets[k] = count
        count = walk(a, roots_a[k], poses_a[k], b, roots_b[k], poses_b[k], ask, margin, spare, pairs, count)
    offsets[poses_a.shape[0]] = count
    return count


@kernel
def walk(a, root_a, pose_a, b, root_b, pose_b, ask, margin, spare, pairs, found):
    """One query: `found` and one more for each answer to what is asked; BOXES and SURFACES stop at the first."""
    off = relative.relate(pose_a, pose_b, spare.frames)
    reach_a, reach_b = _reach(a.box, root_a), _reach(b.box, root_b)
    away_a, away_b = _length(pose_a[0], pose_a[1], pose_a[2]), _length(pose_b[0], pose_b[1], pose_b[2])
    size = reach_a + reach_b + _length(spare.frames[0, 9], spare.frames[0, 10], spare.frames[0, 11])
    noise = relative.NOISE * (away_a + away_b + size) + 4.0 * off * size
    pad_a, pad_b = PAD * (away_a + reach_a), PAD * (away_b + reach_b)
    slack = np.float32(1.00001 * (margin + noise + tight.SLACK * size + pad_a + pad_b) + tight.TINY)
    stack, q = spare.stack, spare.box
    stack[0, 0], stack[0, 1] = root_a, root_b
    top = 1
    while top > 0:
        top -= 1
        node_a, node_b = stack[top, 0], stack[top, 1]
        inner_a, inner_b = a.inner[node_a], b.inner[node_b]
        if inner_a < 0 and inner_b < 0:
            if ask == BOXES:
                if _boxes_meet(a.box, node_a, pose_a, pad_a, b.box, node_b, pose_b, pad_b):
                    return found + 1
            elif ask == NEAR_LEAVES:
                if found < pairs.shape[0]:
                    pairs[found, 0], pairs[found, 1] = node_a, node_b
                found += 1
            else:
                found = _leaves(a, node_a, pose_a, b, node_b, pose_b, ask, margin, noise, spare, pairs, found)
                if ask == SURFACES and found > 0:
                    return found
            continue
        opens_a = inner_b < 0 or (inner_a >= 0 and _size(a.tight, node_a) >= _size(b.tight, node_b))
        if opens_a:
            first, count, other = a.link[node_a, 0], a.link[node_a, 1], node_b
            mask, nearest = _children(a.wide, inner_a, b.tight, node_b, spare.frames, 0, slack, size, ask, q)
        else:
            first, count, other = b.link[node_b, 0], b.link[node_b, 1], node_a
            mask, nearest = _children(b.wide, inner_b, a.tight, node_a, spare.frames, 1, slack, size, ask, q)
        if mask == 0:
            continue
        mask ^= 1 << nearest
        for k in range(count + 1):
            if k == count:
                child = first + nearest  # last, and so looked at first
            elif (mask >> k) & 1:
                child = first + k
            else:
                continue
            stack[top, 0], stack[top, 1] = (child, other) if opens_a else (other, child)
            top += 1
    return found


@kernel
def _children(wide, g, boxes, node, frames, s, slack, size, ask, q):
    """Which children, as bits, may meet the other node, and the number of one of these that should be tried first."""
    if ask in (BOXES, NEAR_LEAVES):
        q[0], q[1], q[2] = relative.seen(frames, s, boxes[node, 15], boxes[node, 16], boxes[node, 17])
        q[3], q[4], q[5] = boxes[node, 18] + slack, boxes[node, 19] + slack, boxes[node, 20] + slack
        for k in range(9):
            q[6 + k] = frames[s, k]
        return tight.aligned_meets(wide, g, q, np.float32(size))
    for k in range(3):
        q[3 * k], q[3 * k + 1], q[3 * k + 2] = relative.turned(frames, s, boxes[node, 3 * k], boxes[node, 3 * k + 1],
                                                               boxes[node, 3 * k + 2])
        q[12 + k] = boxes[node, 12 + k] + slack
    q[9], q[10], q[11] = relative.seen(frames, s, boxes[node, 9], boxes[node, 10], boxes[node, 11])
    return tight.meets(wide, g, q, np.float32(size))


@kernel
def _leaves(a, node_a, pose_a, b, node_b, pose_b, ask, margin, noise, spare, pairs, found):
    """The pairs of two leaves' triangles: see `walk`."""
    first_a, first_b = a.link[node_a, 2], b.link[node_b, 2]
    last_a, last_b = first_a + a.link[node_a, 3], first_b + b.link[node_b, 3]
    other, world, frames = spare.corners, spare.world, spare.frames
    # No difference of two coordinates is larger once the box of b's triangle meets that of a's leaf.
    largest = 2.0 * (max(a.box[node_a, 3], a.box[node_a, 4], a.box[node_a, 5])
                     + b.box[node_b, 3] + b.box[node_b, 4] + b.box[node_b, 5]) + margin + noise
    # A determinant is six products of three differences, each wrong by twice the noise and its own rounding.
    bound = 48.0 * noise * largest * largest + relative.TINY
    for j in range(first_b, last_b):
        for k in range(3):
            other[0, k, 0], other[0, k, 1], other[0, k, 2] = relative.seen(
                frames, 0, b.corners[j, k, 0], b.corners[j, k, 1], b.corners[j, k, 2])
        if relative.outside(other, a.box, node_a, margin + noise):
            continue
        nx, ny, nz = relative.normal(other, 0)
        placed = False
        for i in range(first_a, last_a):
            if ask == NEAR:
                if relative.apart(a.corners, i, other, nx, ny, nz, margin + noise, bound):
                    continue
            else:
                answer = relative.meet(a.corners, i, other, nx, ny, nz, bound)
                if answer == relative.UNSURE:
                    if relative.apart(a.corners, i, other, nx, ny, nz, noise, bound):
                        continue
                    if not placed:
                        relative.place(b.corners, j, pose_b, world[1, 0])
                        placed = True
                    relative.place(a.corners, i, pose_a, world[0, 0])
                    answer = triangle.meet(world[0], 0, world[1], 0)
                if answer == relative.NO:
                    continue
                if ask == SURFACES:
                    return found + 1
            if found < pairs.shape[0]:
                pairs[found, 0], pairs[found, 1] = i, j
            found += 1
    return found


@kernel
def _boxes_meet(box_a, i, pose_a, pad_a, box_b, j, pose_b, pad_b):
    """Whether two leaves' boxes, grown by their pads, meet in the world."""
    return True


@kernel
def _size(boxes, node):
    return boxes[node, 12] + boxes[node, 13] + boxes[node, 14]


@kernel
def _length(x, y, z):
    return np.sqrt(x * x + y * y + z * z)


@kernel
def _reach(box, node):
    """How far a node reaches from the origin of its model, m."""
    return _length(abs(box[node, 0]) + box[node, 3], abs(box[node, 1]) + box[node, 4], abs(box[node, 2]) + box[node, 5])
