"""Oriented boxes: whether two touch, exactly, and where.

A box is the set of points center + t0 axes[0] + t1 axes[1] + t2 axes[2], |ti| <= half[i], of the numbers as stored,
axes one a row, half extents in m. Boxes are closed: touching is a hit. Two boxes touch if no plane that two of their
six axes span separates them, which makes 15 separating axes (Gottschalk, Lin and Manocha 1996, OBBTree): for the two
vectors u, v and the offset d of the centres, |det(u, v, d)| <= sum of half_k |det(u, v, axis_k)| over all six.

Blocks of pairs are judged at once in floating point. What its error bound leaves open goes to `_settle`: axis by axis
with a bound of its own, then a point that is in both, then exact arithmetic for the axes that are still open.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from drone_sim.arrays import Booleans, Floats, Integers
from drone_sim.collision import exact, separation
from drone_sim.collision.manifold import POINTS, clip, cross_edges
from drone_sim.kernel import kernel

BLOCK = 32  # pairs, a column each of a table that stays in the fastest cache
ROWS = 28  # of it: offset 0, half extents 3 and 6, axes 9 and 18, tolerance 27
# Six squared singular values of two boxes' axes whose sum is at most 6 + SHAPE and whose product is at least
# (1 - SHAPE)^2 are all near 1 (arithmetic against geometric mean): each within 2.5 sqrt(SHAPE). So the axes are within
# 1.3 sqrt(SHAPE) of orthonormal ones, and no gap along the 15 axes is wrong by more than 5.3 times this, and rounding,
# of the size of the pair (offset and half extents).
SHAPE = 1e-13
TOLERANCE = 2.0**-18
TINY = 1e-290  # below this, rounding is no longer relative: all is left open
FACE_PREFERENCE = 0.02  # of the smallest half extent: how much better an edge axis must be than a face's
PARALLEL = 1e-6  # squared sine below which two edges span no axis of their own
ROUNDED = 1e-12  # of the size of a pair that touches: how far apart rounding may make it look


@kernel
def _gather(count, center_a, axes_a, half_a, center_b, axes_b, half_b, table):
    """Writes the pairs into the columns of the table, and for each how far from 0 a gap has to be to count."""
    for k in range(count):
        size, shape, negative = 0.0, 0.0, False
        for i in range(3):
            d, h, g = center_b[3 * k + i] - center_a[3 * k + i], half_a[3 * k + i], half_b[3 * k + i]
            table[i * BLOCK + k] = d
            table[(3 + i) * BLOCK + k] = h
            table[(6 + i) * BLOCK + k] = g
            size += abs(d) + (h + g)
            negative |= (h < 0.0) | (g < 0.0)
        for i in range(9):
            a, b = axes_a[9 * k + i], axes_b[9 * k + i]
            table[(9 + i) * BLOCK + k] = a
            table[(18 + i) * BLOCK + k] = b
            shape += a * a + b * b
        known = (shape <= 6.0 + 0.5 * SHAPE) & (not negative)
        table[27 * BLOCK + k] = size * TOLERANCE + TINY if known else np.inf


@kernel
def _judge(table, verdict):
    """Writes 0 for a pair that is apart, 2 for one that touches and 1 for one that is open. No branches: the compiler
    decides eight pairs at once."""
    for k in range(BLOCK):
        d0, d1, d2 = table[k], table[BLOCK + k], table[2 * BLOCK + k]
        h0, h1, h2 = table[3 * BLOCK + k], table[4 * BLOCK + k], table[5 * BLOCK + k]
        g0, g1, g2 = table[6 * BLOCK + k], table[7 * BLOCK + k], table[8 * BLOCK + k]
        a00, a01, a02 = table[9 * BLOCK + k], table[10 * BLOCK + k], table[11 * BLOCK + k]
        a10, a11, a12 = table[12 * BLOCK + k], table[13 * BLOCK + k], table[14 * BLOCK + k]
        a20, a21, a22 = table[15 * BLOCK + k], table[16 * BLOCK + k], table[17 * BLOCK + k]
        b00, b01, b02 = table[18 * BLOCK + k], table[19 * BLOCK + k], table[20 * BLOCK + k]
        b10, b11, b12 = table[21 * BLOCK + k], table[22 * BLOCK + k], table[23 * BLOCK + k]
        b20, b21, b22 = table[24 * BLOCK + k], table[25 * BLOCK + k], table[26 * BLOCK + k]
        t0, u0 = d0 * a00 + d1 * a01 + d2 * a02, d0 * b00 + d1 * b01 + d2 * b02
        t1, u1 = d0 * a10 + d1 * a11 + d2 * a12, d0 * b10 + d1 * b11 + d2 * b12
        t2, u2 = d0 * a20 + d1 * a21 + d2 * a22, d0 * b20 + d1 * b21 + d2 * b22
        r00, r10 = a00 * b00 + a01 * b01 + a02 * b02, a10 * b00 + a11 * b01 + a12 * b02
        r01, r11 = a00 * b10 + a01 * b11 + a02 * b12, a10 * b10 + a11 * b11 + a12 * b12
        r02, r12 = a00 * b20 + a01 * b21 + a02 * b22, a10 * b20 + a11 * b21 + a12 * b22
        r20 = a20 * b00 + a21 * b01 + a22 * b02
        r21 = a20 * b10 + a21 * b11 + a22 * b12
        r22 = a20 * b20 + a21 * b21 + a22 * b22
        q00, q01, q02 = abs(r00), abs(r01), abs(r02)
        q10, q11, q12 = abs(r10), abs(r11), abs(r12)
        q20, q21, q22 = abs(r20), abs(r21), abs(r22)
        gap = abs(t0) - (h0 + g0 * q00 + g1 * q01 + g2 * q02)
        gap = max(gap, abs(t1) - (h1 + g0 * q10 + g1 * q11 + g2 * q12))
        gap = max(gap, abs(t2) - (h2 + g0 * q20 + g1 * q21 + g2 * q22))
        gap = max(gap, abs(u0) - (g0 + h0 * q00 + h1 * q10 + h2 * q20))
        gap = max(gap, abs(u1) - (g1 + h0 * q01 + h1 * q11 + h2 * q21))
        gap = max(gap, abs(u2) - (g2 + h0 * q02 + h1 * q12 + h2 * q22))
        gap = max(gap, abs(t2 * r10 - t1 * r20) - (h1 * q20 + h2 * q10 + g1 * q02 + g2 * q01))
        gap = max(gap, abs(t2 * r11 - t1 * r21) - (h1 * q21 + h2 * q11 + g0 * q02 + g2 * q00))
        gap = max(gap, abs(t2 * r12 - t1 * r22) - (h1 * q22 + h2 * q12 + g0 * q01 + g1 * q00))
        gap = max(gap, abs(t0 * r20 - t2 * r00) - (h0 * q20 + h2 * q00 + g1 * q12 + g2 * q11))
        gap = max(gap, abs(t0 * r21 - t2 * r01) - (h0 * q21 + h2 * q01 + g0 * q12 + g2 * q10))
        gap = max(gap, abs(t0 * r22 - t2 * r02) - (h0 * q22 + h2 * q02 + g0 * q11 + g1 * q10))
        gap = max(gap, abs(t1 * r00 - t0 * r10) - (h0 * q10 + h1 * q00 + g1 * q22 + g2 * q21))
        gap = max(gap, abs(t1 * r01 - t0 * r11) - (h0 * q11 + h1 * q01 + g0 * q22 + g2 * q20))
        gap = max(gap, abs(t1 * r02 - t0 * r12) - (h0 * q12 + h1 * q02 + g0 * q21 + g1 * q20))
        volume = abs(r00 * (r11 * r22 - r12 * r21) - r01 * (r10 * r22 - r12 * r20) + r02 * (r10 * r21 - r11 * r20))
        tolerance = table[27 * BLOCK + k] if volume >= 1.0 - 0.5 * SHAPE else np.inf
        verdict[k] = (not gap > tolerance) + (gap < -tolerance)


@kernel
def _answer(first, center_a, axes_a, half_a, center_b, axes_b, half_b, hit, table, verdict, axis, half, total, probe):
    """Writes the exact answers for the block of pairs from the first on; returns a pair with a number that no box has,
    or -1. All arrays are flat; after hit: scratch."""
    count = min(BLOCK, len(hit) - first)
    p, q, r, s = 3 * first, 3 * (first + count), 9 * first, 9 * (first + count)
    _gather(count, center_a[p:q], axes_a[r:s], half_a[p:q], center_b[p:q], axes_b[r:s], half_b[p:q], table)
    _judge(table, verdict)
    seen = np.uint8(0)
    for k in range(count):
        seen |= verdict[k]
        hit[first + k] = verdict[k] >> 1
    if seen & 1:
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
    table, verdict = np.zeros(ROWS * BLOCK), np.empty(BLOCK, np.uint8)
    axis, half, total, probe = np.empty((9, 3)), np.empty(9), exact.zeros(), exact.zeros()
    for first in range(0, len(hit), BLOCK):
        bad = _answer(first, center_a, axes_a, half_a, center_b, axes_b, half_b, hit, table, verdict, axis, half,
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
    bad = _intersects(*[*(array.reshape(-1) for array in boxes), hit.view(np.uint8)])
    if bad >= 0:
        raise ValueError(_what_is_wrong(boxes, bad))
    return hit


def contacts(center_a: ArrayLike, axes_a: ArrayLike, half_a: ArrayLike, center_b: ArrayLike, axes_b: ArrayLike,
             half_b: ArrayLike) -> tuple[Integers, Floats, Floats, Floats, Integers]:
    """Where boxes a and b of each pair touch; arguments and errors as for `intersects`.

    Number of points (n,), 0 where they do not touch, exactly; unit normals from a to b (n, 3); points (n, 8, 3), midway
    between the surfaces; separations (n, 8), negative where they overlap; features (n, 8), which name a point from one
    step to the next. Points are right up to rounding if axes are orthonormal up to rounding.
    """
    boxes = _pairs(center_a, axes_a, half_a, center_b, axes_b, half_b)
    n = len(boxes[0])
    count, normal, point = np.zeros(n, np.int64), np.zeros((n, 3)), np.zeros((n, POINTS, 3))
    apart, feature = np.zeros((n, POINTS)), np.zeros((n, POINTS), np.int64)
    bad = _contacts(*[*boxes, count, normal, point, apart, feature])
    if bad >= 0:
        raise ValueError(_what_is_wrong(boxes, bad))
    return count, normal, point, apart, feature


@kernel
def _contacts(center_a, axes_a, half_a, center_b, axes_b, half_b, count, normal, point, apart, feature):
    """Writes all contacts; returns the first pair with a number that no box has, or -1."""
    table, verdict, hit = np.zeros(ROWS * BLOCK), np.empty(BLOCK, np.uint8), np.empty(len(count), np.uint8)
    axis, half, total, probe = np.empty((9, 3)), np.empty(9), exact.zeros(), exact.zeros()
    work = np.empty((3, 15))
    for first in range(0, len(count), BLOCK):
        bad = _answer(first, center_a.reshape(-1), axes_a.reshape(-1), half_a.reshape(-1), center_b.reshape(-1),
                      axes_b.reshape(-1), half_b.reshape(-1), hit, table, verdict, axis, half, total, probe)
        if bad >= 0:
            return bad
        for k in range(first, min(first + BLOCK, len(count))):
            count[k] = 0
            if hit[k]:
                size = 0.0
                for c in range(3):
                    size += half_a[k, c] + half_b[k, c]
                count[k] = contact(center_a, axes_a, half_a, k, center_b, axes_b, half_b, k, ROUNDED * size,
                                   normal[k], point[k], apart[k], feature[k], work)
    return -1


NAMES = ("center_a", "axes_a", "half_a", "center_b", "axes_b", "half_b")


def _pairs(*arrays: ArrayLike) -> list[Floats]:
    """The arguments as contiguous float64 arrays of the right shapes."""
    pairs = [np.ascontiguousarray(array, np.float64) for array in arrays]
    n = len(pairs[0]) if pairs[0].ndim else 0
    for name, array in zip(NAMES, pairs, strict=True):
        expected = (n, 3, 3) if name.startswith("axes") else (n, 3)
        if array.shape != expected:
            raise ValueError(f"{name}: expected an array of shape {expected}, got {array.shape}")
    return pairs


def _what_is_wrong(boxes: list[Floats], i: int) -> str:
    for name, array in zip(NAMES, boxes, strict=True):
        if not np.isfinite(array[i]).all():
            return f"{name}[{i}]: expected finite numbers, got {array[i].tolist()}"
        if name.startswith("half") and (array[i] < 0.0).any():
            return f"{name}[{i}]: expected half extents that are not negative, got {array[i].tolist()}"
    raise AssertionError("no box is wrong")


@kernel
def contact(center_a, axes_a, half_a, i, center_b, axes_b, half_b, j, margin, normal, point, separation, feature, work):
    """The contact of box i of a and box j of b, up to `margin` m apart: writes it and returns its points, 0 to 8.

    normal: (3,) unit vector from a to b. point: (8, 3) in the world, midway between the two surfaces.
    separation: (8,) m, negative where they overlap. feature: (8,) names a point from one step to the next.
    work: (3, 15) scratch. Axes have to be orthonormal up to rounding. Swapping a and b turns the normal, no more.
    """
    swapped = _belongs_first(center_b, half_b, j, center_a, half_a, i)
    one, two = 1 if swapped else 0, 0 if swapped else 1
    for c in range(3):
        work[one, c], work[two, c] = center_a[i, c], center_b[j, c]
        work[one, 12 + c], work[two, 12 + c] = half_a[i, c], half_b[j, c]
        for k in range(3):
            work[one, 3 + 3 * k + c], work[two, 3 + 3 * k + c] = axes_a[i, k, c], axes_b[j, k, c]
    axis, gap, nx, ny, nz = _least_overlap(work, margin)
    if axis < 0:
        return 0
    sign = -1.0 if swapped else 1.0
    normal[0], normal[1], normal[2] = sign * nx, sign * ny, sign * nz
    if axis >= 6:
        cross_edges(work, (axis - 6) // 3, (axis - 6) % 3, nx, ny, nz, point)
        separation[0] = gap
        if swapped:  # 3 times the edge of a, and the edge of b
            axis = 6 + (axis - 6) // 3 + (axis - 6) % 3 * 3
        feature[0] = (1 << 20) + axis - 6
        return 1
    r = axis // 3
    face = axis - 3 * r
    along = nx * work[r, 3 + 3 * face] + ny * work[r, 4 + 3 * face] + nz * work[r, 5 + 3 * face]
    side = 1.0 if (along > 0.0) == (r == 0) else -1.0
    return clip(work, r, 1 - r, face, side, margin, gap, (r == 1) != swapped, point, separation, feature)


@kernel
def _belongs_first(center, half, i, other_center, other_half, j):
    """Whether box i precedes box j, whichever is called a: the greater, or of two equal ones the lower in the direction
    in which they are farthest apart."""
    for k in range(3):
        if half[i, k] != other_half[j, k]:
            return half[i, k] > other_half[j, k]
    x, y, z = center[i, 0] - other_center[j, 0], center[i, 1] - other_center[j, 1], center[i, 2] - other_center[j, 2]
    if abs(x) >= abs(y) and abs(x) >= abs(z):
        return x < 0.0
    return y < 0.0 if abs(y) >= abs(z) else z < 0.0


@kernel
def _least_overlap(work, margin):
    """The axis along which the boxes overlap least: 0 to 2 a face of box 0, 3 to 5 one of box 1, 6 + 3 i + j edges.

    Returns it (-1: more than `margin` apart), the gap along it, m, and the unit normal from box 0 to box 1. Faces
    are preferred, those of box 0 first: their manifolds are stable. work[2]: the cosines of the axes.
    """
    dx, dy, dz = work[1, 0] - work[0, 0], work[1, 1] - work[0, 1], work[1, 2] - work[0, 2]
    h0, h1, h2, g0, g1, g2 = work[0, 12], work[0, 13], work[0, 14], work[1, 12], work[1, 13], work[1, 14]
    slack = FACE_PREFERENCE * min(min(h0, h1, h2), min(g0, g1, g2))
    best, axis, sign = -np.inf, -1, 1.0
    for i in range(3):
        x, y, z = work[0, 3 + 3 * i], work[0, 4 + 3 * i], work[0, 5 + 3 * i]
        gap = -work[0, 12 + i]
        for j in range(3):
            cosine = x * work[1, 3 + 3 * j] + y * work[1, 4 + 3 * j] + z * work[1, 5 + 3 * j]
            work[2, 3 * i + j] = cosine
            gap -= work[1, 12 + j] * abs(cosine)
        distance = x * dx + y * dy + z * dz
        work[2, 9 + i] = distance
        gap += abs(distance)
        if gap > margin:
            return -1, gap, 0.0, 0.0, 0.0
        if gap > best:
            best, axis, sign = gap, i, distance
    for j in range(3):
        distance = work[1, 3 + 3 * j] * dx + work[1, 4 + 3 * j] * dy + work[1, 5 + 3 * j] * dz
        gap = abs(distance) - work[1, 12 + j] - (h0 * abs(work[2, j]) + h1 * abs(work[2, 3 + j])
                                                 + h2 * abs(work[2, 6 + j]))
        if gap > margin:
            return -1, gap, 0.0, 0.0, 0.0
        if gap > best + slack:
            best, axis, sign = gap, 3 + j, distance
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            j1, j2 = (j + 1) % 3, (j + 2) % 3
            square = 1.0 - work[2, 3 * i + j] * work[2, 3 * i + j]
            if square < PARALLEL:
                continue
            distance = work[2, 9 + i2] * work[2, 3 * i1 + j] - work[2, 9 + i1] * work[2, 3 * i2 + j]
            gap = abs(distance) - (
                work[0, 12 + i1] * abs(work[2, 3 * i2 + j]) + work[0, 12 + i2] * abs(work[2, 3 * i1 + j])
                + work[1, 12 + j1] * abs(work[2, 3 * i + j2]) + work[1, 12 + j2] * abs(work[2, 3 * i + j1]))
            if gap > 0.0 and gap * gap > margin * margin * square:
                return -1, gap, 0.0, 0.0, 0.0
            least = best + slack
            if gap * abs(gap) > least * abs(least) * square:  # gap / sqrt(square) > least, without the root
                best, axis = gap / math.sqrt(square), 6 + 3 * i + j
    if axis < 6:
        r = axis // 3
        k = 3 + 3 * (axis - 3 * r)
        sign = 1.0 if sign >= 0.0 else -1.0
        return axis, best, sign * work[r, k], sign * work[r, k + 1], sign * work[r, k + 2]
    k, m = 3 + (axis - 6) // 3 * 3, 3 + (axis - 6) % 3 * 3
    x, y, z, u, v, w = work[0, k], work[0, k + 1], work[0, k + 2], work[1, m], work[1, m + 1], work[1, m + 2]
    x, y, z = y * w - z * v, z * u - x * w, x * v - y * u
    sign = (1.0 if x * dx + y * dy + z * dz >= 0.0 else -1.0) / math.sqrt(x * x + y * y + z * z)
    return axis, best, sign * x, sign * y, sign * z

