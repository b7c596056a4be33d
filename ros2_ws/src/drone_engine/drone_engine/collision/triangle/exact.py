"""Whether two triangles share a point, by exact signs alone: the fallback of `triangle.intersection`.

Let s(k) = orient3d(b0, b1, b2, ak) be the sides of a's corners with respect to b's plane, and t(k) those of b's corners
with respect to a's plane (signs; orient3d and orient2d as in `exact_arithmetic`).

- All s, or all t, are strictly of one sign: the triangles are disjoint.
- Some s and some t are not 0: both triangles have an area, and their planes intersect in a line L. Let a0 be the corner
  that is alone on its side, so that neither a0a1 nor a0a2 lies in b's plane. Then a covers the interval of L between
  the points where a0a1 and a0a2 cross it, and b likewise. The order along L of the crossings of a0a1 and b0b1 is the
  sign of orient3d(a0, a1, b0, b1); two such signs decide whether the intervals overlap (Devillers and Guigue 2002,
  Faster Triangle-Triangle Intersection Tests).
- Only t is 0 throughout: a is a segment on a line that crosses b's plane in one point. b contains that point if the
  signs of the line against b's three edges agree.
- All are 0: if the orient3d of some edge against some edge is not 0, the triangles are two skew segments. Otherwise all
  six corners are coplanar, and the triangles intersect if and only if their projections along each of the three axes
  do: at least one projection is one-to-one on the plane, and the others preserve common points.

Points are rows of p (6, 3), m: the corners of a (0 1 2), then those of b (3 4 5).
"""

import numpy as np

from drone_engine.collision.exact_arithmetic import orient2d, orient3d
from drone_engine.kernel import allocating, kernel

# Error bound of the determinants: ERROR_FACTOR * T^3 + UNDERFLOW_ERROR. Each determinant whose sign is taken, here and
# in `intersection.triangles_intersect`, is a sum of at most 24 products of three differences of coordinates, and each
# product passes through at most 12 roundings. With X, Y, Z the largest differences along the axes and T >= X + Y + Z, a
# product is at most XYZ <= T^3 / 27, so the error of the sum is below 24 * 12.1 * 2^-53 * T^3 / 27 < 11 * 2^-53 * T^3.
# As long as T^3 is finite, an overflow is possible only where T^3 is so large that the bound leaves every sign open.
# Underflow adds less than 40 * 2^-1074 * (1 + T), which UNDERFLOW_ERROR covers, or for T > 1 the rounding up of the
# factor 11 to 16.
ERROR_FACTOR, UNDERFLOW_ERROR = 2.0**-49, 1e-290

ALL_ON_ONE_SIDE, COPLANAR = -1, -2  # instead of the index of a lone corner


@allocating
def triangles_intersect_exact(a, b):
    """Whether two closed triangles share a point, exactly; each is a tuple of nine finite numbers, m."""
    p = np.empty((6, 3))
    for k in range(3):
        for axis in range(3):
            p[k, axis], p[3 + k, axis] = a[3 * k + axis], b[3 * k + axis]
    bound = _error_bound(p)
    side = np.empty(6, np.int64)
    for k in range(6):
        other = 3 if k < 3 else 0
        side[k] = _orient3d_sign(p, other, other + 1, other + 2, k, bound)
    k, above_b = _lone_corner(side[0], side[1], side[2])
    m, above_a = _lone_corner(side[3], side[4], side[5])
    if k == ALL_ON_ONE_SIDE or m == ALL_ON_ONE_SIDE:
        return False
    if k == COPLANAR and m == COPLANAR:
        for axis in range(3):
            if not _projections_intersect(p, axis):
                return False
        return not _has_skew_edges(p, bound)
    if k == COPLANAR or m == COPLANAR:
        start, end, other = (k, (k + 1) % 3, 3) if m == COPLANAR else (3 + m, 3 + (m + 1) % 3, 0)
        return _line_hits_triangle(p, start, end, other, bound)
    k1, k2 = _other_corners(k, above_a)
    m1, m2 = _other_corners(m, above_b)
    return _orient3d_sign(p, k, k1, 3 + m, 3 + m1, bound) <= 0 and _orient3d_sign(p, k, k2, 3 + m2, 3 + m, bound) <= 0


@kernel
def _error_bound(p):
    """Upper bound of the error of a rounded orient3d of four of the points p, m^3."""
    t = 0.0
    for axis in range(3):
        low, high = p[0, axis], p[0, axis]
        for k in range(1, 6):
            low, high = min(low, p[k, axis]), max(high, p[k, axis])
        t += high - low
    return ERROR_FACTOR * (t * t * t) + UNDERFLOW_ERROR


