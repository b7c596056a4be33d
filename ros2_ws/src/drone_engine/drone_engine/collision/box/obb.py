"""Pairs of oriented boxes: whether they touch, exactly, and where.

A box is the set of points center + t0 axes[0] + t1 axes[1] + t2 axes[2], |ti| <= half[i], for the numbers as stored,
axes one a row, half extents in m. Boxes are closed: touching is a hit. Two boxes touch if no plane spanned by two of
their six axes separates them, which makes 15 separating axes (Gottschalk, Lin and Manocha 1996, OBBTree): for the two
vectors u, v and the offset d of the centers, |det(u, v, d)| <= sum of half_k |det(u, v, axis_k)| over all six.

Blocks of pairs are tested at once in floating point; pairs that its error bound leaves undecided go to `boxes_touch`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box.clipping import CUT, write_edge_manifolds, write_face_manifolds
from drone_engine.collision.box.exact import boxes_touch
from drone_engine.collision.box.sat import (
    BLOCK,
    CENTER_A,
    MARGIN,
    SWAPPED,
    TABLE,
    UNDECIDED,
    WIDEST,
    classify,
    find_contact_axes,
    load_pairs,
)
from drone_engine.collision.exact_arithmetic import zeros
from drone_engine.collision.manifold import POINTS
from drone_engine.kernel import allocating, kernel

ROUNDING = 1e-12  # of the size of a touching pair: how far apart rounding may make it look


class Boxes(NamedTuple):
    """n boxes in the world frame."""

    center: Floats  # (n, 3) m
    axes: Floats  # (n, 3, 3) unit, one a row
    half: Floats  # (n, 3) half extents, m


class BoxScratch(NamedTuple):
    """Scratch of the kernels that compute contacts of boxes."""

    table: Floats  # (TABLE,) as in sat.py
    cut: Floats  # (CUT,) as in clipping.py
    box_a: Integers  # (BLOCK,) index of the first box of each column
    box_b: Integers  # (BLOCK,) index of the second box
    row: Integers  # (BLOCK,) index of the manifold that a column writes, -1 for none


def scratch() -> BoxScratch:
    """Empty arrays of the right sizes."""
    return BoxScratch(np.zeros(TABLE), np.empty(CUT), *np.empty((3, BLOCK), np.int64))


@kernel
def _write_decided(first, count, verdict, hit):
    """Writes the verdicts of a block to hit[first:]; returns 1 if any pair is undecided, else 0."""
    seen = np.uint8(0)
    for k in range(count):
        seen |= verdict[k]
        hit[first + k] = verdict[k] >> 1
    return seen & UNDECIDED


@kernel
def _write_undecided(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, hit, verdict, axis, half, total,
                     probe):
    """Writes the exact answers for the undecided pairs of a block to hit[first:]; returns the first pair with a number
    that no box has, or -1. The boxes are flat arrays; axis, half, total, probe: scratch of `boxes_touch`."""
    for k in range(first, first + count):
        if verdict[k - first] == UNDECIDED:
            p, q, r, s = 3 * k, 3 * k + 3, 9 * k, 9 * k + 9
            answer = boxes_touch(center_a[p:q], axes_a[r:s], half_a[p:q], center_b[p:q], axes_b[r:s], half_b[p:q],
                                 axis, half, total, probe)
            if answer < 0:
                return k
            hit[k] = answer
    return -1


@allocating
def _intersects(center_a, axes_a, half_a, center_b, axes_b, half_b, hit):
    """Writes whether the boxes of each pair touch to hit (n,), uint8; returns the first pair with a number that no box
    has, or -1. The boxes are flat arrays."""
    table, verdict = np.zeros(TABLE), np.empty(BLOCK, np.uint8)
    axis, half, total, probe = np.empty((9, 3)), np.empty(9), zeros(), zeros()
    for first in range(0, len(hit), BLOCK):
        count = min(BLOCK, len(hit) - first)
        load_pairs(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, table)
        classify(table, verdict)
        if _write_decided(first, count, verdict, hit):
            bad = _write_undecided(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, hit, verdict, axis,
                                   half, total, probe)
            if bad >= 0:
                return bad
    return -1


def intersects(center_a: ArrayLike, axes_a: ArrayLike, half_a: ArrayLike,
               center_b: ArrayLike, axes_b: ArrayLike, half_b: ArrayLike) -> Booleans:
    """Whether boxes a and b of each of n pairs touch: (n,).

    Centers (n, 3), axes (n, 3, 3), one a row, and half extents (n, 3), float64. The answer is exact for any finite
    numbers as stored, with axes of any length and angle; it is fast where they are orthonormal up to rounding. Raises
    ValueError for other shapes, for numbers that are not finite and for negative half extents.
    """
    pairs = _checked_pairs(center_a, axes_a, half_a, center_b, axes_b, half_b)
    hit = np.empty(len(pairs[0]), np.bool_)
    center_a, axes_a, half_a, center_b, axes_b, half_b = pairs
    bad = _intersects(center_a.reshape(-1), axes_a.reshape(-1), half_a.reshape(-1), center_b.reshape(-1),
                      axes_b.reshape(-1), half_b.reshape(-1), hit.view(np.uint8))
    if bad >= 0:
        raise ValueError(_error_of_pair(pairs, bad))
    return hit


class BoxContacts(NamedTuple):
    """The k pairs that touch, and their m points: those of pair number[i] are first[i] to first[i + 1]."""

    number: Integers  # (k,) indices of the pairs, ascending
    first: Integers  # (k + 1,)
    normal: Floats  # (k, 3) unit, from a to b
    point: Floats  # (m, 3) m, midway between the surfaces
    separation: Floats  # (m,) m, negative where the boxes overlap
    feature: Integers  # (m,) identifies a point from one step to the next


def contacts(center_a: ArrayLike, axes_a: ArrayLike, half_a: ArrayLike, center_b: ArrayLike, axes_b: ArrayLike,
             half_b: ArrayLike) -> BoxContacts:
    """The contacts of boxes a and b of each pair, with up to eight points; arguments and errors as for `intersects`.

    Which pairs touch is exact. Points are right up to rounding if the axes are orthonormal up to rounding.
    """
    pairs = _checked_pairs(center_a, axes_a, half_a, center_b, axes_b, half_b)
    n = len(pairs[0])
    number, first, normal = np.empty(n, np.int64), np.empty(n + 1, np.int64), np.empty((n, 3))
    point, separation, feature = np.empty((n * POINTS, 3)), np.empty(n * POINTS), np.empty(n * POINTS, np.int64)
    found, bad = _contacts(*[*pairs, number, first, normal, point, separation, feature])
    if bad >= 0:
        raise ValueError(_error_of_pair(pairs, bad))
    m = first[found]
    return BoxContacts(number[:found], first[: found + 1], normal[:found], point[:m], separation[:m], feature[:m])


@allocating
def _contacts(center_a, axes_a, half_a, center_b, axes_b, half_b, number, first_point, normal, point, separation,
              feature):
    """Writes the contacts of n pairs as in `BoxContacts`, where there is room for n pairs of POINTS points.

    Returns how many pairs touch, and the first pair with a number that no box has, or -1.
    """
    table, verdict, hit = np.zeros(TABLE), np.empty(BLOCK, np.uint8), np.empty(len(number), np.uint8)
    axis, half, total, probe = np.empty((9, 3)), np.empty(9), zeros(), zeros()
    which, cut, row = np.empty(BLOCK, np.int64), np.empty(CUT), np.arange(BLOCK)
    boxes_a, boxes_b = Boxes(center_a, axes_a, half_a), Boxes(center_b, axes_b, half_b)
    flat = (center_a.reshape(-1), axes_a.reshape(-1), half_a.reshape(-1),
            center_b.reshape(-1), axes_b.reshape(-1), half_b.reshape(-1))
    # The manifolds of a block, which stay in the fastest cache: most of the room for eight points is unused.
    block_points, block_normal = np.empty(BLOCK, np.int64), np.empty((BLOCK, 3))
    block_point, block_separation = np.empty((BLOCK, POINTS, 3)), np.empty((BLOCK, POINTS))
    block_feature = np.empty((BLOCK, POINTS), np.int64)
    found = m = 0
    for first in range(0, len(number), BLOCK):
        size = min(BLOCK, len(number) - first)
        load_pairs(first, size, *flat, table)
        classify(table, verdict)
        if _write_decided(first, size, verdict, hit):
            bad = _write_undecided(first, size, *flat, hit, verdict, axis, half, total, probe)
            if bad >= 0:
                return found, bad
        hits = _list_hits(first, size, hit, which)
        load_ordered(table, hits, boxes_a, which, boxes_b, which)
        find_contact_axes(table, hits)
        write_edge_manifolds(table, hits, row, block_points, block_normal, block_point, block_separation, block_feature)
        write_face_manifolds(table, hits, row, block_points, block_normal, block_point, block_separation, block_feature,
                             cut)
        for k in range(hits):
            number[found], first_point[found] = which[k], m
            for c in range(3):
                normal[found, c] = block_normal[k, c]
            for p in range(block_points[k]):
                for c in range(3):
                    point[m, c] = block_point[k, p, c]
                separation[m], feature[m] = block_separation[k, p], block_feature[k, p]
                m += 1
            found += 1
    first_point[found] = m
    return found, -1


@kernel
def _list_hits(first, size, hit, which):
    """Writes the indices of the pairs that touch among first to first + size to `which`; returns how many there are."""
    hits = 0
    for k in range(first, first + size):
        which[hits] = k
        hits += hit[k]
    return hits


@kernel
def contact(boxes_a, i, boxes_b, j, margin, at, points, normal, point, separation, feature, scratch):
    """Writes the contact of box i of boxes_a and box j of boxes_b, if they are at most `margin` m apart, to row `at` of
    the last but one arrays; returns its number of points, 0 to 8.

    boxes_a, boxes_b: Boxes with orthonormal axes; points (m,), normal (m, 3), point (m, 8, 3), separation (m, 8) and
    feature (m, 8) as in ContactArrays; scratch: BoxScratch. Swapping a and b reverses the normal and changes nothing
    else.
    """
    table, row = scratch.table, scratch.row
    scratch.box_a[0], scratch.box_b[0], row[0] = i, j, at
    load_ordered(table, 1, boxes_a, scratch.box_a, boxes_b, scratch.box_b)
    find_contact_axes(table, 1)
    if table[WIDEST] > margin:
        return 0
    table[MARGIN] = margin
    write_edge_manifolds(table, 1, row, points, normal, point, separation, feature)
    write_face_manifolds(table, 1, row, points, normal, point, separation, feature, scratch.cut)
    return points[at]


@kernel
def load_ordered(table, count, boxes_a, of_a, boxes_b, of_b):
    """Writes box of_a[k] of boxes_a and box of_b[k] of boxes_b into column k of the table, for the first `count`, in an
    order that does not depend on which of them is a: so ties are broken the same way.

    The larger box comes first, or of two equal ones the lower one in the direction in which they are farthest apart.
    The margin is set to what rounding may add to the gap of two boxes that touch.
    """
    center_a, axes_a, half_a = boxes_a
    center_b, axes_b, half_b = boxes_b
    for k in range(count):
        i, j = of_a[k], of_b[k]
        x, y, z = center_b[j, 0] - center_a[i, 0], center_b[j, 1] - center_a[i, 1], center_b[j, 2] - center_a[i, 2]
        lead = x if (abs(x) >= abs(y)) & (abs(x) >= abs(z)) else y if abs(y) >= abs(z) else z
        swapped = lead < 0.0
        for c in range(2, -1, -1):
            swapped = half_a[i, c] < half_b[j, c] if half_a[i, c] != half_b[j, c] else swapped
        first, second = (1, 0) if swapped else (0, 1)  # the place of a and of b in the column
        sign = -1.0 if swapped else 1.0
        table[SWAPPED + k] = swapped
        size = 0.0
        table[k], table[BLOCK + k], table[2 * BLOCK + k] = sign * x, sign * y, sign * z
        for c in range(3):
            table[CENTER_A + c * BLOCK + k] = center_b[j, c] if swapped else center_a[i, c]
            table[(3 + 3 * first + c) * BLOCK + k], table[(3 + 3 * second + c) * BLOCK + k] = half_a[i, c], half_b[j, c]
            for m in range(3):
                table[(9 + 9 * first + 3 * m + c) * BLOCK + k] = axes_a[i, m, c]
                table[(9 + 9 * second + 3 * m + c) * BLOCK + k] = axes_b[j, m, c]
            size += half_a[i, c] + half_b[j, c]
        table[MARGIN + k] = ROUNDING * size


BoxPairs = tuple[Floats, Floats, Floats, Floats, Floats, Floats]
NAMES = ("center_a", "axes_a", "half_a", "center_b", "axes_b", "half_b")


def _checked_pairs(*arrays: ArrayLike) -> BoxPairs:
    """The arguments as contiguous float64 arrays; raises ValueError for other shapes."""
    pairs = [np.ascontiguousarray(array, np.float64) for array in arrays]
    n = len(pairs[0]) if pairs[0].ndim else 0
    for name, array in zip(NAMES, pairs, strict=True):
        expected = (n, 3, 3) if name.startswith("axes") else (n, 3)
        if array.shape != expected:
            raise ValueError(f"{name}: expected an array of shape {expected}, got {array.shape}")
    return pairs[0], pairs[1], pairs[2], pairs[3], pairs[4], pairs[5]


def _error_of_pair(pairs: BoxPairs, i: int) -> str:
    """The error message for pair i, which has a number that no box has."""
    for name, array in zip(NAMES, pairs, strict=True):
        if not np.isfinite(array[i]).all():
            return f"{name}[{i}]: expected finite numbers, got {array[i].tolist()}"
        if name.startswith("half") and (array[i] < 0.0).any():
            return f"{name}[{i}]: expected half extents that are not negative, got {array[i].tolist()}"
    raise AssertionError("all numbers of the pair are valid")
