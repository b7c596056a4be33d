"""Triangle against triangle: whether they meet, exactly; the contact of two that do, the distance of two that do not.

A triangle is closed and is what its nine float64 numbers say, a corner after the other, even if that is a segment or
a point. Two meet if and only if an edge of one meets the other: rounded sums decide it where their error bound allows
it, `triangle_exact` the rest. Contact and distance are rounded; they hold for sizes between 1e-60 and 1e60 m.
"""

import math

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.triangle.closest import closest
from drone_engine.collision.triangle.exact import RELATIVE, TINY, meet_exact
from drone_engine.kernel import kernel

NO_AREA = 1e-28  # squared sine between two edges below which a triangle has no normal
STEEP = 1e-6  # squared sine between two normals above which the planes' equations give a good point
ONE_PLANE = 1e-20  # squared sine between two normals below which the triangles lie in one plane


@kernel
def load(corners, i):
    """Triangle i of corners (n, 3, 3), as nine numbers."""
    return (corners[i, 0, 0], corners[i, 0, 1], corners[i, 0, 2], corners[i, 1, 0], corners[i, 1, 1], corners[i, 1, 2],
            corners[i, 2, 0], corners[i, 2, 1], corners[i, 2, 2])


@kernel
def meet(a, i, b, j):
    """What `touch` answers for triangles a[i] and b[j]; a, b: (n, 3, 3), a corner a row, finite numbers, m."""
    return touch(load(a, i), load(b, j))


@kernel
def touch(a, b):
    """Whether two triangles share a point, exactly; each is a tuple of nine finite numbers, three corners' x y z (m).

    As numbers and not as arrays: a kernel that is handed an array counts its references, which takes longer."""
    ax0, ay0, az0, ax1, ay1, az1, ax2, ay2, az2 = a
    bx0, by0, bz0, bx1, by1, bz1, bx2, by2, bz2 = b
    alx, ahx = _least(ax0, ax1, ax2), _most(ax0, ax1, ax2)
    blx, bhx = _least(bx0, bx1, bx2), _most(bx0, bx1, bx2)
    aly, ahy = _least(ay0, ay1, ay2), _most(ay0, ay1, ay2)
    bly, bhy = _least(by0, by1, by2), _most(by0, by1, by2)
    alz, ahz = _least(az0, az1, az2), _most(az0, az1, az2)
    blz, bhz = _least(bz0, bz1, bz2), _most(bz0, bz1, bz2)
    # How far the boxes are apart; the signs of rounded differences are exact. One comparison a stage, for a branch that
    # cannot be foreseen costs more than sums do.
    x0, y0, z0, x1, y1, z1 = blx - ahx, bly - ahy, blz - ahz, alx - bhx, aly - bhy, alz - bhz
    if _greater(_most(x0, y0, z0), _most(x1, y1, z1)) > 0.0:
        return False
    reach = (x0 + x1) + (y0 + y1) + (z0 + z1)  # minus both boxes' sizes; no difference is larger
    bound = TINY - RELATIVE * (reach * reach * reach)

    # Everything relative to a0: a's edges u and v, b's corners p, q, r, and on which side of a's plane these are.
    ux, uy, uz = ax1 - ax0, ay1 - ay0, az1 - az0
    vx, vy, vz = ax2 - ax0, ay2 - ay0, az2 - az0
    px, py, pz = bx0 - ax0, by0 - ay0, bz0 - az0
    qx, qy, qz = bx1 - ax0, by1 - ay0, bz1 - az0
    rx, ry, rz = bx2 - ax0, by2 - ay0, bz2 - az0
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    t0 = nx * px + ny * py + nz * pz
    t1 = nx * qx + ny * qy + nz * qz
    t2 = nx * rx + ny * ry + nz * rz
    if _greater(_least(t0, t1, t2), -_most(t0, t1, t2)) > bound:
        return False
    # The moments of b's edges about a0 (Pluecker coordinates). Times u and v they give how edge a0a1 (d) and edge a2a0
    # (f) pass each of b's edges; their sum is b's normal, so the sides of a's corners follow.
    kx, ky, kz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
    lx, ly, lz = qy * rz - qz * ry, qz * rx - qx * rz, qx * ry - qy * rx
    mx, my, mz = ry * pz - rz * py, rz * px - rx * pz, rx * py - ry * px
    d0, d1, d2 = ux * kx + uy * ky + uz * kz, ux * lx + uy * ly + uz * lz, ux * mx + uy * my + uz * mz
    f0, f1, f2 = -(vx * kx + vy * ky + vz * kz), -(vx * lx + vy * ly + vz * lz), -(vx * mx + vy * my + vz * mz)
    s0 = -(px * lx + py * ly + pz * lz)
    s1, s2 = s0 + (d0 + d1 + d2), s0 - (f0 + f1 + f2)
    if _greater(_least(s0, s1, s2), -_most(s0, s1, s2)) > bound:
        return False

    # They meet if and only if an edge meets the other triangle: its ends lie on two sides of it, and it passes the
    # other's three edges on one side. Nothing of the kind is decided by a number within the bound.
    e0, e1, e2 = (t1 - t0) - (d0 + f0), (t2 - t1) - (d1 + f1), (t0 - t2) - (d2 + f2)
    through_b = _most(_through(s0, s1, d0, d1, d2), _through(s1, s2, e0, e1, e2), _through(s2, s0, f0, f1, f2))
    through_a = _most(_through(t0, t1, d0, e0, f0), _through(t1, t2, d1, e1, f1), _through(t2, t0, d2, e2, f2))
    through = _greater(through_a, through_b)
    if abs(through) > bound:
        return through > 0.0
    return meet_exact(a, b)


