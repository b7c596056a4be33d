"""Distance of the surfaces of two meshes: branch and bound over both octrees, with bounding spheres of the nodes."""

import math

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.collision.mesh.octree import MAX_DEPTH, Octree
from drone_engine.collision.triangle.closest import closest_points
from drone_engine.kernel import allocating, kernel
from drone_engine.math.rotation import matrix

STACK = 64 * MAX_DEPTH


@kernel
def _transformed_corners(t, r, shift):
    """The corners of triangle t (3, 3), rotated by r (9 numbers, row-major) and shifted (3,), as nine numbers."""
    return _transformed(r, shift, t[0]) + _transformed(r, shift, t[1]) + _transformed(r, shift, t[2])


@kernel
def _transformed(r, shift, point):
    """The point (3,) rotated by r (9 numbers, row-major) and shifted (3,), as three numbers."""
    x, y, z = point[0], point[1], point[2]
    return (r[0] * x + r[1] * y + r[2] * z + shift[0], r[3] * x + r[4] * y + r[5] * z + shift[1],
            r[6] * x + r[7] * y + r[8] * z + shift[2])


@kernel
def _lower_bound(box, i, r, shift, other, j):
    """Lower bound of the distance of two nodes, from their bounding spheres.

    box, other: nodes (k, 6), center and half extents; i, j: their rows; r, shift: transform from the second frame to
    the first.
    """
    x, y, z = _transformed(r, shift, other[j])
    dx, dy, dz = x - box[i, 0], y - box[i, 1], z - box[i, 2]
    reach = (math.sqrt(box[i, 3] ** 2 + box[i, 4] ** 2 + box[i, 5] ** 2)
             + math.sqrt(other[j, 3] ** 2 + other[j, 4] ** 2 + other[j, 5] ** 2))
    return math.sqrt(dx * dx + dy * dy + dz * dz) - reach


@allocating
def _search(box_a, link_a, corners_a, box_b, link_b, corners_b, r, shift):
    """Distance of two surfaces that do not intersect.

    box, link, corners: arrays of both octrees; r, shift: transform from the frame of b to that of a.
    """
    stack, bound = np.empty((STACK, 2), np.int32), np.empty(STACK)
    stack[0, 0], stack[0, 1], bound[0] = 0, 0, 0.0
    top, best = 1, np.inf
    while top > 0:
        top -= 1
        i, j = stack[top, 0], stack[top, 1]
        if bound[top] >= best:
            continue
        if link_a[i, 1] == 0 and link_b[j, 1] == 0:
            for t in range(link_b[j, 2], link_b[j, 2] + link_b[j, 3]):
                there = _transformed_corners(corners_b[t], r, shift)
                for s in range(link_a[i, 2], link_a[i, 2] + link_a[i, 3]):
                    here = corners_a[s]
                    best = min(best, math.sqrt(closest_points(
                        (here[0, 0], here[0, 1], here[0, 2], here[1, 0], here[1, 1], here[1, 2], here[2, 0],
                         here[2, 1], here[2, 2]), there)[0]))
            continue
        size_a = box_a[i, 3] + box_a[i, 4] + box_a[i, 5]
        opens_a = link_b[j, 1] == 0 or (link_a[i, 1] > 0 and size_a >= box_b[j, 3] + box_b[j, 4] + box_b[j, 5])
        base = top
        first, count = (link_a[i, 0], link_a[i, 1]) if opens_a else (link_b[j, 0], link_b[j, 1])
        for child in range(first, first + count):
            m, n = (child, j) if opens_a else (i, child)
            lower = _lower_bound(box_a, m, r, shift, box_b, n)
            if lower >= best:
                continue
            at = top
            while at > base and bound[at - 1] < lower:  # the nearest node is searched first
                bound[at], stack[at, 0], stack[at, 1] = bound[at - 1], stack[at - 1, 0], stack[at - 1, 1]
                at -= 1
            bound[at], stack[at, 0], stack[at, 1] = lower, m, n
            top += 1
    return best


def surface_distance(a: Octree, pose_a: Floats, b: Octree, pose_b: Floats) -> float:
    """Distance in m of the surfaces at poses (7,), exact up to rounding unless they intersect."""
    rotation_a, rotation_b = (np.array(matrix(*pose[3:])).reshape(3, 3) for pose in (pose_a, pose_b))
    rotation, shift = rotation_a.T @ rotation_b, rotation_a.T @ (pose_b[:3] - pose_a[:3])
    return float(_search(a.box, a.link, a.corners, b.box, b.link, b.corners, tuple(rotation.ravel()), shift))
