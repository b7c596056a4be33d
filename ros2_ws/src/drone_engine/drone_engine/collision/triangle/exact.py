"""Whether two triangles share a point, by exact signs alone: what `triangle.touch` falls back on.

a's corners lie on sides s(k) = orient3d(b0, b1, b2, ak) of b's plane, b's on sides t(k) of a's. All of one strictly
on one side: no. Else, and if both s and t have a sign that is not 0, both have an area and their planes cross in a
line L. Name a0 the corner that is alone on its side, so that neither a0a1 nor a0a2 lies in b's plane: a covers on L
what lies between the crossings of a0a1 and a0a2, b likewise, and the order along L of the crossings of a0a1 and b0b1
is the sign of orient3d(a0, a1, b0, b1): two of these decide whether the intervals overlap (Devillers and Guigue 2002).
If only t is all 0, a is a segment on a line that crosses b's plane in a point, and b holds it if the signs of the line
against b's three edges agree. If all are 0, one sign of edge against edge that is not 0 tells two skew segments; else
all six corners are coplanar, and the two meet if and only if they do in the three projections along the axes: at
least one of these is one-to-one on the plane, and the others never miss a common point.
"""

import numpy as np

from drone_engine.collision.exact_arithmetic import orient2d, orient3d
from drone_engine.kernel import kernel

# Every number that `touch` takes a sign of is a sum of at most 24 products of three differences of coordinates, none of
# which passes through more than 12 roundings. With X, Y, Z the largest differences along the axes and T >= X + Y + Z, a
# product is at most XYZ <= T^3 / 27, and the sum is off by less than 24 * 12.1 * 2^-53 * T^3 / 27 < 11 * 2^-53 * T^3.
# If T^3 is finite, nothing overflows but where T^3 is large enough to make all open, and underflow adds less than
# 40 * 2^-1074 * (1 + T), which TINY or, for T > 1, what was rounded up in RELATIVE covers.
RELATIVE, TINY = 2.0**-49, 1e-290

NOBODY, NOWHERE = -1, -2  # instead of a corner that is alone


@kernel
def meet_exact(a, b):
    """What `touch` answers, by exact signs. The corners are points 0 1 2 and 3 4 5 of p."""
    p = np.empty((6, 3))
    for k in range(3):
        for axis in range(3):
            p[k, axis], p[3 + k, axis] = a[3 * k + axis], b[3 * k + axis]
    bound = _bound(p)
    side = np.empty(6, np.int64)
    for k in range(6):
        other = 3 if k < 3 else 0
        side[k] = _side(p, other, other + 1, other + 2, k, bound)
    k, above_b = _alone(side[0], side[1], side[2])
    m, above_a = _alone(side[3], side[4], side[5])
    if k == NOBODY or m == NOBODY:
        return False
    if k == NOWHERE and m == NOWHERE:
        for axis in range(3):
            if not _meet_flat(p, axis):
                return False
        return not _skew(p, bound)
    if k == NOWHERE or m == NOWHERE:
        start, end, other = (k, (k + 1) % 3, 3) if m == NOWHERE else (3 + m, 3 + (m + 1) % 3, 0)
        return _pierces(p, start, end, other, bound)
    k1, k2 = _others(k, above_a)
    m1, m2 = _others(m, above_b)
    return _side(p, k, k1, 3 + m, 3 + m1, bound) <= 0 and _side(p, k, k2, 3 + m2, 3 + m, bound) <= 0


@kernel
def _bound(p):
    """How far off a rounded determinant of the points may be."""
    t = 0.0
    for axis in range(3):
        low, high = p[0, axis], p[0, axis]
        for k in range(1, 6):
            low, high = min(low, p[k, axis]), max(high, p[k, axis])
        t += high - low
    return RELATIVE * (t * t * t) + TINY


