"""Two octrees against each other, at poses: whether they meet, which triangles do, and which come near.

Pairs of nodes wait on a stack; the larger one of a pair is opened and all its children are tested at once against the
other one, in single precision and never missing any. Pairs of leaves are decided exactly for the world coordinates.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision import exact_arithmetic as exact
from drone_engine.collision.box import exact as separation
from drone_engine.collision.mesh import node_boxes as tight
from drone_engine.collision.mesh import triangle_test as relative
from drone_engine.collision.mesh.octree import DEPTH, FAR, Octree
from drone_engine.collision.triangle import intersection as triangle
from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix

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
    leaves: Floats  # (2, 15) a leaf's box of each in the world
    axis: Floats  # (9, 3), and what else separation.touch needs
    half: Floats
    total: Integers
    probe: Integers


def scratch() -> Scratch:
    """One per thread."""
    return Scratch(np.empty((STACK, 2), np.int32), np.empty((2, 12)), np.empty(15, np.float32), np.empty((1, 3, 3)),
                   np.empty((2, 15)), np.empty((9, 3)), np.empty(9), exact.zeros(), exact.zeros())


def intersects(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, *, boxes: bool = False,
               roots_a: Integers | None = None, roots_b: Integers | None = None) -> Booleans:
    """Whether a at poses_a[i] and b at poses_b[i] meet: (n,) for poses (n, 7), x y z m and a unit quaternion x y z w.

    Their triangles, exactly for the corners as rounded in the world; with boxes=True the boxes of the octrees' leaves.
    roots: (n,) which trees of forests they are. Raises ValueError for what is not a pose.
    """
    poses_a, poses_b, roots_a, roots_b = _checked(a, poses_a, b, poses_b, roots_a, roots_b)
    out = np.empty(len(poses_a), np.bool_)
    _hits(*a, *b, *scratch(), roots_a, poses_a, roots_b, poses_b, BOXES if boxes else SURFACES, out)
    return out


def pairs(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, *, margin: float | None = None,
          leaves: bool = False, roots_a: Integers | None = None,
          roots_b: Integers | None = None) -> tuple[Integers, NDArray[np.int32]]:
    """All pairs of triangles that meet, or that may lie at most `margin` m apart, where it is given; with leaves=True
    of leaves' boxes that may.

    Returns offsets (n + 1,) and pairs (k, 2), rows of `corners` in a and b, or of `box`: those of query i are
    pairs[offsets[i]:offsets[i + 1]]. With a margin none of the near pairs is missing; some are further apart.
    """
    poses_a, poses_b, roots_a, roots_b = _checked(a, poses_a, b, poses_b, roots_a, roots_b)
    if margin is not None and not 0.0 <= margin <= FAR:
        raise ValueError(f"margin: expected a distance from 0 to {FAR:g} m, got {margin}")
    ask = NEAR_LEAVES if leaves else MEETING if margin is None else NEAR
    reach = 0.0 if margin is None else float(margin)
    offsets, found, spare = np.empty(len(poses_a) + 1, np.int64), np.empty((256 * len(poses_a), 2), np.int32), scratch()
    count = _find(*a, *b, *spare, roots_a, poses_a, roots_b, poses_b, ask, reach, offsets, found)
    if count > len(found):
        found = np.empty((count, 2), np.int32)
        _find(*a, *b, *spare, roots_a, poses_a, roots_b, poses_b, ask, reach, offsets, found)
    return offsets, found[:count]


def contacts(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, *, roots_a: Integers | None = None,
             roots_b: Integers | None = None) -> tuple[Integers, NDArray[np.int32], Floats, Floats, Floats]:
    """All contacts: offsets and pairs of triangles that meet, as from `pairs`, and for each of these a point (k, 3) m,
    the unit normal from a to b (k, 3), both in the world, and the depth (k,) m; see `triangle.contact`."""
    offsets, found = pairs(a, poses_a, b, poses_b, roots_a=roots_a, roots_b=roots_b)
    result = np.empty((len(found), 7))
    _contacts(a.corners, np.ascontiguousarray(poses_a, np.float64), b.corners,
              np.ascontiguousarray(poses_b, np.float64), offsets, found, result)
    return offsets, found, result[:, :3], result[:, 3:6], result[:, 6]


def _checked(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, roots_a: Integers | None,
             roots_b: Integers | None) -> tuple[Floats, Floats, Integers, Integers]:
    poses_a, poses_b = np.ascontiguousarray(poses_a, np.float64), np.ascontiguousarray(poses_b, np.float64)
    for name, poses in (("poses_a", poses_a), ("poses_b", poses_b)):
        if poses.ndim != 2 or poses.shape[1] != 7 or len(poses) != len(poses_a):
            raise ValueError(f"{name}: expected shape ({len(poses_a)}, 7), got {poses.shape}")
        check(name, poses)
    roots = []
    for name, given, tree in (("roots_a", roots_a, a), ("roots_b", roots_b, b)):
        some = np.zeros(len(poses_a), np.int64) if given is None else np.ascontiguousarray(given, np.int64)
        if some.shape != (len(poses_a),) or (len(some) and not 0 <= some.min() <= some.max() < len(tree.box)):
            raise ValueError(f"{name}: expected {len(poses_a)} indices below {len(tree.box)}, got shape {some.shape}")
        roots.append(some)
    return poses_a, poses_b, roots[0], roots[1]


def check(name: str, poses: Floats) -> None:
    """Raises ValueError, which names the argument, if a row of poses (n, 7) is none."""
    bad = _first_bad(poses)
    if bad >= 0:
        raise ValueError(f"{name}: expected positions up to {FAR:g} m and unit quaternions, row {bad} is "
                         f"{poses[bad].tolist()}")


@kernel
def _first_bad(poses):
    """The first pose that is none, -1 for none; NaN is refused by every comparison."""
    for k in range(poses.shape[0]):
        x, y, z, w = poses[k, 3], poses[k, 4], poses[k, 5], poses[k, 6]
        square = x * x + y * y + z * z + w * w
        if not (abs(poses[k, 0]) <= FAR and abs(poses[k, 1]) <= FAR and abs(poses[k, 2]) <= FAR
                and abs(square - 1.0) <= 2.0 * UNIT):
            return k
    return -1


@kernel
def _hits(box_a, link_a, corners_a, face_a, tight_a, wide_a, inner_a,
          box_b, link_b, corners_b, face_b, tight_b, wide_b, inner_b,
          stack, frames, box, corners, leaves, axis, half, total, probe,
          roots_a, poses_a, roots_b, poses_b, ask, out):
    """All answers. The arrays come one by one: a tuple of them takes longer to hand over than a query does."""
    a = Octree(box_a, link_a, corners_a, face_a, tight_a, wide_a, inner_a)
    b = Octree(box_b, link_b, corners_b, face_b, tight_b, wide_b, inner_b)
    spare, none = Scratch(stack, frames, box, corners, leaves, axis, half, total, probe), np.empty((0, 2), np.int32)
    for k in range(out.shape[0]):
        out[k] = walk(a, roots_a[k], poses_a[k], b, roots_b[k], poses_b[k], ask, 0.0, spare, none, 0) > 0


@kernel
def _find(box_a, link_a, corners_a, face_a, tight_a, wide_a, inner_a,
          box_b, link_b, corners_b, face_b, tight_b, wide_b, inner_b,
          stack, frames, box, corners, leaves, axis, half, total, probe,
          roots_a, poses_a, roots_b, poses_b, ask, margin, offsets, pairs):
    """Writes the pairs of triangles that are MEETING or NEAR and returns how many there are; what does not fit into
    `pairs` is counted and not written. offsets: (n + 1,) where each query's begin."""
    a = Octree(box_a, link_a, corners_a, face_a, tight_a, wide_a, inner_a)
    b = Octree(box_b, link_b, corners_b, face_b, tight_b, wide_b, inner_b)
    spare, count = Scratch(stack, frames, box, corners, leaves, axis, half, total, probe), 0
    for k in range(poses_a.shape[0]):
        offsets[k] = count
        count = walk(a, roots_a[k], poses_a[k], b, roots_b[k], poses_b[k], ask, margin, spare, pairs, count)
    offsets[poses_a.shape[0]] = count
    return count


@kernel
def _contacts(corners_a, poses_a, corners_b, poses_b, offsets, pairs, result):
    """Writes point, normal and depth of each pair of triangles that meet, (k, 7)."""
    for k in range(poses_a.shape[0]):
        turn_a, turn_b = _turn(poses_a[k]), _turn(poses_b[k])
        for n in range(offsets[k], offsets[k + 1]):
            result[n] = triangle.contact(relative.placed(corners_a, pairs[n, 0], turn_a, poses_a[k]),
                                         relative.placed(corners_b, pairs[n, 1], turn_b, poses_b[k]))


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
    # Taken out once: each access to a member of a tuple counts references.
    box_a, link_a, corners_a, tight_a, wide_a, where_a = a.box, a.link, a.corners, a.tight, a.wide, a.inner
    box_b, link_b, corners_b, tight_b, wide_b, where_b = b.box, b.link, b.corners, b.tight, b.wide, b.inner
    stack, frames, q, other = spare.stack, spare.frames, spare.box, spare.corners
    aligned = ask in (BOXES, NEAR_LEAVES)
    stack[0, 0], stack[0, 1] = root_a, root_b
    top = 1
    while top > 0:
        top -= 1
        node_a, node_b = stack[top, 0], stack[top, 1]
        inner_a, inner_b = where_a[node_a], where_b[node_b]
        if inner_a < 0 and inner_b < 0:
            if ask == BOXES:
                found += _boxes_meet(box_a, node_a, pose_a, pad_a, box_b, node_b, pose_b, pad_b, spare)
            elif ask == NEAR_LEAVES:
                if found < pairs.shape[0]:
                    pairs[found, 0], pairs[found, 1] = node_a, node_b
                found += 1
            else:
                found = _leaves(box_a, link_a, corners_a, node_a, pose_a, box_b, link_b, corners_b, node_b, pose_b,
                                ask, margin, noise, frames, other, pairs, found)
            if ask <= SURFACES and found > 0:
                break
            continue
        opens_a = inner_b < 0 or (inner_a >= 0 and _size(tight_a, node_a) >= _size(tight_b, node_b))
        if opens_a:
            first, count, fixed = link_a[node_a, 0], link_a[node_a, 1], node_b
            _see(tight_b, node_b, frames, 0, slack, aligned, q)
            mask, nearest = _children(wide_a, inner_a, q, np.float32(size), aligned)
        else:
            first, count, fixed = link_b[node_b, 0], link_b[node_b, 1], node_a
            _see(tight_a, node_a, frames, 1, slack, aligned, q)
            mask, nearest = _children(wide_b, inner_b, q, np.float32(size), aligned)
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
            stack[top, 0], stack[top, 1] = (child, fixed) if opens_a else (fixed, child)
            top += 1
    return found