@kernel
def _through(s, t, x, y, z):
    """Positive if s and t differ in sign and x, y, z agree; how much, tells how surely."""
    apart, alike = _lesser(_greater(s, t), -_lesser(s, t)), _greater(_least(x, y, z), -_most(x, y, z))
    return _lesser(apart, alike)


@kernel
def _lesser(x, y):
    return x if x < y else y


@kernel
def _greater(x, y):
    return x if x > y else y


@kernel
def _least(x, y, z):
    least = x if x < y else y
    return least if least < z else z


@kernel
def _most(x, y, z):
    most = x if x > y else y
    return most if most > z else z


@kernel
def contact(a, b):
    """Point, unit normal from a to b and depth of two triangles that meet: x, y, z, nx, ny, nz, depth.

    The point is in the middle of what they have in common, or in one plane a point of it. The depth is how far one must
    move along a face's normal to be on one side of that face, for the face and the side where this is least.
    """
    anx, any_, anz, depth_a, t0, t1, t2 = _face(a, b)
    bnx, bny, bnz, depth_b, s0, s1, s2 = _face(b, a)
    x, y, z = _common(a, b, anx, any_, anz, bnx, bny, bnz, s0, s1, s2, t0, t1, t2)
    if depth_a < depth_b or (depth_a == depth_b < np.inf and a <= b):
        return x, y, z, anx, any_, anz, depth_a
    if depth_b < np.inf:
        return x, y, z, -bnx, -bny, -bnz, depth_b
    nx, ny, nz = _across(a, b)
    return x, y, z, nx, ny, nz, 0.0


@kernel
def _face(o, p):
    """For the face of o: the unit normal towards the side on which p is to leave, how deep p is, its corners' heights.

    All 0 and infinitely deep where o has no area."""
    x, y, z = o[0], o[1], o[2]
    ux, uy, uz, vx, vy, vz = o[3] - x, o[4] - y, o[5] - z, o[6] - x, o[7] - y, o[8] - z
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    if not square > NO_AREA * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
        return 0.0, 0.0, 0.0, np.inf, 0.0, 0.0, 0.0
    scale = 1.0 / np.sqrt(square)
    nx, ny, nz = nx * scale, ny * scale, nz * scale
    h0 = nx * (p[0] - x) + ny * (p[1] - y) + nz * (p[2] - z)
    h1 = nx * (p[3] - x) + ny * (p[4] - y) + nz * (p[5] - z)
    h2 = nx * (p[6] - x) + ny * (p[7] - y) + nz * (p[8] - z)
    above, below = _most(h0, h1, h2), -_least(h0, h1, h2)
    up = math.copysign(1.0, above - below)
    return up * nx, up * ny, up * nz, _greater(_lesser(above, below), 0.0), up * h0, up * h1, up * h2


