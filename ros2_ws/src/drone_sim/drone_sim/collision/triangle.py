"""Triangle against triangle, exactly: the answer of the closed triangles of the numbers as stored.

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

from drone_sim.arrays import Booleans, Floats
from drone_sim.collision.exact import orient2d, orient3d
from drone_sim.kernel import kernel

# A determinant of three differences of coordinates, none beyond X, Y, Z along the axes, is a sum of six products of
# at most XYZ each, and no product passes through more than 8 roundings: off by less than 48.1 * 2**-53 * XYZ.
RELATIVE = 2.0**-47
# Underflow adds less than 9 * 2**-1074 * (1 + X + Y + Z) while X + Y + Z < LARGEST, where nothing overflows.
TINY, LARGEST = 1e-290, 1e30


@kernel
def meet(a, i, b, j):
    """Whether triangles a[i] and b[j] share a point; a, b: (n, 3, 3), C-contiguous, finite, a corner a row."""
    ax0, ay0, az0 = a[i, 0, 0], a[i, 0, 1], a[i, 0, 2]
    ax1, ay1, az1 = a[i, 1, 0], a[i, 1, 1], a[i, 1, 2]
    ax2, ay2, az2 = a[i, 2, 0], a[i, 2, 1], a[i, 2, 2]
    bx0, by0, bz0 = b[j, 0, 0], b[j, 0, 1], b[j, 0, 2]
    bx1, by1, bz1 = b[j, 1, 0], b[j, 1, 1], b[j, 1, 2]
    bx2, by2, bz2 = b[j, 2, 0], b[j, 2, 1], b[j, 2, 2]
    alx, ahx = _least(ax0, ax1, ax2), _most(ax0, ax1, ax2)
    blx, bhx = _least(bx0, bx1, bx2), _most(bx0, bx1, bx2)
    aly, ahy = _least(ay0, ay1, ay2), _most(ay0, ay1, ay2)
    bly, bhy = _least(by0, by1, by2), _most(by0, by1, by2)
    alz, ahz = _least(az0, az1, az2), _most(az0, az1, az2)
    blz, bhz = _least(bz0, bz1, bz2), _most(bz0, bz1, bz2)
    if (ahx < blx) | (bhx < alx) | (ahy < bly) | (bhy < aly) | (ahz < blz) | (bhz < alz):
        return False
    x = (ahx if ahx > bhx else bhx) - (alx if alx < blx else blx)
    y = (ahy if ahy > bhy else bhy) - (aly if aly < bly else bly)
    z = (ahz if ahz > bhz else bhz) - (alz if alz < blz else blz)
    bound = RELATIVE * x * y * z + TINY
    if not x + y + z < LARGEST:
        bound = np.inf

    # a's corners against b's plane.
    ux, uy, uz = bx1 - bx0, by1 - by0, bz1 - bz0
    vx, vy, vz = bx2 - bx0, by2 - by0, bz2 - bz0
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    s0 = nx * (ax0 - bx0) + ny * (ay0 - by0) + nz * (az0 - bz0)
    s1 = nx * (ax1 - bx0) + ny * (ay1 - by0) + nz * (az1 - bz0)
    s2 = nx * (ax2 - bx0) + ny * (ay2 - by0) + nz * (az2 - bz0)
    low, high = _least(s0, s1, s2), _most(s0, s1, s2)
    if (low > bound) | (high < -bound):
        return False
    # b's corners against a's plane.
    ux, uy, uz = ax1 - ax0, ay1 - ay0, az1 - az0
    vx, vy, vz = ax2 - ax0, ay2 - ay0, az2 - az0
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    t0 = nx * (bx0 - ax0) + ny * (by0 - ay0) + nz * (bz0 - az0)
    t1 = nx * (bx1 - ax0) + ny * (by1 - ay0) + nz * (bz1 - az0)
    t2 = nx * (bx2 - ax0) + ny * (by2 - ay0) + nz * (bz2 - az0)
    low, high = _least(t0, t1, t2), _most(t0, t1, t2)
    if (low > bound) | (high < -bound):
        return False
    closest = min(_least(abs(s0), abs(s1), abs(s2)), _least(abs(t0), abs(t1), abs(t2)))
    if closest > bound:
        # The corner that is alone on its side; its side says which way round the other triangle is taken.
        k = 0 if (s1 > 0.0) == (s2 > 0.0) else (1 if (s0 > 0.0) == (s2 > 0.0) else 2)
        m = 0 if (t1 > 0.0) == (t2 > 0.0) else (1 if (t0 > 0.0) == (t2 > 0.0) else 2)
        above_b = (s0 if k == 0 else (s1 if k == 1 else s2)) > 0.0
        above_a = (t0 if m == 0 else (t1 if m == 1 else t2)) > 0.0
        k1, k2 = _others(k, above_a)
        m1, m2 = _others(m, above_b)
        p = _edges(a, i, k, k1, b, j, m, m1)
        q = _edges(a, i, k, k2, b, j, m2, m)
        if (p > bound) | (q > bound):
            return False
        if (p < -bound) & (q < -bound):
            return True
    return _decide(a, i, b, j, bound)


@kernel
def _least(x, y, z):
    least = x if x < y else y
    return least if least < z else z


@kernel
def _most(x, y, z):
    most = x if x > y else y
    return most if most > z else z


@kernel
def _others(k, forward):
    """The two corners after corner k, in the triangle's order or against it."""
    after, before = (k + 1 if k < 2 else 0), (k - 1 if k > 0 else 2)
    return (after, before) if forward else (before, after)