@kernel
def _see(boxes, node, frames, s, slack, aligned, q):
    """Writes a node's box as it is seen from the other tree, in the form that `tight` takes."""
    first = 15 if aligned else 9
    q[9], q[10], q[11] = relative.seen(frames, s, boxes[node, first], boxes[node, first + 1], boxes[node, first + 2])
    for k in range(3):
        q[12 + k] = boxes[node, first + 3 + k] + slack
    if aligned:
        for k in range(9):
            q[k] = frames[s, k]
    else:
        for k in range(3):
            q[3 * k], q[3 * k + 1], q[3 * k + 2] = relative.turned(
                frames, s, boxes[node, 3 * k], boxes[node, 3 * k + 1], boxes[node, 3 * k + 2])


@kernel
def _children(wide, g, q, size, aligned):
    """Which children, as bits, may meet the other node, and the number of one of these that should be tried first."""
    return tight.aligned_meets(wide, g, q, size) if aligned else tight.meets(wide, g, q, size)


@kernel
def _leaves(box_a, link_a, corners_a, node_a, pose_a, box_b, link_b, corners_b, node_b, pose_b, ask, margin, noise,
            frames, other, pairs, found):
    """The pairs of two leaves' triangles: see `walk`."""
    first_a, first_b = link_a[node_a, 2], link_b[node_b, 2]
    last_a, last_b = first_a + link_a[node_a, 3], first_b + link_b[node_b, 3]
    # No difference of two coordinates is larger once the box of b's triangle meets that of a's leaf.
    largest = 2.0 * (max(box_a[node_a, 3], box_a[node_a, 4], box_a[node_a, 5])
                     + box_b[node_b, 3] + box_b[node_b, 4] + box_b[node_b, 5]) + margin + noise
    # A determinant is six products of three differences, each wrong by twice the noise and its own rounding.
    bound = 48.0 * noise * largest * largest + relative.TINY
    for j in range(first_b, last_b):
        for k in range(3):
            other[0, k, 0], other[0, k, 1], other[0, k, 2] = relative.seen(
                frames, 0, corners_b[j, k, 0], corners_b[j, k, 1], corners_b[j, k, 2])
        if relative.outside(other, box_a, node_a, margin + noise):
            continue
        nx, ny, nz = relative.normal(other, 0)
        for i in range(first_a, last_a):
            if ask == NEAR:
                if relative.apart(corners_a, i, other, nx, ny, nz, margin + noise, bound):
                    continue
            else:
                answer = relative.meet(corners_a, i, other, nx, ny, nz, bound)
                if answer == relative.UNSURE:
                    if relative.apart(corners_a, i, other, nx, ny, nz, noise, bound):
                        continue
                    answer = triangle.touch(relative.placed(corners_a, i, _turn(pose_a), pose_a),
                                            relative.placed(corners_b, j, _turn(pose_b), pose_b))
                if answer == relative.NO:
                    continue
                if ask == SURFACES:
                    return found + 1
            if found < pairs.shape[0]:
                pairs[found, 0], pairs[found, 1] = i, j
            found += 1
    return found


@kernel
def _boxes_meet(box_a, i, pose_a, pad_a, box_b, j, pose_b, pad_b, spare):
    """Whether two leaves' boxes, grown by their pads, meet in the world: exactly, as they are rounded there."""
    a, b = spare.leaves[0], spare.leaves[1]
    relative.place_box(box_a, i, _turn(pose_a), pose_a, pad_a, a)
    relative.place_box(box_b, j, _turn(pose_b), pose_b, pad_b, b)
    return separation.touch(a[:3], a[3:12], a[12:], b[:3], b[3:12], b[12:], spare.axis, spare.half, spare.total,
                            spare.probe)


@kernel
def _turn(pose):
    return matrix(pose[3], pose[4], pose[5], pose[6])


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
