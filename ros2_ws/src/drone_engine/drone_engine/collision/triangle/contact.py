"""Triangle against triangle: the contact of two that intersect, the distance and closest points of two that do not.

Triangles are tuples of nine numbers, x y z of each corner in turn, m. The results are rounded; they hold for sizes
between 1e-60 and 1e60 m.
"""

import math

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.triangle.closest import closest_points
from drone_engine.collision.triangle.geometry import triangle_at
from drone_engine.collision.triangle.intersection import checked_pairs, intersects, triangles_intersect
from drone_engine.kernel import allocating, kernel
from drone_engine.math.scalar import max2, max3, min2, min3

MIN_AREA_SIN2 = 1e-28  # squared sine between two edges below which a triangle counts as without area
MIN_CROSSING_SIN2 = 1e-6  # squared sine between two normals above which the planes' equations give an accurate point
COPLANAR_SIN2 = 1e-20  # squared sine between two normals below which the triangles count as coplanar


@kernel
def contact(a, b):
    """The contact of two triangles that intersect: (x, y, z, nx, ny, nz, depth), a point, the unit normal from a to b
    and the depth, m.

    The point is the middle of the common segment; for coplanar triangles some common point. The depth is the smallest
    distance by which one triangle must move along a face's normal to lie on one side of that face.
    """
    anx, any_, anz, depth_a, t0, t1, t2 = _face_depth(a, b)
    bnx, bny, bnz, depth_b, s0, s1, s2 = _face_depth(b, a)
    x, y, z = _contact_point(a, b, anx, any_, anz, bnx, bny, bnz, s0, s1, s2, t0, t1, t2)
    if depth_a < depth_b or (depth_a == depth_b < np.inf and a <= b):
        return x, y, z, anx, any_, anz, depth_a
    if depth_b < np.inf:
        return x, y, z, -bnx, -bny, -bnz, depth_b
    nx, ny, nz = _segment_normal(a, b)
    return x, y, z, nx, ny, nz, 0.0


@kernel
def _face_depth(o, p):
    """How deep triangle p reaches through the face of triangle o, on the side where this is less.

    Returns (nx, ny, nz, depth, h0, h1, h2): the face's unit normal towards the side on which p is to be moved out, the
    depth, and the heights of p's corners along the normal, m. If o has no area, all are 0 and the depth is infinite.
    """
    x, y, z = o[0], o[1], o[2]
    ux, uy, uz, vx, vy, vz = o[3] - x, o[4] - y, o[5] - z, o[6] - x, o[7] - y, o[8] - z
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    if not square > MIN_AREA_SIN2 * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
        return 0.0, 0.0, 0.0, np.inf, 0.0, 0.0, 0.0
    scale = 1.0 / np.sqrt(square)
    nx, ny, nz = nx * scale, ny * scale, nz * scale
    h0 = nx * (p[0] - x) + ny * (p[1] - y) + nz * (p[2] - z)
    h1 = nx * (p[3] - x) + ny * (p[4] - y) + nz * (p[5] - z)
    h2 = nx * (p[6] - x) + ny * (p[7] - y) + nz * (p[8] - z)
    above, below = max3(h0, h1, h2), -min3(h0, h1, h2)
    up = math.copysign(1.0, above - below)
    return up * nx, up * ny, up * nz, max2(min2(above, below), 0.0), up * h0, up * h1, up * h2


@kernel
def _segment_normal(a, b):
    """A unit vector perpendicular to the longest edges of two triangles without area; swapping a and b negates it."""
    ux, uy, uz = _longest_edge(a)
    vx, vy, vz = _longest_edge(b)
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    if square > MIN_AREA_SIN2 * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
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
def _longest_edge(a):
    """The longest edge of a triangle, as a vector (x, y, z)."""
    ux, uy, uz, vx, vy, vz = a[3] - a[0], a[4] - a[1], a[5] - a[2], a[6] - a[3], a[7] - a[4], a[8] - a[5]
    wx, wy, wz = a[0] - a[6], a[1] - a[7], a[2] - a[8]
    u, v, w = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz
    if u >= v and u >= w:
        return ux, uy, uz
    return (vx, vy, vz) if v >= w else (wx, wy, wz)