@kernel
def _edges(a, i, k, h, b, j, m, n):
    """orient3d of edge k h of triangle a[i] and edge m n of b[j], rounded."""
    ox, oy, oz = a[i, k, 0], a[i, k, 1], a[i, k, 2]
    qx, qy, qz = b[j, m, 0], b[j, m, 1], b[j, m, 2]
    ux, uy, uz = a[i, h, 0] - ox, a[i, h, 1] - oy, a[i, h, 2] - oz
    vx, vy, vz = qx - ox, qy - oy, qz - oz
    wx, wy, wz = b[j, n, 0] - qx, b[j, n, 1] - qy, b[j, n, 2] - qz
    return (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz


@kernel
def _decide(a, i, b, j, bound):
    """What `meet` answers, from exact signs where rounding could change one."""
    p = (_corner(a, i, 0), _corner(a, i, 1), _corner(a, i, 2), _corner(b, j, 0), _corner(b, j, 1), _corner(b, j, 2))
    s0, s1, s2 = _side(p, 3, 4, 5, 0, bound), _side(p, 3, 4, 5, 1, bound), _side(p, 3, 4, 5, 2, bound)
    if s0 == s1 == s2 != 0:
        return False
    t0, t1, t2 = _side(p, 0, 1, 2, 3, bound), _side(p, 0, 1, 2, 4, bound), _side(p, 0, 1, 2, 5, bound)
    if t0 == t1 == t2 != 0:
        return False
    a_crosses, b_crosses = s0 != 0 or s1 != 0 or s2 != 0, t0 != 0 or t1 != 0 or t2 != 0
    if a_crosses and b_crosses:
        k, above_b = _alone(s0, s1, s2)
        m, above_a = _alone(t0, t1, t2)
        k1, k2 = _others(k, above_a)
        m1, m2 = _others(m, above_b)
        return _side(p, k, k1, 3 + m, 3 + m1, bound) <= 0 and _side(p, k, k2, 3 + m2, 3 + m, bound) <= 0
    if a_crosses:
        k, _ = _alone(s0, s1, s2)
        return _pierces(p, k, (k + 1) % 3, 3, 4, 5, bound)
    if b_crosses:
        m, _ = _alone(t0, t1, t2)
        return _pierces(p, 3 + m, 3 + (m + 1) % 3, 0, 1, 2, bound)
    for axis in range(3):
        if not _meet_flat(p, axis):
            return False
    for k in range(3):
        for m in range(3):
            if _side(p, k, (k + 1) % 3, 3 + m, 3 + (m + 1) % 3, bound) != 0:
                return False
    return True


@kernel
def _corner(a, i, k):
    return a[i, k, 0], a[i, k, 1], a[i, k, 2]


@kernel
def _side(p, i, j, k, h, bound):
    """The exact sign of orient3d of four of the points p."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz), (dx, dy, dz) = p[i], p[j], p[k], p[h]
    if ax == bx == cx == dx or ay == by == cy == dy or az == bz == cz == dz:
        return 0
    if p[i] == p[j] or p[i] == p[k] or p[i] == p[h] or p[j] == p[k] or p[j] == p[h] or p[k] == p[h]:
        return 0
    ux, uy, uz, vx, vy, vz, wx, wy, wz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az, dx - ax, dy - ay, dz - az
    det = (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz
    if det > bound:
        return 1
    if det < -bound:
        return -1
    return orient3d(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz)


@kernel
def _alone(s0, s1, s2):
    """The corner that no other shares its side with, given signs neither all 0 nor all equal, and whether it is above.

    Of two signs 0 the third's corner is alone, of one sign 0 between equals the 0's, so no edge at it is all 0."""
    for k in range(3):
        s, u, v = (s0, s1, s2) if k == 0 else ((s1, s2, s0) if k == 1 else (s2, s0, s1))
        if s > max(u, v) and s >= 0 >= max(u, v):
            return k, True
        if s < min(u, v) and s <= 0 <= min(u, v):
            return k, False
    return -1, False


@kernel
def _pierces(p, k, h, i, j, m, bound):
    """Whether the line through points k and h, which crosses the plane of triangle i j m, passes the triangle."""
    u, v, w = _side(p, k, h, i, j, bound), _side(p, k, h, j, m, bound), _side(p, k, h, m, i, bound)
    return (u >= 0 and v >= 0 and w >= 0) or (u <= 0 and v <= 0 and w <= 0)


@kernel
def _meet_flat(p, axis):
    """Whether triangles 0 1 2 and 3 4 5 have a point in common once projected along an axis."""
    for k in range(3):
        for m in range(3):
            if _cross_flat(p, axis, k, (k + 1) % 3, 3 + m, 3 + (m + 1) % 3):
                return True
    return _inside_flat(p, axis, 0, 3, 4, 5) or _inside_flat(p, axis, 3, 0, 1, 2)


@kernel
def _cross_flat(p, axis, i, j, k, h):
    """Whether segments i j and k h meet: their boxes do, and neither lies strictly on one side of the other."""
    for c in ((axis + 1) % 3, (axis + 2) % 3):
        if max(p[i][c], p[j][c]) < min(p[k][c], p[h][c]) or max(p[k][c], p[h][c]) < min(p[i][c], p[j][c]):
            return False
    return (_turn(p, axis, i, j, k) * _turn(p, axis, i, j, h) <= 0
            and _turn(p, axis, k, h, i) * _turn(p, axis, k, h, j) <= 0)


@kernel
def _inside_flat(p, axis, i, j, k, h):
    """Whether point i lies strictly inside triangle j k h."""
    turn = _turn(p, axis, j, k, i)
    return turn != 0 and turn == _turn(p, axis, k, h, i) and turn == _turn(p, axis, h, j, i)


@kernel
def _turn(p, axis, i, j, k):
    """The exact sign of orient2d of three of the points p, projected along an axis."""
    x, y = (axis + 1) % 3, (axis + 2) % 3
    ax, ay, bx, by, cx, cy = p[i][x], p[i][y], p[j][x], p[j][y], p[k][x], p[k][y]
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    if (ux == 0.0 or vy == 0.0) and (uy == 0.0 or vx == 0.0):
        return 0
    # Each product passes through at most 4 roundings; TINY is far above what underflow can add.
    left, right = ux * vy, uy * vx
    det, bound = left - right, 2.0**-50 * (abs(left) + abs(right)) + TINY
    if det > bound:
        return 1
    if det < -bound:
        return -1
    return orient2d(ax, ay, bx, by, cx, cy)


@kernel
def _meet_all(a, b, out):
    for i in range(a.shape[0]):
        out[i] = meet(a, i, b, i)


def intersects(a: Floats, b: Floats) -> Booleans:
    """Whether triangle a[i] and triangle b[i] share a point, exactly: (n,) for a, b of shape (n, 3, 3), m.

    Touching counts, a triangle may be a segment or a point. ValueError for other shapes and non-finite numbers."""
    a, b = _checked("a", a), _checked("b", b)
    if len(a) != len(b):
        raise ValueError(f"triangle: as many a as b expected, {len(a)} and {len(b)} came")
    out = np.empty(len(a), np.bool_)
    _meet_all(a, b, out)
    return out


def _checked(name: str, corners: Floats) -> Floats:
    """The corners as a contiguous float64 array, if they are what they should be."""
    corners = np.ascontiguousarray(corners, np.float64)
    if corners.ndim != 3 or corners.shape[1:] != (3, 3):
        raise ValueError(f"triangle: {name} of shape (n, 3, 3) expected, {corners.shape} came")
    # A sum is finite only of finite numbers; one that is not may have overflowed.
    with np.errstate(over="ignore", invalid="ignore"):
        total = corners.sum()
    if not np.isfinite(total) and not np.isfinite(corners).all():
        bad = int(np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))[0])
        raise ValueError(f"triangle: finite corners expected, {name}[{bad}] is {corners[bad].tolist()}")
    return corners