@allocating
def _orient3d_sign(p, i, j, k, h, bound):
    """The exact sign (-1, 0, 1) of orient3d of points i, j, k, h of p; bound: the error of the rounded determinant."""
    ax, ay, az, bx, by, bz = p[i, 0], p[i, 1], p[i, 2], p[j, 0], p[j, 1], p[j, 2]
    cx, cy, cz, dx, dy, dz = p[k, 0], p[k, 1], p[k, 2], p[h, 0], p[h, 1], p[h, 2]
    det = _determinant(bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az, dx - ax, dy - ay, dz - az)
    if abs(det) > bound:
        return 1 if det > 0.0 else -1
    # The most common degenerate cases need no long arithmetic: faces along the axes, common corners.
    if (ax == bx == cx == dx or ay == by == cy == dy or az == bz == cz == dz or _coincide(p, i, j) or _coincide(p, i, k)
            or _coincide(p, i, h) or _coincide(p, j, k) or _coincide(p, j, h) or _coincide(p, k, h)):
        return 0
    return orient3d(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz)


@kernel
def _coincide(p, i, j):
    """Whether points i and j of p are equal."""
    return p[i, 0] == p[j, 0] and p[i, 1] == p[j, 1] and p[i, 2] == p[j, 2]


@kernel
def _lone_corner(s0, s1, s2):
    """The index of the corner that no other shares its side of a plane with, and whether it is above the plane.

    s0, s1, s2: the corners' sides, -1, 0 or 1. With two signs 0 the third corner is alone; with one 0 and two equal
    signs, the corner of the 0. Instead of an index: ALL_ON_ONE_SIDE (strictly), COPLANAR (all 0).
    """
    if s0 == s1 == s2:
        return COPLANAR if s0 == 0 else ALL_ON_ONE_SIDE, False
    for k in range(3):
        s, u, v = (s0, s1, s2) if k == 0 else ((s1, s2, s0) if k == 1 else (s2, s0, s1))
        if s >= 0 >= max(u, v) and s > max(u, v):
            return k, True
        if s <= 0 <= min(u, v) and s < min(u, v):
            return k, False
    return ALL_ON_ONE_SIDE, False


@kernel
def _other_corners(k, forward):
    """The indices of the other two corners after corner k, in the triangle's order or in reverse."""
    after, before = (k + 1 if k < 2 else 0), (k - 1 if k > 0 else 2)
    return (after, before) if forward else (before, after)


@allocating
def _line_hits_triangle(p, k, h, first, bound):
    """Whether the line through points k and h, which crosses the plane of triangle first, first + 1, first + 2, hits
    that triangle."""
    low, high = 1, -1
    for m in range(3):
        s = _orient3d_sign(p, k, h, first + m, first + (m + 1) % 3, bound)
        low, high = min(low, s), max(high, s)
    return low >= 0 or high <= 0


@allocating
def _has_skew_edges(p, bound):
    """Whether some edge of a and some edge of b are not in one plane."""
    for k in range(3):
        for m in range(3):
            if _orient3d_sign(p, k, (k + 1) % 3, 3 + m, 3 + (m + 1) % 3, bound) != 0:
                return True
    return False


@allocating
def _projections_intersect(p, axis):
    """Whether the triangles, projected along an axis, share a point: two edges cross, or a corner is inside."""
    x, y = (axis + 1) % 3, (axis + 2) % 3
    side = np.empty((6, 3), np.int64)  # of each edge: the orient2d signs of the other triangle's corners
    for k in range(6):
        start, other = (0, 3) if k < 3 else (3, 0)
        end = start + (k - start + 1) % 3
        for m in range(3):
            side[k, m] = _orient2d_sign(p[k, x], p[k, y], p[end, x], p[end, y], p[other + m, x], p[other + m, y])
    for k in range(3):
        k1 = (k + 1) % 3
        for m in range(3):
            m1 = (m + 1) % 3
            apart = False
            for c in (x, y):
                apart |= max(p[k, c], p[k1, c]) < min(p[3 + m, c], p[3 + m1, c])
                apart |= max(p[3 + m, c], p[3 + m1, c]) < min(p[k, c], p[k1, c])
            if not apart and side[k, m] * side[k, m1] <= 0 and side[3 + m, k] * side[3 + m, k1] <= 0:
                return True
    return side[0, 0] == side[1, 0] == side[2, 0] != 0 or side[3, 0] == side[4, 0] == side[5, 0] != 0


@allocating
def _orient2d_sign(ax, ay, bx, by, cx, cy):
    """The exact sign (-1, 0, 1) of orient2d of points a, b, c."""
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    if (ux == 0.0 or vy == 0.0) and (uy == 0.0 or vx == 0.0):
        return 0
    # Each product passes through at most 4 roundings; UNDERFLOW_ERROR is far above what underflow can add.
    left, right = ux * vy, uy * vx
    det = left - right
    if abs(det) > 2.0**-50 * (abs(left) + abs(right)) + UNDERFLOW_ERROR:
        return 1 if det > 0.0 else -1
    return orient2d(ax, ay, bx, by, cx, cy)


@kernel
def _determinant(ux, uy, uz, vx, vy, vz, wx, wy, wz):
    """det[u, v, w], rounded."""
    return (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz
