"""Separating axes of many pairs of boxes at once, in floating point.

Pairs are columns of a table, so that the compiler handles eight of them in each instruction (structure of arrays). Of
the 15 axes (Gottschalk, Lin and Manocha 1996, OBBTree) six are face normals and nine are cross products of two edges.
"""

import math

import numpy as np

from drone_engine.kernel import inlined, kernel

BLOCK = 32  # pairs, a column each of a table that fits into the fastest cache
# A table is a flat array of 36 rows of BLOCK numbers. Rows: offset of the centers from 0, half extents of a and of b
# from 3 and 6, axes of a and of b, component by component, from 9 and 18; these; and the center of the first box.
TOLERANCES, AXIS, GAP, WIDEST, MARGIN, SWAPPED, CENTER_A = (row * BLOCK for row in range(27, 34))
TABLE = 36 * BLOCK
# Six squared singular values of two boxes' axes whose sum is at most 6 + SHAPE and whose product is at least
# (1 - SHAPE)^2 are all near 1 (arithmetic against geometric mean): each within 2.5 sqrt(SHAPE). So the axes are within
# 1.3 sqrt(SHAPE) of orthonormal ones, and no gap along the 15 axes is wrong by more than 5.3 times this, and rounding,
# relative to the size of the pair (offset and half extents).
SHAPE = 1e-13
TOLERANCE = 2.0**-18
TINY = 1e-290  # below this, rounding errors are not relative any more, and the answer is left undecided
FACE_PREFERENCE = 0.02  # of the smallest half extent: how much better an edge axis must be than a face axis
PARALLEL = 1e-6  # squared sine below which two edges have no axis of their own
STEP_HEIGHT = 5e-4  # m: what overlaps by less than this is no obstacle but lies flush
SPEED_TIE = 0.05  # m/s, by which one face has to approach faster than another to be the obstacle
TIE = 1e-6  # of the square of a gap: edge axes within this are equally good
FAR = 1e300  # m2
APART, UNDECIDED, TOUCHING = range(3)  # verdicts


@kernel
def load_pairs(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, table):
    """Writes pairs `first` to `first + count` into the columns of the table, and for each the tolerance of its gaps:
    infinite unless the axes may be orthonormal and the half extents are not negative.

    The arrays of n pairs are flat: (3 n,) and, for axes, (9 n,). Indices are unsigned, which saves the test for
    negative ones.
    """
    for k in range(count):
        size, shape, negative = 0.0, 0.0, False
        for i in range(3):
            at = np.uint64(3 * (first + k) + i)
            d, h, g = center_b[at] - center_a[at], half_a[at], half_b[at]
            table[i * BLOCK + k] = d
            table[(3 + i) * BLOCK + k] = h
            table[(6 + i) * BLOCK + k] = g
            size += abs(d) + (h + g)
            negative |= (h < 0.0) | (g < 0.0)
        for i in range(9):
            at = np.uint64(9 * (first + k) + i)
            a, b = axes_a[at], axes_b[at]
            table[(9 + i) * BLOCK + k] = a
            table[(18 + i) * BLOCK + k] = b
            shape += a * a + b * b
        decidable = (shape <= 6.0 + 0.5 * SHAPE) & (not negative)
        table[TOLERANCES + k] = size * TOLERANCE + TINY if decidable else np.inf


