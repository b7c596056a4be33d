"""Oriented boxes: whether two touch, exactly, and where.

A box is the set of points center + t0 axes[0] + t1 axes[1] + t2 axes[2], |ti| <= half[i], of the numbers as stored,
axes one a row, half extents in m. Boxes are closed: touching is a hit. Two boxes touch if no plane that two of their
six axes span separates them, which makes 15 separating axes (Gottschalk, Lin and Manocha 1996, OBBTree): for the two
vectors u, v and the offset d of the centres, |det(u, v, d)| <= sum of half_k |det(u, v, axis_k)| over all six.

Blocks of pairs are judged at once in floating point; what the error bound leaves open goes to `separation.touch`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision import exact_arithmetic as exact
from drone_engine.collision.box import exact as separation
from drone_engine.collision.box.clipping import CUT, cross_edges, cut_faces
from drone_engine.collision.box.sat import BLOCK, MARGIN, PLACE, SWAPPED, TABLE, WIDEST, gather, judge, rank
from drone_engine.collision.manifold import POINTS
from drone_engine.kernel import kernel

ROUNDED = 1e-12  # of the size of a pair that touches: how far apart rounding may make it look


@kernel
def _note(first, count, verdict, hit):
    """Writes the answers that are known; returns whether there are others."""
    seen = np.uint8(0)
    for k in range(count):
        seen |= verdict[k]
        hit[first + k] = verdict[k] >> 1
    return seen & 1


@kernel
def _settle(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, hit, verdict, axis, half, total, probe):
    """Writes the answers that are open; returns a pair with a number that no box has, or -1. After verdict: scratch."""
    for k in range(first, first + count):
        if verdict[k - first] == 1:
            p, q, r, s = 3 * k, 3 * k + 3, 9 * k, 9 * k + 9
            answer = separation.touch(center_a[p:q], axes_a[r:s], half_a[p:q], center_b[p:q], axes_b[r:s],
                                      half_b[p:q], axis, half, total, probe)
            if answer < 0:
                return k
            hit[k] = answer
    return -1


@kernel
def _intersects(center_a, axes_a, half_a, center_b, axes_b, half_b, hit):
    """Writes all answers; returns the first pair with a number that no box has, or -1. All arrays are flat."""
    table, verdict = np.zeros(TABLE), np.empty(BLOCK, np.uint8)
    axis, half, total, probe = np.empty((9, 3)), np.empty(9), exact.zeros(), exact.zeros()
    for first in range(0, len(hit), BLOCK):
        count = min(BLOCK, len(hit) - first)
        gather(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, table)
        judge(table, verdict)
        if _note(first, count, verdict, hit):
            bad = _settle(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, hit, verdict, axis, half,
                          total, probe)
            if bad >= 0:
                return bad
    return -1


def intersects(center_a: ArrayLike, axes_a: ArrayLike, half_a: ArrayLike,
               center_b: ArrayLike, axes_b: ArrayLike, half_b: ArrayLike) -> Booleans:
    """Whether boxes a and b of each pair touch: (n,). Shapes (n, 3), (n, 3, 3) with an axis a row, (n, 3); float64.

    Exact for any finite numbers as stored, axes of any length and angle included, quick where they are orthonormal up
    to rounding. ValueError for other shapes, numbers that are not finite and negative half extents.
    """
    boxes = _pairs(center_a, axes_a, half_a, center_b, axes_b, half_b)
    hit = np.empty(len(boxes[0]), np.bool_)
    center_a, axes_a, half_a, center_b, axes_b, half_b = boxes
    bad = _intersects(center_a.reshape(-1), axes_a.reshape(-1), half_a.reshape(-1), center_b.reshape(-1),
                      axes_b.reshape(-1), half_b.reshape(-1), hit.view(np.uint8))
    if bad >= 0:
        raise ValueError(_what_is_wrong(boxes, bad))
    return hit


class Contacts(NamedTuple):
    """Of the k pairs that touch, exactly, and their m points: those of pair number[i] are first[i] to first[i + 1]."""

    number: Integers  # (k,) which pair, ascending
    first: Integers  # (k + 1,)
    normal: Floats  # (k, 3) unit, from a to b
    point: Floats  # (m, 3) m, midway between the surfaces
    separation: Floats  # (m,) m, negative where they overlap
    feature: Integers  # (m,) names a point from one step to the next


def contacts(center_a: ArrayLike, axes_a: ArrayLike, half_a: ArrayLike, center_b: ArrayLike, axes_b: ArrayLike,
             half_b: ArrayLike) -> Contacts:
    """Where boxes a and b of each pair touch, in up to eight points; arguments and errors as for `intersects`. Points
    are right up to rounding if axes are orthonormal up to rounding."""
    boxes = _pairs(center_a, axes_a, half_a, center_b, axes_b, half_b)
    n = len(boxes[0])
    number, first, normal = np.empty(n, np.int64), np.empty(n + 1, np.int64), np.empty((n, 3))
    point, apart, feature = np.empty((n * POINTS, 3)), np.empty(n * POINTS), np.empty(n * POINTS, np.int64)
    found, bad = _contacts(*[*boxes, number, first, normal, point, apart, feature])
    if bad >= 0:
        raise ValueError(_what_is_wrong(boxes, bad))
    m = first[found]
    return Contacts(number[:found], first[: found + 1], normal[:found], point[:m], apart[:m], feature[:m])


@kernel
def _contacts(center_a, axes_a, half_a, center_b, axes_b, half_b, number, first_point, normal, point, apart, feature):
    """Writes all contacts; returns how many, and the first pair with a number that no box has, or -1."""
    table, verdict, hit = np.zeros(TABLE), np.empty(BLOCK, np.uint8), np.empty(len(number), np.uint8)
    axis, half, total, probe = np.empty((9, 3)), np.empty(9), exact.zeros(), exact.zeros()
    which, cut, row = np.empty(BLOCK, np.int64), np.empty(CUT), np.arange(BLOCK)
    flat = (center_a.reshape(-1), axes_a.reshape(-1), half_a.reshape(-1),
            center_b.reshape(-1), axes_b.reshape(-1), half_b.reshape(-1))
    # A block's manifolds, which stay in the fastest cache: of the room for eight points most is not used.
    points, normals, spots = np.empty(BLOCK, np.int64), np.empty((BLOCK, 3)), np.empty((BLOCK, POINTS, 3))
    gaps, names = np.empty((BLOCK, POINTS)), np.empty((BLOCK, POINTS), np.int64)
    found = m = 0
    for first in range(0, len(number), BLOCK):
        size = min(BLOCK, len(number) - first)
        gather(first, size, *flat, table)
        judge(table, verdict)
        if _note(first, size, verdict, hit):
            bad = _settle(first, size, *flat, hit, verdict, axis, half, total, probe)
            if bad >= 0:
                return found, bad
        hits = _list_hits(first, size, hit, which)
        enter(table, hits, center_a, axes_a, half_a, which, center_b, axes_b, half_b, which)
        rank(table, hits)
        cross_edges(table, hits, row, points, normals, spots, gaps, names)
        cut_faces(table, hits, row, points, normals, spots, gaps, names, cut)
        for k in range(hits):
            number[found], first_point[found] = which[k], m
            for c in range(3):
                normal[found, c] = normals[k, c]
            for p in range(points[k]):
                for c in range(3):
                    point[m, c] = spots[k, p, c]
                apart[m], feature[m] = gaps[k, p], names[k, p]
                m += 1
            found += 1
    first_point[found] = m
    return found, -1


@kernel
def _list_hits(first, size, hit, which):
    hits = 0
    for k in range(first, first + size):
        which[hits] = k
        hits += hit[k]
    return hits


@kernel
def contact(center_a, axes_a, half_a, i, center_b, axes_b, half_b, j, margin, at, points, normal, point, separation,
            feature, table, cut, index):
    """The contact of box i of a and box j of b, up to `margin` m apart: writes it as number `at` of the arrays, as
    `contacts` has them, and returns its points, 0 to 8. The last three are `scratch()`.

    Axes have to be orthonormal. Swapping a and b turns the normal, no more.
    """
    index[0], index[1], index[2] = i, j, at
    enter(table, 1, center_a, axes_a, half_a, index, center_b, axes_b, half_b, index[1:])
    rank(table, 1)
    if table[WIDEST] > margin:
        return 0
    table[MARGIN] = margin
    cross_edges(table, 1, index[2:], points, normal, point, separation, feature)
    cut_faces(table, 1, index[2:], points, normal, point, separation, feature, cut)
    return points[at]


def scratch() -> tuple[Floats, Floats, Integers]:
    """What `contact` works in."""
    return np.zeros(TABLE), np.empty(CUT), np.empty(3, np.int64)


@kernel
def enter(table, count, center_a, axes_a, half_a, of_a, center_b, axes_b, half_b, of_b):
    """Writes boxes of_a[k] of a and of_b[k] of b into column k, whichever is called a in the same order: the greater
    first, or of two equal ones the lower in the direction in which they are farthest apart. So ties end alike.

    The margin is that of two boxes that touch, but for rounding."""
    for k in range(count):
        i, j = of_a[k], of_b[k]
        x, y, z = center_b[j, 0] - center_a[i, 0], center_b[j, 1] - center_a[i, 1], center_b[j, 2] - center_a[i, 2]
        lead = x if (abs(x) >= abs(y)) & (abs(x) >= abs(z)) else y if abs(y) >= abs(z) else z
        swapped = lead < 0.0
        for c in range(2, -1, -1):
            swapped = half_a[i, c] < half_b[j, c] if half_a[i, c] != half_b[j, c] else swapped
        first, second = (1, 0) if swapped else (0, 1)  # the row of boxes that a, and that b, goes to
        sign = -1.0 if swapped else 1.0
        table[SWAPPED + k] = swapped
        size = 0.0
        table[k], table[BLOCK + k], table[2 * BLOCK + k] = sign * x, sign * y, sign * z
        for c in range(3):
            table[PLACE + c * BLOCK + k] = center_b[j, c] if swapped else center_a[i, c]
            table[(3 + 3 * first + c) * BLOCK + k], table[(3 + 3 * second + c) * BLOCK + k] = half_a[i, c], half_b[j, c]
            for m in range(3):
                table[(9 + 9 * first + 3 * m + c) * BLOCK + k] = axes_a[i, m, c]
                table[(9 + 9 * second + 3 * m + c) * BLOCK + k] = axes_b[j, m, c]
            size += half_a[i, c] + half_b[j, c]
        table[MARGIN + k] = ROUNDED * size


Boxes = tuple[Floats, Floats, Floats, Floats, Floats, Floats]
NAMES = ("center_a", "axes_a", "half_a", "center_b", "axes_b", "half_b")


def _pairs(*arrays: ArrayLike) -> Boxes:
    """The arguments as contiguous float64 arrays of the right shapes."""
    pairs = [np.ascontiguousarray(array, np.float64) for array in arrays]
    n = len(pairs[0]) if pairs[0].ndim else 0
    for name, array in zip(NAMES, pairs, strict=True):
        expected = (n, 3, 3) if name.startswith("axes") else (n, 3)
        if array.shape != expected:
            raise ValueError(f"{name}: expected an array of shape {expected}, got {array.shape}")
    return pairs[0], pairs[1], pairs[2], pairs[3], pairs[4], pairs[5]


def _what_is_wrong(boxes: Boxes, i: int) -> str:
    for name, array in zip(NAMES, boxes, strict=True):
        if not np.isfinite(array[i]).all():
            return f"{name}[{i}]: expected finite numbers, got {array[i].tolist()}"
        if name.startswith("half") and (array[i] < 0.0).any():
            return f"{name}[{i}]: expected half extents that are not negative, got {array[i].tolist()}"
    raise AssertionError("no box is wrong")
