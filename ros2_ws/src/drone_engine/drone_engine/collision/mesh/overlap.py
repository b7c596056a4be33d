"""Contacts of two meshes whose surfaces intersect so deeply that no features oppose each other: the shortest way out.

The pairs of triangles that intersect form closed curves, along which each pair shares a triangle with the next. For
each curve the normal is the one, of all its faces, along which the triangles are parted by the shortest way.
"""

from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.mesh.features import POSITION, place_corners
from drone_engine.collision.mesh.topology import OPEN
from drone_engine.collision.triangle.contact import contact
from drone_engine.kernel import kernel
from drone_engine.math.scalar import max3, min3

MAX_PAIRS = 128  # of triangles; more are left out
MAX_NORMALS = 32  # of faces, per curve
SAME_NORMAL = 0.999  # cosine above which two normals count as one


class OverlapScratch(NamedTuple):
    """Buffers of `overlap_contacts`."""

    corners: Floats  # (MAX_PAIRS, 2, 3, 3) m, the triangles of each pair in the world
    curve: Integers  # (MAX_PAIRS,) first pair of each pair's curve
    normal: Floats  # (MAX_NORMALS, 3) candidates


def overlap_scratch() -> OverlapScratch:
    """New buffers for `overlap_contacts`."""
    return OverlapScratch(np.empty((MAX_PAIRS, 2, 3, 3)), np.empty(MAX_PAIRS, np.int64), np.empty((MAX_NORMALS, 3)))


@kernel
def overlap_contacts(count, pairs, rotation_a, rotation_b, tree, features, motion, scratch, out):
    """Writes the contacts of the first `count` pairs (k, 2) of intersecting triangles to the ContactBuffer `out`, one
    for each pair, and returns their number.

    rotation_a, rotation_b: nine numbers, row by row; tree: Octree; features: MeshFeatures; motion: of PairState.
    """
    count = min(count, MAX_PAIRS)
    corners, curve = scratch.corners, scratch.curve
    for k in range(count):
        for side in range(2):
            r = rotation_a if side == 0 else rotation_b
            place_corners(tree.corners[pairs[k, side]], r, motion[side, POSITION], motion[side, POSITION + 1],
                          motion[side, POSITION + 2], corners[k, side])
        curve[k] = k
    for k in range(count):
        for m in range(k):
            if pairs[k, 0] == pairs[m, 0] or pairs[k, 1] == pairs[m, 1]:
                one, other = min(curve[k], curve[m]), max(curve[k], curve[m])
                for p in range(k + 1):
                    if curve[p] == other:
                        curve[p] = one
    found = 0
    for first in range(count):
        if curve[first] == first:
            found = _curve_contacts(first, count, pairs, rotation_a, rotation_b, features, motion, scratch, out, found)
    return found


@kernel
def _curve_contacts(first, count, pairs, rotation_a, rotation_b, features, motion, scratch, out, found):
    """Appends the contacts of one curve, that of pair `first`; the other parameters as of `overlap_contacts`."""
    corners, curve, normal = scratch.corners, scratch.curve, scratch.normal
    normals = 0
    for k in range(first, count):
        if curve[k] != first:
            continue
        for side in range(2):
            normals = _add_normal(side, pairs[k, side], rotation_a if side == 0 else rotation_b, features, motion,
                                  normal, normals)
    best, least = 0, np.inf
    for n in range(normals):
        most = 0.0
        for k in range(first, count):
            if curve[k] == first:
                most = max(most, _way_out(corners[k], normal[n]))
        if most < least:
            best, least = n, most
    if normals == 0:
        return found
    for k in range(first, count):
        if curve[k] != first:
            continue
        if found < out.feature.shape[0]:
            a, b = corners[k, 0], corners[k, 1]
            at = contact((a[0, 0], a[0, 1], a[0, 2], a[1, 0], a[1, 1], a[1, 2], a[2, 0], a[2, 1], a[2, 2]),
                         (b[0, 0], b[0, 1], b[0, 2], b[1, 0], b[1, 1], b[1, 2], b[2, 0], b[2, 1], b[2, 2]))
            for c in range(3):
                out.normal[found, c] = normal[best, c]
                out.point[found, 0, c] = out.point[found, 1, c] = at[c]
            out.separation[found] = -_way_out(corners[k], normal[best])
            out.feature[found] = (np.int64(1) << 62) | np.int64(pairs[k, 0]) << 31 | np.int64(pairs[k, 1])
        found += 1
    return found


@kernel
def _add_normal(side, triangle, r, features, motion, normal, count):
    """Adds the normal of a triangle of body `side`, towards b, to the first `count` candidates unless it is there or
    does not fit; returns the new number."""
    u, v, w = features.normals[triangle, 0, 0], features.normals[triangle, 0, 1], features.normals[triangle, 0, 2]
    x, y, z = r[0] * u + r[1] * v + r[2] * w, r[3] * u + r[4] * v + r[5] * w, r[6] * u + r[7] * v + r[8] * w
    if features.owned[triangle] & OPEN:
        p, q = motion[0], motion[1]
        turn = (x * (q[POSITION] - p[POSITION]) + y * (q[POSITION + 1] - p[POSITION + 1])
                + z * (q[POSITION + 2] - p[POSITION + 2])) < 0.0
    else:
        turn = side == 1
    if turn:
        x, y, z = -x, -y, -z
    if count == normal.shape[0] or x * x + y * y + z * z < 0.5:
        return count
    for n in range(count):
        if x * normal[n, 0] + y * normal[n, 1] + z * normal[n, 2] > SAME_NORMAL:
            return count
    normal[count, 0], normal[count, 1], normal[count, 2] = x, y, z
    return count + 1


@kernel
def _way_out(corners, n):
    """How far b's triangle has to move along the unit vector n to leave a's, m, 0 or more; corners: (2, 3, 3)."""
    a, b = corners[0], corners[1]
    high = max3(_along(a, 0, n), _along(a, 1, n), _along(a, 2, n))
    low = min3(_along(b, 0, n), _along(b, 1, n), _along(b, 2, n))
    return max(high - low, 0.0)


@kernel
def _along(corners, i, n):
    """The coordinate of corner i along n."""
    return corners[i, 0] * n[0] + corners[i, 1] * n[1] + corners[i, 2] * n[2]