@kernel
def _side(p, i, j, k, h, bound):
    """The exact sign of orient3d of four of the points p."""
    ax, ay, az, bx, by, bz = p[i, 0], p[i, 1], p[i, 2], p[j, 0], p[j, 1], p[j, 2]
    cx, cy, cz, dx, dy, dz = p[k, 0], p[k, 1], p[k, 2], p[h, 0], p[h, 1], p[h, 2]
    det = _det(bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az, dx - ax, dy - ay, dz - az)
    if abs(det) > bound:
        return 1 if det > 0.0 else -1
    # The plainest of touches need no long arithmetic: walls along the axes, common corners.
    if (ax == bx == cx == dx or ay == by == cy == dy or az == bz == cz == dz or _same(p, i, j) or _same(p, i, k)
            or _same(p, i, h) or _same(p, j, k) or _same(p, j, h) or _same(p, k, h)):
        return 0
    return orient3d(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz)


@kernel
def _same(p, i, j):
    return p[i, 0] == p[j, 0] and p[i, 1] == p[j, 1] and p[i, 2] == p[j, 2]


@kernel
def _alone(s0, s1, s2):
    """The corner that no other shares its side with, and whether it is above; NOBODY is if all are strictly on one
    side, NOWHERE if all are 0. Of two signs 0 the third's corner is alone, of one 0 between two equals the 0's."""
    if s0 == s1 == s2:
        return NOWHERE if s0 == 0 else NOBODY, False
    for k in range(3):
        s, u, v = (s0, s1, s2) if k == 0 else ((s1, s2, s0) if k == 1 else (s2, s0, s1))
        if s >= 0 >= max(u, v) and s > max(u, v):
            return k, True
        if s <= 0 <= min(u, v) and s < min(u, v):
            return k, False
    return NOBODY, False


@kernel
def _others(k, forward):
    """The two corners after corner k, in the triangle's order or against it."""
    after, before = (k + 1 if k < 2 else 0), (k - 1 if k > 0 else 2)
    return (after, before) if forward else (before, after)


@kernel
def _pierces(p, k, h, first, bound):
    """Whether the line of points k and h, which crosses the plane of the triangle at `first`, meets the triangle."""
    low, high = 1, -1
    for m in range(3):
        s = _side(p, k, h, first + m, first + (m + 1) % 3, bound)
        low, high = min(low, s), max(high, s)
    return low >= 0 or high <= 0


@kernel
def _skew(p, bound):
    """Whether two edges are not in one plane."""
    for k in range(3):
        for m in range(3):
            if _side(p, k, (k + 1) % 3, 3 + m, 3 + (m + 1) % 3, bound) != 0:
                return True
    return False


@kernel
def _meet_flat(p, axis):
    """Whether the triangles have a point in common once projected along an axis: edges cross, or a corner is inside."""
    x, y = (axis + 1) % 3, (axis + 2) % 3
    turn = np.empty((6, 3), np.int64)  # on which side of each edge the other triangle's corners are
    for k in range(6):
        start, other = (0, 3) if k < 3 else (3, 0)
        end = start + (k - start + 1) % 3
        for m in range(3):
            turn[k, m] = _turn(p[k, x], p[k, y], p[end, x], p[end, y], p[other + m, x], p[other + m, y])
    for k in range(3):
        k1 = (k + 1) % 3
        for m in range(3):
            m1 = (m + 1) % 3
            apart = False
            for c in (x, y):
                apart |= max(p[k, c], p[k1, c]) < min(p[3 + m, c], p[3 + m1, c])
                apart |= max(p[3 + m, c], p[3 + m1, c]) < min(p[k, c], p[k1, c])
            if not apart and turn[k, m] * turn[k, m1] <= 0 and turn[3 + m, k] * turn[3 + m, k1] <= 0:
                return True
    return turn[0, 0] == turn[1, 0] == turn[2, 0] != 0 or turn[3, 0] == turn[4, 0] == turn[5, 0] != 0


@kernel
def _turn(ax, ay, bx, by, cx, cy):
    """The exact sign of orient2d."""
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    if (ux == 0.0 or vy == 0.0) and (uy == 0.0 or vx == 0.0):
        return 0
    # Each product passes through at most 4 roundings; TINY is far above what underflow can add.
    left, right = ux * vy, uy * vx
    det = left - right
    if abs(det) > 2.0**-50 * (abs(left) + abs(right)) + TINY:
        return 1 if det > 0.0 else -1
    return orient2d(ax, ay, bx, by, cx, cy)


@kernel
def _det(ux, uy, uz, vx, vy, vz, wx, wy, wz):
    return (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz
