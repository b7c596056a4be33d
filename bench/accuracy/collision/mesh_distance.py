"""How far the surfaces of two meshes are apart: branch and bound over both octrees, by balls around the nodes."""

import math

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.collision.mesh.octree import DEPTH, Octree
from drone_engine.collision.triangle.closest import closest
from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix

STACK = 64 * DEPTH


@kernel
def _corners(t, r, shift):
    """Nine numbers: the corners of a triangle, turned and shifted."""
    return _seen(r, shift, t[0]) + _seen(r, shift, t[1]) + _seen(r, shift, t[2])


@kernel
def _seen(r, shift, point):
    x, y, z = point[0], point[1], point[2]
    return (r[0] * x + r[1] * y + r[2] * z + shift[0], r[3] * x + r[4] * y + r[5] * z + shift[1],
            r[6] * x + r[7] * y + r[8] * z + shift[2])


@kernel
def _least(box, i, r, shift, other, j):
    """What two nodes are apart at least, by their bounding balls; r, shift: from the frame of the second into the
    first's."""
    x, y, z = _seen(r, shift, other[j])
    dx, dy, dz = x - box[i, 0], y - box[i, 1], z - box[i, 2]
    reach = (math.sqrt(box[i, 3] ** 2 + box[i, 4] ** 2 + box[i, 5] ** 2)
             + math.sqrt(other[j, 3] ** 2 + other[j, 4] ** 2 + other[j, 5] ** 2))
    return math.sqrt(dx * dx + dy * dy + dz * dz) - reach


@kernel
def _gap(box_a, link_a, corners_a, box_b, link_b, corners_b, r, shift):
    """The least distance of two surfaces that do not meet, in the frame of a."""
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
                there = _corners(corners_b[t], r, shift)
                for s in range(link_a[i, 2], link_a[i, 2] + link_a[i, 3]):
                    here = corners_a[s]
                    best = min(best, math.sqrt(closest((here[0, 0], here[0, 1], here[0, 2], here[1, 0], here[1, 1],
                                                        here[1, 2], here[2, 0], here[2, 1], here[2, 2]), there)[0]))
            continue
        size_a = box_a[i, 3] + box_a[i, 4] + box_a[i, 5]
        opens_a = link_b[j, 1] == 0 or (link_a[i, 1] > 0 and size_a >= box_b[j, 3] + box_b[j, 4] + box_b[j, 5])
        base = top
        first, count = (link_a[i, 0], link_a[i, 1]) if opens_a else (link_b[j, 0], link_b[j, 1])
        for child in range(first, first + count):
            m, n = (child, j) if opens_a else (i, child)
            least = _least(box_a, m, r, shift, box_b, n)
            if least >= best:
                continue
            at = top
            while at > base and bound[at - 1] < least:  # the nearest is looked at first
                bound[at], stack[at, 0], stack[at, 1] = bound[at - 1], stack[at - 1, 0], stack[at - 1, 1]
                at -= 1
            bound[at], stack[at, 0], stack[at, 1] = least, m, n
            top += 1
    return best


def gap(a: Octree, pose_a: Floats, b: Octree, pose_b: Floats) -> float:
    """What the surfaces at poses (7,) are apart, m; right up to rounding if they do not meet."""
    turn_a, turn_b = (np.array(matrix(*pose[3:])).reshape(3, 3) for pose in (pose_a, pose_b))
    turn, shift = turn_a.T @ turn_b, turn_a.T @ (pose_b[:3] - pose_a[:3])
    return float(_gap(a.box, a.link, a.corners, b.box, b.link, b.corners, tuple(turn.ravel()), shift))