@kernel
def _across(a, b):
    """A unit vector at right angles to the longest edges of two triangles without area, from a to b."""
    ux, uy, uz = _longest(a)
    vx, vy, vz = _longest(b)
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    if square > NO_AREA * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
        scale = 1.0 / np.sqrt(square)
        return nx * scale, ny * scale, nz * scale
    if ux == 0.0 and uy == 0.0 and uz == 0.0:
        ux, uy, uz = vx, vy, vz
    if ux == 0.0 and uy == 0.0:
        nx, ny = 1.0, 0.0
    else:
        scale = 1.0 / np.sqrt(ux * ux + uy * uy)
        nx, ny = -uy * scale, ux * scale
    return (nx, ny, 0.0) if a <= b else (-nx, -ny, 0.0)


@kernel
def _longest(a):
    """The longest edge."""
    ux, uy, uz, vx, vy, vz = a[3] - a[0], a[4] - a[1], a[5] - a[2], a[6] - a[3], a[7] - a[4], a[8] - a[5]
    wx, wy, wz = a[0] - a[6], a[1] - a[7], a[2] - a[8]
    u, v, w = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz
    if u >= v and u >= w:
        return ux, uy, uz
    return (vx, vy, vz) if v >= w else (wx, wy, wz)


@kernel
def _common(a, b, anx, any_, anz, bnx, bny, bnz, s0, s1, s2, t0, t1, t2):
    """The middle of what two triangles have in common, given their unit normals and their corners' heights."""
    x, y, z = any_ * bnz - anz * bny, anz * bnx - anx * bnz, anx * bny - any_ * bnx
    square = x * x + y * y + z * z
    if square < ONE_PLANE:
        _, px, py, pz, qx, qy, qz = closest(a, b)
        return 0.5 * (px + qx), 0.5 * (py + qy), 0.5 * (pz + qz)
    # Each covers an interval on the line in which the planes cross; the greater start and the lesser end count.
    ox, oy, oz = a[0], a[1], a[2]
    x1, x2 = _along(a, 3, ox, oy, oz, x, y, z), _along(a, 6, ox, oy, oz, x, y, z)
    y0, y1, y2 = _along(b, 0, ox, oy, oz, x, y, z), _along(b, 3, ox, oy, oz, x, y, z), _along(b, 6, ox, oy, oz, x, y, z)
    start_a, end_a = _span(s0, s1, s2, 0.0, x1, x2)
    start_b, end_b = _span(t0, t1, t2, y0, y1, y2)
    start, end = _greater(start_a, start_b), _lesser(end_a, end_b)
    if square > STEEP and -np.inf < start <= end < np.inf:
        # The point at height 0 over both planes in the middle of both, as seen from a's first corner.
        p, q = 0.5 * (start + end) / square, -s0 / square
        return (ox + (p * x + q * (y * anz - z * any_)), oy + (p * y + q * (z * anx - x * anz)),
                oz + (p * z + q * (x * any_ - y * anx)))
    p0, px, py, pz, p1, qx, qy, qz = _interval(a, s0, s1, s2, x, y, z)
    r0, rx, ry, rz, r1, wx, wy, wz = _interval(b, t0, t1, t2, x, y, z)
    if r0 > p0:
        px, py, pz = rx, ry, rz
    if r1 < p1:
        qx, qy, qz = wx, wy, wz
    return 0.5 * (px + qx), 0.5 * (py + qy), 0.5 * (pz + qz)


@kernel
def _along(a, k, ox, oy, oz, x, y, z):
    return (a[k] - ox) * x + (a[k + 1] - oy) * y + (a[k + 2] - oz) * z


@kernel
def _span(h0, h1, h2, x0, x1, x2):
    """From where to where a triangle crosses height 0, for corners at heights h and places x; empty or infinite if
    corners only touch it."""
    p0, p1, p2 = (x0 * h1 - x1 * h0) / (h1 - h0), (x1 * h2 - x2 * h1) / (h2 - h1), (x2 * h0 - x0 * h2) / (h0 - h2)
    # Infinite for an edge with both ends on one side.
    m0, m1, m2 = math.copysign(np.inf, h0 * h1), math.copysign(np.inf, h1 * h2), math.copysign(np.inf, h2 * h0)
    return (_least(_greater(p0, m0), _greater(p1, m1), _greater(p2, m2)),
            _most(_lesser(p0, -m0), _lesser(p1, -m1), _lesser(p2, -m2)))