@kernel
def _contact_point(a, b, anx, any_, anz, bnx, bny, bnz, s0, s1, s2, t0, t1, t2):
    """The middle (x, y, z) of the segment that two triangles have in common.

    anx .. bnz: unit normals of a and b; s: heights of a's corners above b's plane, t: of b's above a's, m.
    """
    x, y, z = any_ * bnz - anz * bny, anz * bnx - anx * bnz, anx * bny - any_ * bnx
    square = x * x + y * y + z * z
    if square < COPLANAR_SIN2:
        _, px, py, pz, qx, qy, qz = closest_points(a, b)
        return 0.5 * (px + qx), 0.5 * (py + qy), 0.5 * (pz + qz)
    # Each covers an interval of the line in which the planes intersect; the common part is between the greater start
    # and the smaller end.
    ox, oy, oz = a[0], a[1], a[2]
    x1, x2 = _coordinate(a, 3, ox, oy, oz, x, y, z), _coordinate(a, 6, ox, oy, oz, x, y, z)
    y0, y1 = _coordinate(b, 0, ox, oy, oz, x, y, z), _coordinate(b, 3, ox, oy, oz, x, y, z)
    y2 = _coordinate(b, 6, ox, oy, oz, x, y, z)
    start_a, end_a = _crossing_interval(s0, s1, s2, 0.0, x1, x2)
    start_b, end_b = _crossing_interval(t0, t1, t2, y0, y1, y2)
    start, end = max2(start_a, start_b), min2(end_a, end_b)
    if square > MIN_CROSSING_SIN2 and -np.inf < start <= end < np.inf:
        # The point at height 0 over both planes, in the middle of the common interval, relative to a's first corner.
        p, q = 0.5 * (start + end) / square, -s0 / square
        return (ox + (p * x + q * (y * anz - z * any_)), oy + (p * y + q * (z * anx - x * anz)),
                oz + (p * z + q * (x * any_ - y * anx)))
    p0, px, py, pz, p1, qx, qy, qz = _crossing_points(a, s0, s1, s2, x, y, z)
    r0, rx, ry, rz, r1, wx, wy, wz = _crossing_points(b, t0, t1, t2, x, y, z)
    if r0 > p0:
        px, py, pz = rx, ry, rz
    if r1 < p1:
        qx, qy, qz = wx, wy, wz
    return 0.5 * (px + qx), 0.5 * (py + qy), 0.5 * (pz + qz)


@kernel
def _coordinate(a, k, ox, oy, oz, x, y, z):
    """The dot product of (x, y, z) with the vector from (ox, oy, oz) to numbers k to k + 2 of a."""
    return (a[k] - ox) * x + (a[k + 1] - oy) * y + (a[k + 2] - oz) * z


@kernel
def _crossing_interval(h0, h1, h2, x0, x1, x2):
    """The interval (start, end) of coordinates in which a triangle crosses height 0; h: heights of its corners, x:
    their coordinates along the line of intersection. Empty or infinite if corners only touch height 0."""
    p0, p1, p2 = (x0 * h1 - x1 * h0) / (h1 - h0), (x1 * h2 - x2 * h1) / (h2 - h1), (x2 * h0 - x0 * h2) / (h0 - h2)
    # An edge with both ends on one side is masked by an infinity.
    m0, m1, m2 = math.copysign(np.inf, h0 * h1), math.copysign(np.inf, h1 * h2), math.copysign(np.inf, h2 * h0)
    return (min3(max2(p0, m0), max2(p1, m1), max2(p2, m2)),
            max3(min2(p0, -m0), min2(p1, -m1), min2(p2, -m2)))