@inlined
def gaps(d0, d1, d2, h0, h1, h2, g0, g1, g2, a00, a01, a02, a10, a11, a12, a20, a21, a22,
          b00, b01, b02, b10, b11, b12, b20, b21, b22):
    """The gap between two boxes along each of the 15 axes, times the length of the axis, and the nine cosines between
    the axes of a and those of b: 24 numbers. Gap axes: faces of a, faces of b, then edges 3 i + j.

    d: offset of the centers, m; h, g: half extents of a and b, m; a, b: orthonormal axes, a_ic being component c of
    axis i. It takes scalars alone, as a leaf of vectorized loops.
    """
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
    return (
        abs(t0) - (h0 + g0 * q00 + g1 * q01 + g2 * q02),
        abs(t1) - (h1 + g0 * q10 + g1 * q11 + g2 * q12),
        abs(t2) - (h2 + g0 * q20 + g1 * q21 + g2 * q22),
        abs(u0) - (g0 + h0 * q00 + h1 * q10 + h2 * q20),
        abs(u1) - (g1 + h0 * q01 + h1 * q11 + h2 * q21),
        abs(u2) - (g2 + h0 * q02 + h1 * q12 + h2 * q22),
        abs(t2 * r10 - t1 * r20) - (h1 * q20 + h2 * q10 + g1 * q02 + g2 * q01),
        abs(t2 * r11 - t1 * r21) - (h1 * q21 + h2 * q11 + g0 * q02 + g2 * q00),
        abs(t2 * r12 - t1 * r22) - (h1 * q22 + h2 * q12 + g0 * q01 + g1 * q00),
        abs(t0 * r20 - t2 * r00) - (h0 * q20 + h2 * q00 + g1 * q12 + g2 * q11),
        abs(t0 * r21 - t2 * r01) - (h0 * q21 + h2 * q01 + g0 * q12 + g2 * q10),
        abs(t0 * r22 - t2 * r02) - (h0 * q22 + h2 * q02 + g0 * q11 + g1 * q10),
        abs(t1 * r00 - t0 * r10) - (h0 * q10 + h1 * q00 + g1 * q22 + g2 * q21),
        abs(t1 * r01 - t0 * r11) - (h0 * q11 + h1 * q01 + g0 * q22 + g2 * q20),
        abs(t1 * r02 - t0 * r12) - (h0 * q12 + h1 * q02 + g0 * q21 + g1 * q20),
        r00, r01, r02, r10, r11, r12, r20, r21, r22,
    )


@inlined
def gaps_of_column(table, k):
    """`gaps` of the pair in column k of the table."""
    return gaps(
        table[k], table[BLOCK + k], table[2 * BLOCK + k],
        table[3 * BLOCK + k], table[4 * BLOCK + k], table[5 * BLOCK + k],
        table[6 * BLOCK + k], table[7 * BLOCK + k], table[8 * BLOCK + k],
        table[9 * BLOCK + k], table[10 * BLOCK + k], table[11 * BLOCK + k],
        table[12 * BLOCK + k], table[13 * BLOCK + k], table[14 * BLOCK + k],
        table[15 * BLOCK + k], table[16 * BLOCK + k], table[17 * BLOCK + k],
        table[18 * BLOCK + k], table[19 * BLOCK + k], table[20 * BLOCK + k],
        table[21 * BLOCK + k], table[22 * BLOCK + k], table[23 * BLOCK + k],
        table[24 * BLOCK + k], table[25 * BLOCK + k], table[26 * BLOCK + k],
    )


@kernel
def classify(table, verdict):
    """Writes APART, TOUCHING or UNDECIDED for each column to verdict (BLOCK,), uint8.

    It has no branches, so that the compiler handles eight pairs at once.
    """
    for k in range(BLOCK):
        gap = gaps_of_column(table, k)
        most = max(gap[0], gap[1], gap[2], gap[3], gap[4], gap[5], gap[6], gap[7], gap[8], gap[9], gap[10], gap[11],
                   gap[12], gap[13], gap[14])
        r00, r01, r02, r10, r11, r12, r20, r21, r22 = gap[15:]
        volume = abs(r00 * (r11 * r22 - r12 * r21) - r01 * (r10 * r22 - r12 * r20) + r02 * (r10 * r21 - r11 * r20))
        tolerance = table[TOLERANCES + k] if volume >= 1.0 - 0.5 * SHAPE else np.inf
        verdict[k] = (not most > tolerance) + (most < -tolerance)


@kernel
def find_contact_axes(table, count):
    """Writes for each of the first `count` columns the axis of least overlap (AXIS), the gap along it (GAP) and the
    widest gap of all 15 axes (WIDEST), m.

    Axes: 0 to 2 a face of the first box, 3 to 5 of the second, 6 + 3 i + j edges. Faces are preferred, those of the
    first box before those of the second, and of edges that tie the first: so the choice is stable from step to step.
    """
    for k in range(count):
        gap = gaps_of_column(table, k)
        h, g = min(table[3 * BLOCK + k], table[4 * BLOCK + k], table[5 * BLOCK + k]), min(
            table[6 * BLOCK + k], table[7 * BLOCK + k], table[8 * BLOCK + k])
        slack = FACE_PREFERENCE * min(h, g)
        best, other = max(gap[0], gap[1], gap[2]), max(gap[3], gap[4], gap[5])
        axis = 0.0 if gap[0] == best else 1.0 if gap[1] == best else 2.0
        if other > best + slack:
            best, axis = other, 3.0 if gap[3] == other else 4.0 if gap[4] == other else 5.0
        e0, e1 = _signed_square(gap[6], gap[15]), _signed_square(gap[7], gap[16])
        e2, e3 = _signed_square(gap[8], gap[17]), _signed_square(gap[9], gap[18])
        e4, e5 = _signed_square(gap[10], gap[19]), _signed_square(gap[11], gap[20])
        e6, e7 = _signed_square(gap[12], gap[21]), _signed_square(gap[13], gap[22])
        e8 = _signed_square(gap[14], gap[23])
        most = max(e0, e1, e2, e3, e4, e5, e6, e7, e8)
        enough = most - TIE * abs(most)
        edge, square = (
            (6.0, e0) if e0 >= enough else (7.0, e1) if e1 >= enough else (8.0, e2) if e2 >= enough else
            (9.0, e3) if e3 >= enough else (10.0, e4) if e4 >= enough else (11.0, e5) if e5 >= enough else
            (12.0, e6) if e6 >= enough else (13.0, e7) if e7 >= enough else (14.0, e8))
        root = math.sqrt(abs(square))
        length = root if square > 0.0 else -root
        widest = max(best, other, math.copysign(math.sqrt(abs(most)), most))
        if length > best + slack:
            best, axis = length, edge
        table[AXIS + k], table[GAP + k], table[WIDEST + k] = axis, best, widest


@inlined
def _signed_square(gap, cosine):
    """The square of the gap along the cross product of two edges, with the sign of the gap; -FAR for parallel edges.

    gap: m times the length of the cross product; cosine: of the angle between the edges.
    """
    square = 1.0 - cosine * cosine
    return gap * abs(gap) / square if square >= PARALLEL else -FAR


@inlined
def _speed_along(table, k, axis, vx, vy, vz):
    """The speed along a face axis, m/s, at which the boxes of column k move; the greatest possible for an edge axis."""
    if axis >= 6:
        return math.sqrt(vx * vx + vy * vy + vz * vz)
    row = 9 + 3 * axis
    return abs(vx * table[row * BLOCK + k] + vy * table[(row + 1) * BLOCK + k] + vz * table[(row + 2) * BLOCK + k])


@kernel
def flush_axis(table, k, vx, vy, vz):
    """The face axis 0 to 5 along which the boxes of column k lie flush, -1 if there is none that matters.

    What overlaps by less than STEP_HEIGHT along a face is no obstacle for what moves along that face: such a face is
    the contact axis although another axis has a wider gap, as at the joint of two tiles. If the boxes touch along the
    other axis as well, the one along which they approach faster is the side of the step. v: velocity of the second box
    relative to the first, m/s.
    """
    gap = gaps_of_column(table, k)
    best, slowest = -1, _speed_along(table, k, int(table[AXIS + k]), vx, vy, vz) - SPEED_TIE
    for i in range(6):
        if abs(gap[i]) > STEP_HEIGHT or i == int(table[AXIS + k]):
            continue
        speed = _speed_along(table, k, i, vx, vy, vz)
        if speed < slowest:
            best, slowest = i, speed
    return best
