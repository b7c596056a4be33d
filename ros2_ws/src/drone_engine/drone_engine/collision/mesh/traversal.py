"""Simultaneous traversal of two posed octrees: whether they intersect, which triangles do, and which come near.

Pairs of nodes are kept on a stack. The larger node of a pair is opened, and all its children are tested at once against
the other node, in single precision with a slack that covers the rounding, so that none is missed. Pairs of leaves are
decided exactly, for the world coordinates of their corners as `transform_point` rounds them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision import exact_arithmetic
from drone_engine.collision.box.exact import boxes_touch
from drone_engine.collision.mesh.node_boxes import (
    LANES,
    MIN_SLACK,
    SLACK,
    overlapping_aligned_children,
    overlapping_children,
)
from drone_engine.collision.mesh.octree import MAX_COORDINATE, MAX_DEPTH, Octree
from drone_engine.collision.mesh.transforms import (
    RELATIVE_ERROR,
    direction_to_frame,
    point_to_frame,
    pose_rotation,
    relative_transforms,
    transform_box,
    transform_triangle,
)
from drone_engine.collision.mesh.triangle_filter import (
    DISJOINT,
    UNDECIDED,
    UNDERFLOW_ERROR,
    intersection_filter,
    is_farther_apart,
    is_outside_box,
)
from drone_engine.collision.triangle.contact import contact
from drone_engine.collision.triangle.geometry import triangle_normal
from drone_engine.collision.triangle.intersection import triangles_intersect
from drone_engine.kernel import allocating, kernel

# Queries: whether any leaf boxes overlap (level octree), whether any triangles intersect (level triangle), all pairs of
# triangles that intersect, all pairs of triangles within a margin, all pairs of leaves within a margin.
ANY_LEAVES, ANY_TRIANGLES, TRIANGLES, NEAR_TRIANGLES, NEAR_LEAVES = 2, 3, 4, 5, 6

STACK_SIZE = 2 * MAX_DEPTH * (LANES - 1) + 1  # opening a node takes one pair off and puts at most eight on
UNIT_TOLERANCE = 1e-3  # by which the length of a quaternion may differ from 1
PAD = 16.0 * 2.0**-52  # of |position| + reach: growth of leaf boxes, so that rounding hides no intersecting triangle


class TraversalScratch(NamedTuple):
    """Buffers of a query."""

    stack: NDArray[np.int32]  # (STACK_SIZE, 2) pairs of nodes
    transforms: Floats  # (2, 12) of `relative_transforms`
    query_box: NDArray[np.float32]  # (15,) a node's box in the other tree's frame
    triangle: Floats  # (1, 3, 3) a triangle of b in the frame of a
    leaf_boxes: Floats  # (2, 15) a leaf's box of each in the world
    axis: Floats  # (9, 3); this and the rest are scratch of boxes_touch
    half: Floats
    total: Integers
    probe: Integers


def scratch() -> TraversalScratch:
    """New buffers for queries; each thread needs its own."""
    return TraversalScratch(np.empty((STACK_SIZE, 2), np.int32), np.empty((2, 12)), np.empty(15, np.float32),
                            np.empty((1, 3, 3)), np.empty((2, 15)), np.empty((9, 3)), np.empty(9),
                            exact_arithmetic.zeros(), exact_arithmetic.zeros())


def intersects(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, *, boxes: bool = False,
               roots_a: Integers | None = None, roots_b: Integers | None = None) -> Booleans:
    """Whether a at poses_a[i] and b at poses_b[i] intersect: (n,) for poses (n, 7), x y z m and a unit quaternion
    x y z w.

    Tests triangles, exactly for the corners as rounded in the world; with boxes=True the boxes of the octrees' leaves.
    roots: (n,) root nodes of the trees within forests; default 0. Raises ValueError for invalid poses or roots.
    """
    poses_a, poses_b, roots_a, roots_b = _checked(a, poses_a, b, poses_b, roots_a, roots_b)
    out = np.empty(len(poses_a), np.bool_)
    _intersects_all(*a, *b, *scratch(), roots_a, poses_a, roots_b, poses_b, ANY_LEAVES if boxes else ANY_TRIANGLES, out)
    return out


def pairs(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, *, margin: float | None = None,
          leaves: bool = False, roots_a: Integers | None = None,
          roots_b: Integers | None = None) -> tuple[Integers, NDArray[np.int32]]:
    """All pairs of triangles that intersect or, with a margin, that may be at most `margin` m apart; with leaves=True
    all pairs of leaves whose boxes may be.

    Returns offsets (n + 1,) and pairs (k, 2), rows of `corners` of a and b, or of `box`: those of query i are
    pairs[offsets[i]:offsets[i + 1]]. With a margin no pair within it is missing, but some are farther apart. Other
    arguments and errors as in `intersects`; raises ValueError for a negative margin.
    """
    poses_a, poses_b, roots_a, roots_b = _checked(a, poses_a, b, poses_b, roots_a, roots_b)
    if margin is not None and not 0.0 <= margin <= MAX_COORDINATE:
        raise ValueError(f"margin: expected a distance from 0 to {MAX_COORDINATE:g} m, got {margin}")
    query = NEAR_LEAVES if leaves else TRIANGLES if margin is None else NEAR_TRIANGLES
    distance = 0.0 if margin is None else float(margin)
    offsets, found, work = np.empty(len(poses_a) + 1, np.int64), np.empty((256 * len(poses_a), 2), np.int32), scratch()
    count = _find_all(*a, *b, *work, roots_a, poses_a, roots_b, poses_b, query, distance, offsets, found)
    if count > len(found):
        found = np.empty((count, 2), np.int32)
        _find_all(*a, *b, *work, roots_a, poses_a, roots_b, poses_b, query, distance, offsets, found)
    return offsets, found[:count]


def contacts(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, *, roots_a: Integers | None = None,
             roots_b: Integers | None = None) -> tuple[Integers, NDArray[np.int32], Floats, Floats, Floats]:
    """All contacts: offsets and pairs of triangles that intersect, as from `pairs`, and for each pair a point (k, 3) m,
    the unit normal from a to b (k, 3), both in the world, and the depth (k,) m; see `triangle.contact`."""
    offsets, found = pairs(a, poses_a, b, poses_b, roots_a=roots_a, roots_b=roots_b)
    result = np.empty((len(found), 7))
    _contacts_all(a.corners, np.ascontiguousarray(poses_a, np.float64), b.corners,
                  np.ascontiguousarray(poses_b, np.float64), offsets, found, result)
    return offsets, found, result[:, :3], result[:, 3:6], result[:, 6]


def _checked(a: Octree, poses_a: Floats, b: Octree, poses_b: Floats, roots_a: Integers | None,
             roots_b: Integers | None) -> tuple[Floats, Floats, Integers, Integers]:
    """Poses and roots as contiguous arrays. Raises ValueError for wrong shapes, poses or indices."""
    poses_a, poses_b = np.ascontiguousarray(poses_a, np.float64), np.ascontiguousarray(poses_b, np.float64)
    for name, poses in (("poses_a", poses_a), ("poses_b", poses_b)):
        if poses.ndim != 2 or poses.shape[1] != 7 or len(poses) != len(poses_a):
            raise ValueError(f"{name}: expected shape ({len(poses_a)}, 7), got {poses.shape}")
        check_poses(name, poses)
    roots = []
    for name, given, tree in (("roots_a", roots_a, a), ("roots_b", roots_b, b)):
        indices = np.zeros(len(poses_a), np.int64) if given is None else np.ascontiguousarray(given, np.int64)
        if indices.shape != (len(poses_a),) or (
                len(indices) and not 0 <= indices.min() <= indices.max() < len(tree.box)):
            raise ValueError(f"{name}: expected {len(poses_a)} indices below {len(tree.box)}, got "
                             f"{np.array2string(indices, threshold=8)}")
        roots.append(indices)
    return poses_a, poses_b, roots[0], roots[1]


def check_poses(name: str, poses: Floats) -> None:
    """Raises ValueError, with the argument's name, if a row of poses (n, 7) is not a pose."""
    bad = _first_invalid_pose(poses)
    if bad >= 0:
        raise ValueError(f"{name}: expected positions up to {MAX_COORDINATE:g} m and unit quaternions, got "
                         f"{poses[bad].tolist()} in row {bad}")


@kernel
def _first_invalid_pose(poses):
    """The index of the first invalid pose, -1 if all are valid. Comparisons are written so that NaN is invalid."""
    for k in range(poses.shape[0]):
        x, y, z, w = poses[k, 3], poses[k, 4], poses[k, 5], poses[k, 6]
        square = x * x + y * y + z * z + w * w
        if not (abs(poses[k, 0]) <= MAX_COORDINATE and abs(poses[k, 1]) <= MAX_COORDINATE
                and abs(poses[k, 2]) <= MAX_COORDINATE and abs(square - 1.0) <= 2.0 * UNIT_TOLERANCE):
            return k
    return -1


@allocating
def _intersects_all(box_a, link_a, corners_a, face_a, node_box_a, child_boxes_a, child_group_a,
                    box_b, link_b, corners_b, face_b, node_box_b, child_boxes_b, child_group_b,
                    stack, transforms, box, corners, leaves, axis, half, total, probe,
                    roots_a, poses_a, roots_b, poses_b, query, out):
    """Writes the answers of n queries ANY_LEAVES or ANY_TRIANGLES to out (n,).

    Each array of the two octrees and of the scratch is a parameter of its own: from Python, passing a record of them
    takes longer than a query.
    """
    a = Octree(box_a, link_a, corners_a, face_a, node_box_a, child_boxes_a, child_group_a)
    b = Octree(box_b, link_b, corners_b, face_b, node_box_b, child_boxes_b, child_group_b)
    work = TraversalScratch(stack, transforms, box, corners, leaves, axis, half, total, probe)
    none = np.empty((0, 2), np.int32)
    for k in range(out.shape[0]):
        out[k] = traverse(a, roots_a[k], poses_a[k], b, roots_b[k], poses_b[k], query, 0.0, work, none, 0) > 0