@kernel
def _crossing_points(a, h0, h1, h2, x, y, z):
    """The two points in which the edges of a triangle with corners at heights h cross height 0, in order along
    (x, y, z): (coordinate, x, y, z) of each."""
    if h0 <= 0.0 and h1 <= 0.0 and h2 <= 0.0:
        h0, h1, h2 = -h0, -h1, -h2
    # Permuted so that the corner alone on its side comes first; if rounding left none, the lowest one touches.
    if (h0 > 0.0) == (h2 > 0.0) != (h1 > 0.0) or (h1 < min2(h0, h2) and h0 > 0.0 and h2 > 0.0):
        a, h0, h1, h2 = a[3:] + a[:3], h1, h2, h0
    elif (h0 > 0.0) == (h1 > 0.0) != (h2 > 0.0) or (h2 < min2(h0, h1) and h0 > 0.0 and h1 > 0.0):
        a, h0, h1, h2 = a[6:] + a[:6], h2, h0, h1
    s = h0 / (h0 - h1) if (h0 > 0.0) != (h1 > 0.0) else 0.0
    t = h0 / (h0 - h2) if (h0 > 0.0) != (h2 > 0.0) else 0.0
    px, py, pz = a[0] + s * (a[3] - a[0]), a[1] + s * (a[4] - a[1]), a[2] + s * (a[5] - a[2])
    qx, qy, qz = a[0] + t * (a[6] - a[0]), a[1] + t * (a[7] - a[1]), a[2] + t * (a[8] - a[2])
    p, q = x * px + y * py + z * pz, x * qx + y * qy + z * qz
    if p <= q:
        return p, px, py, pz, q, qx, qy, qz
    return q, qx, qy, qz, p, px, py, pz


@allocating
def distance(a, b):
    """The distance of two triangles and their closest points: (distance, x, y, z of a's point, x, y, z of b's), m.

    If they intersect, 0 and one common point twice.
    """
    if triangles_intersect(a, b):
        x, y, z, _, _, _, _ = contact(a, b)
        return 0.0, x, y, z, x, y, z
    square, px, py, pz, qx, qy, qz = closest_points(a, b)
    return np.sqrt(square), px, py, pz, qx, qy, qz


@kernel
def _contact_all(a, b, number, result):
    """Writes the contacts of pairs `number` (k,) of triangles a and b, (n, 3, 3), to result (k, 7)."""
    for i in range(len(number)):
        result[i] = contact(triangle_at(a, number[i]), triangle_at(b, number[i]))


@allocating
def _distance_all(a, b, result):
    """Writes the distances and closest points of triangles a and b, (n, 3, 3), to result (n, 7)."""
    for i in range(len(a)):
        result[i] = distance(triangle_at(a, i), triangle_at(b, i))


def contacts(a: Floats, b: Floats) -> tuple[Integers, Floats, Floats, Floats]:
    """The pairs a[i], b[i] that intersect and their contacts: indices i (k,), points (k, 3) m, unit normals from a to b
    (k, 3), depths (k,) m; a, b: (n, 3, 3), m. See `contact`. Raises ValueError as `intersects` does."""
    number = np.flatnonzero(intersects(a, b))
    a, b = checked_pairs(a, b)
    result = np.empty((len(number), 7))
    _contact_all(a, b, number, result)
    return number, result[:, :3], result[:, 3:6], result[:, 6]


def distances(a: Floats, b: Floats) -> tuple[Floats, Floats, Floats]:
    """Distances (n,) of triangles a[i] and b[i], (n, 3, 3), and the closest points of a and of b, (n, 3) each; m.

    0 where they intersect. Raises ValueError as `intersects` does.
    """
    a, b = checked_pairs(a, b)
    result = np.empty((len(a), 7))
    _distance_all(a, b, result)
    return result[:, 0], result[:, 1:4], result[:, 4:]