@kernel
def _interval(a, h0, h1, h2, x, y, z):
    """Where a triangle with corners at heights h crosses height 0: both points, each after its place along x, y, z."""
    if h0 <= 0.0 and h1 <= 0.0 and h2 <= 0.0:
        h0, h1, h2 = -h0, -h1, -h2
    # Turned so that the corner alone on its side comes first; if rounding left none, the lowest one touches.
    if (h0 > 0.0) == (h2 > 0.0) != (h1 > 0.0) or (h1 < _lesser(h0, h2) and h0 > 0.0 and h2 > 0.0):
        a, h0, h1, h2 = a[3:] + a[:3], h1, h2, h0
    elif (h0 > 0.0) == (h1 > 0.0) != (h2 > 0.0) or (h2 < _lesser(h0, h1) and h0 > 0.0 and h1 > 0.0):
        a, h0, h1, h2 = a[6:] + a[:6], h2, h0, h1
    s = h0 / (h0 - h1) if (h0 > 0.0) != (h1 > 0.0) else 0.0
    t = h0 / (h0 - h2) if (h0 > 0.0) != (h2 > 0.0) else 0.0
    px, py, pz = a[0] + s * (a[3] - a[0]), a[1] + s * (a[4] - a[1]), a[2] + s * (a[5] - a[2])
    qx, qy, qz = a[0] + t * (a[6] - a[0]), a[1] + t * (a[7] - a[1]), a[2] + t * (a[8] - a[2])
    p, q = x * px + y * py + z * pz, x * qx + y * qy + z * qz
    if p <= q:
        return p, px, py, pz, q, qx, qy, qz
    return q, qx, qy, qz, p, px, py, pz


@kernel
def distance(a, b):
    """The smallest distance of two triangles and where it is: distance, a's point x, y, z, b's point x, y, z.

    0 and one point twice where they meet."""
    if touch(a, b):
        x, y, z, _, _, _, _ = contact(a, b)
        return 0.0, x, y, z, x, y, z
    square, px, py, pz, qx, qy, qz = closest(a, b)
    return np.sqrt(square), px, py, pz, qx, qy, qz


@kernel
def _meet_all(a, b, out):
    for i in range(a.shape[0]):
        out[i] = touch(load(a, i), load(b, i))


@kernel
def _contact_all(a, b, number, result):
    for i in range(len(number)):
        result[i] = contact(load(a, number[i]), load(b, number[i]))


@kernel
def _distance_all(a, b, result):
    for i in range(len(a)):
        result[i] = distance(load(a, i), load(b, i))


def intersects(a: Floats, b: Floats) -> Booleans:
    """Whether triangle a[i] and triangle b[i] share a point, exactly: (n,) for a, b of shape (n, 3, 3), m.

    Touching counts, a triangle may be a segment or a point. ValueError for other shapes and non-finite numbers."""
    a, b = _checked(a, b)
    out = np.empty(len(a), np.bool_)
    _meet_all(a, b, out)
    return out


def contacts(a: Floats, b: Floats) -> tuple[Integers, Floats, Floats, Floats]:
    """Which pairs a[i], b[i] meet and their contacts: numbers i (k,), points (k, 3), normals (k, 3) from a to b, depths
    (k,); a, b: (n, 3, 3), m. See `contact`. ValueError as in `intersects`."""
    number = np.flatnonzero(intersects(a, b))
    a, b = _checked(a, b)
    result = np.empty((len(number), 7))
    _contact_all(a, b, number, result)
    return number, result[:, :3], result[:, 3:6], result[:, 6]


def distances(a: Floats, b: Floats) -> tuple[Floats, Floats, Floats]:
    """Distances (n,) of triangles a[i] and b[i], (n, 3, 3), m, and the closest points of a and of b, (n, 3) each.

    0 where they meet. ValueError as in `intersects`."""
    a, b = _checked(a, b)
    result = np.empty((len(a), 7))
    _distance_all(a, b, result)
    return result[:, 0], result[:, 1:4], result[:, 4:]


def _checked(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Both as contiguous float64 arrays, if they are what they should be."""
    a, b = _finite("a", a), _finite("b", b)
    if len(a) != len(b):
        raise ValueError(f"triangle: as many a as b expected, {len(a)} and {len(b)} came")
    return a, b


def _finite(name: str, corners: Floats) -> Floats:
    """Corners as a contiguous float64 array, if they are finite and of the right shape."""
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