@allocating
def _find_all(box_a, link_a, corners_a, face_a, node_box_a, child_boxes_a, child_group_a,
              box_b, link_b, corners_b, face_b, node_box_b, child_boxes_b, child_group_b,
              stack, transforms, box, corners, leaves, axis, half, total, probe,
              roots_a, poses_a, roots_b, poses_b, query, margin, offsets, pairs):
    """Writes the results of n queries TRIANGLES, NEAR_TRIANGLES or NEAR_LEAVES to pairs (k, 2) and returns their
    number; those that do not fit are counted, not written. offsets: (n + 1,) where the results of each query begin.

    For the number of parameters see `_intersects_all`.
    """
    a = Octree(box_a, link_a, corners_a, face_a, node_box_a, child_boxes_a, child_group_a)
    b = Octree(box_b, link_b, corners_b, face_b, node_box_b, child_boxes_b, child_group_b)
    work = TraversalScratch(stack, transforms, box, corners, leaves, axis, half, total, probe)
    count = 0
    for k in range(poses_a.shape[0]):
        offsets[k] = count
        count = traverse(a, roots_a[k], poses_a[k], b, roots_b[k], poses_b[k], query, margin, work, pairs, count)
    offsets[poses_a.shape[0]] = count
    return count


@kernel
def _contacts_all(corners_a, poses_a, corners_b, poses_b, offsets, pairs, result):
    """Writes point, normal and depth of each pair of triangles to result (k, 7); offsets, pairs: from `_find_all`."""
    for k in range(poses_a.shape[0]):
        pose_a, pose_b = poses_a[k], poses_b[k]
        rotation_a, rotation_b = pose_rotation(pose_a), pose_rotation(pose_b)
        for n in range(offsets[k], offsets[k + 1]):
            result[n] = contact(
                transform_triangle(corners_a, pairs[n, 0], rotation_a, pose_a[0], pose_a[1], pose_a[2]),
                transform_triangle(corners_b, pairs[n, 1], rotation_b, pose_b[0], pose_b[1], pose_b[2]))


@allocating
def traverse(a, root_a, pose_a, b, root_b, pose_b, query, margin, work, pairs, found):
    """Answers one query: writes the pairs found after the first `found` of pairs (k, 2) and returns the new number.

    a, b: Octrees; root_a, root_b: their root nodes; pose_a, pose_b: (7,). margin: m, of the NEAR queries. work:
    TraversalScratch. Pairs that do not fit are counted, not written. ANY_LEAVES and ANY_TRIANGLES write no pairs and
    stop at the first.
    """
    axes_error = relative_transforms(pose_a, pose_b, work.transforms)
    reach_a, reach_b = _reach(a.box, root_a), _reach(b.box, root_b)
    distance_a, distance_b = _length(pose_a[0], pose_a[1], pose_a[2]), _length(pose_b[0], pose_b[1], pose_b[2])
    size = reach_a + reach_b + _length(work.transforms[0, 9], work.transforms[0, 10], work.transforms[0, 11])
    error = RELATIVE_ERROR * (distance_a + distance_b + size) + 4.0 * axes_error * size
    pad_a, pad_b = PAD * (distance_a + reach_a), PAD * (distance_b + reach_b)
    slack = np.float32(1.00001 * (margin + error + SLACK * size + pad_a + pad_b) + MIN_SLACK)
    # Taken out of the records once: each access to a field counts references.
    box_a, link_a, corners_a, node_box_a = a.box, a.link, a.corners, a.node_box
    box_b, link_b, corners_b, node_box_b = b.box, b.link, b.corners, b.node_box
    child_boxes_a, child_group_a, child_boxes_b, child_group_b = (a.child_boxes, a.child_group, b.child_boxes,
                                                                  b.child_group)
    stack, transforms, q, triangle_b = work.stack, work.transforms, work.query_box, work.triangle
    aligned = query in (ANY_LEAVES, NEAR_LEAVES)
    stack[0, 0], stack[0, 1] = root_a, root_b
    top = 1
    while top > 0:
        top -= 1
        node_a, node_b = stack[top, 0], stack[top, 1]
        group_a, group_b = child_group_a[node_a], child_group_b[node_b]
        if group_a < 0 and group_b < 0:
            if query == ANY_LEAVES:
                found += _leaf_boxes_overlap(box_a, node_a, pose_a, pad_a, box_b, node_b, pose_b, pad_b, work)
            elif query == NEAR_LEAVES:
                if found < pairs.shape[0]:
                    pairs[found, 0], pairs[found, 1] = node_a, node_b
                found += 1
            else:
                found = _leaf_triangles(box_a, link_a, corners_a, node_a, pose_a, box_b, link_b, corners_b, node_b,
                                        pose_b, query, margin, error, transforms, triangle_b, pairs, found)
            if query <= ANY_TRIANGLES and found > 0:
                break
            continue
        opens_a = group_b < 0 or (group_a >= 0 and _size(node_box_a, node_a) >= _size(node_box_b, node_b))
        if opens_a:
            first, count, fixed = link_a[node_a, 0], link_a[node_a, 1], node_b
            _box_to_frame(node_box_b, node_b, transforms, 0, slack, aligned, q)
            mask, deepest = _overlapping(child_boxes_a, group_a, q, np.float32(size), aligned)
        else:
            first, count, fixed = link_b[node_b, 0], link_b[node_b, 1], node_a
            _box_to_frame(node_box_a, node_a, transforms, 1, slack, aligned, q)
            mask, deepest = _overlapping(child_boxes_b, group_b, q, np.float32(size), aligned)
        if mask == 0:
            continue
        mask ^= 1 << deepest
        for k in range(count + 1):
            if k == count:
                child = first + deepest  # pushed last, so tested first
            elif (mask >> k) & 1:
                child = first + k
            else:
                continue
            stack[top, 0], stack[top, 1] = (child, fixed) if opens_a else (fixed, child)
            top += 1
    return found


@kernel
def _box_to_frame(boxes, node, transforms, s, slack, aligned, q):
    """Writes a node's box, grown by `slack`, in the frame of the other tree to q (15,), as `overlapping_children` or
    (aligned) `overlapping_aligned_children` takes it. s: 0 for a node of b, 1 for a node of a."""
    first = 15 if aligned else 9
    q[9], q[10], q[11] = point_to_frame(transforms, s, boxes[node, first], boxes[node, first + 1],
                                        boxes[node, first + 2])
    for k in range(3):
        q[12 + k] = boxes[node, first + 3 + k] + slack
    if aligned:
        for k in range(9):
            q[k] = transforms[s, k]
    else:
        for k in range(3):
            q[3 * k], q[3 * k + 1], q[3 * k + 2] = direction_to_frame(
                transforms, s, boxes[node, 3 * k], boxes[node, 3 * k + 1], boxes[node, 3 * k + 2])


@kernel
def _overlapping(child_boxes, g, q, size, aligned):
    """The children of group g that may overlap box q, as bits, and the index of the one to test first."""
    if aligned:
        return overlapping_aligned_children(child_boxes, g, q, size)
    return overlapping_children(child_boxes, g, q, size)


@allocating
def _leaf_triangles(box_a, link_a, corners_a, node_a, pose_a, box_b, link_b, corners_b, node_b, pose_b, query, margin,
                    error, transforms, triangle_b, pairs, found):
    """Answers a query about triangles for two leaves; results as those of `traverse`.

    error: upper bound of the error of a corner in the other frame, m. triangle_b: (1, 3, 3) scratch. Each array is a
    parameter of its own, since every access to a field of a record counts references, and this is the innermost loop.
    """
    first_a, first_b = link_a[node_a, 2], link_b[node_b, 2]
    last_a, last_b = first_a + link_a[node_a, 3], first_b + link_b[node_b, 3]
    # Upper bound of the differences of coordinates, once the box of b's triangle overlaps that of a's leaf.
    largest = 2.0 * (max(box_a[node_a, 3], box_a[node_a, 4], box_a[node_a, 5])
                     + box_b[node_b, 3] + box_b[node_b, 4] + box_b[node_b, 5]) + margin + error
    # A determinant is the sum of six products of three differences, each with an error of twice `error` and its own
    # rounding.
    bound = 48.0 * error * largest * largest + UNDERFLOW_ERROR
    for j in range(first_b, last_b):
        for k in range(3):
            triangle_b[0, k, 0], triangle_b[0, k, 1], triangle_b[0, k, 2] = point_to_frame(
                transforms, 0, corners_b[j, k, 0], corners_b[j, k, 1], corners_b[j, k, 2])
        if is_outside_box(triangle_b, box_a, node_a, margin + error):
            continue
        nx, ny, nz = triangle_normal(triangle_b, 0)
        for i in range(first_a, last_a):
            if query == NEAR_TRIANGLES:
                if is_farther_apart(corners_a, i, triangle_b, nx, ny, nz, margin + error, bound):
                    continue
            else:
                answer = intersection_filter(corners_a, i, triangle_b, nx, ny, nz, bound)
                if answer == UNDECIDED:
                    if is_farther_apart(corners_a, i, triangle_b, nx, ny, nz, error, bound):
                        continue
                    answer = triangles_intersect(
                        transform_triangle(corners_a, i, pose_rotation(pose_a), pose_a[0], pose_a[1], pose_a[2]),
                        transform_triangle(corners_b, j, pose_rotation(pose_b), pose_b[0], pose_b[1], pose_b[2]))
                if answer == DISJOINT:
                    continue
                if query == ANY_TRIANGLES:
                    return found + 1
            if found < pairs.shape[0]:
                pairs[found, 0], pairs[found, 1] = i, j
            found += 1
    return found


@kernel
def _leaf_boxes_overlap(box_a, i, pose_a, pad_a, box_b, j, pose_b, pad_b, work):
    """Whether the boxes of leaves i and j, grown by their pads, m, overlap in the world: exactly for their world
    coordinates as rounded."""
    a, b = work.leaf_boxes[0], work.leaf_boxes[1]
    transform_box(box_a, i, pose_rotation(pose_a), pose_a, pad_a, a)
    transform_box(box_b, j, pose_rotation(pose_b), pose_b, pad_b, b)
    return boxes_touch(a[:3], a[3:12], a[12:], b[:3], b[3:12], b[12:], work.axis, work.half, work.total, work.probe)


@kernel
def _size(boxes, node):
    """The sum of the half extents of a node's oriented box, m."""
    return boxes[node, 12] + boxes[node, 13] + boxes[node, 14]


@kernel
def _length(x, y, z):
    """The length of a vector."""
    return np.sqrt(x * x + y * y + z * z)


@kernel
def _reach(box, node):
    """Upper bound of the distance of a node's points from the origin of its model, m."""
    return _length(abs(box[node, 0]) + box[node, 3], abs(box[node, 1]) + box[node, 4], abs(box[node, 2]) + box[node, 5])
