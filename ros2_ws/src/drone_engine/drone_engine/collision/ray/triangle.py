"""A ray against a triangle, watertight: no ray passes through an edge or a vertex that triangles share.

Whether it hits is exact for the ray and the corners as given; only the distance is rounded. A triangle is closed. One
that is seen exactly edge on (as one without area always is) is not hit: its neighbors are.
Source: Woop, Benthin and Wald 2013 (Watertight Ray/Triangle Intersection), here with a filter and exact signs.
"""

import math

from drone_engine.collision.exact_arithmetic import add_determinant, orient3d, sign, zeros
from drone_engine.kernel import allocating, kernel

EPS = 2.0**-52
TINY = 1e-290  # more than an underflow can amount to


@kernel
def edge_function_error(reach):
    """A bound of the rounding error of an edge function, m2.

    reach: largest coordinate of a corner, from the origin of the ray, m.
    Each sheared coordinate, up to 2 reach, has up to 6 roundings of size reach, the function 4 of 4 reach^2 on top:
    32 eps reach^2.
    """
    return 48.0 * EPS * reach * reach + TINY


@allocating
def ray_triangle(corners, i, ox, oy, oz, dx, dy, dz, kx, ky, kz, sx, sy, sz, bound):
    """Distance from o along d, in units of d, to triangle i of corners (m, 3, 3); inf for a miss.

    kx to sz: of `shear`; bound: of `edge_function_error`. The result depends on the side on which the ray passes each
    edge, in coordinates that are sheared so that the ray is the third axis. An edge function farther from 0 than
    `bound` has the right sign; others are decided exactly. It takes 15 scalars and arrays, as an inner leaf.
    """
    o, d = (ox, oy, oz), (dx, dy, dz)
    az, bz, cz = corners[i, 0, kz] - o[kz], corners[i, 1, kz] - o[kz], corners[i, 2, kz] - o[kz]
    ax, ay = corners[i, 0, kx] - o[kx] - sx * az, corners[i, 0, ky] - o[ky] - sy * az
    bx, by = corners[i, 1, kx] - o[kx] - sx * bz, corners[i, 1, ky] - o[ky] - sy * bz
    cx, cy = corners[i, 2, kx] - o[kx] - sx * cz, corners[i, 2, ky] - o[ky] - sy * cz
    u, v, w = cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax
    if (u > bound or v > bound or w > bound) and (u < -bound or v < -bound or w < -bound):
        return math.inf
    flat = False
    if not (abs(u) > bound and abs(v) > bound and abs(w) > bound):
        flat = not (abs(u) > bound or abs(v) > bound or abs(w) > bound)
        u, v, w = (_side(corners, i, 2, 1, o, d, d[kz], u, bound), _side(corners, i, 0, 2, o, d, d[kz], v, bound),
                   _side(corners, i, 1, 0, o, d, d[kz], w, bound))
        most, least = max(u, v, w), min(u, v, w)
        if (most > 0.0 and least < 0.0) or (most == 0.0 and least == 0.0):
            return math.inf
    front, back = max(sz * az, sz * bz, sz * cz), min(sz * az, sz * bz, sz * cz)
    if front < 0.0:
        return math.inf
    if flat:
        t = sz * _edge_on_depth(ax, ay, az, bx, by, bz, cx, cy, cz)
    else:
        t = sz * ((u * az + v * bz + w * cz) / (u + v + w))
    if back <= 0.0:  # the origin may lie in the triangle's plane, or past it
        facing = (u + v + w < 0.0) == (d[kz] > 0.0)
        ahead = orient3d(ox, oy, oz, corners[i, 0, 0], corners[i, 0, 1], corners[i, 0, 2],
                               corners[i, 1, 0], corners[i, 1, 1], corners[i, 1, 2],
                               corners[i, 2, 0], corners[i, 2, 1], corners[i, 2, 2])
        if ahead == 0:
            return 0.0
        if (ahead > 0) != facing:
            return math.inf
    return max(t, 0.0)


@kernel
def shear(dx, dy, dz):
    """The shear that makes the direction the third axis: indices kx, ky, kz of the components, the largest last, the
    slopes sx, sy along the others, and the scale sz."""
    ax, ay, az = abs(dx), abs(dy), abs(dz)
    d = (dx, dy, dz)
    kz = 0 if ax >= ay and ax >= az else (1 if ay >= az else 2)
    kx, ky = (kz + 1) % 3, (kz + 2) % 3
    return kx, ky, kz, d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]


@allocating
def _side(corners, i, j, k, o, d, dz, value, bound):
    """The edge function of corners j and k of triangle i with the right sign: `value` if it has it, else +-TINY or 0.

    `value` is trusted if it is farther from 0 than `bound`. The sign is that of det[d, j - o, k - o], times that of dz.
    """
    if abs(value) > bound:
        return value
    jx, jy, jz = corners[i, j, 0], corners[i, j, 1], corners[i, j, 2]
    kx, ky, kz = corners[i, k, 0], corners[i, k, 1], corners[i, k, 2]
    acc = zeros()
    add_determinant(acc, 1, 1.0, d[0], d[1], d[2], jx, jy, jz, kx, ky, kz)
    add_determinant(acc, -1, 1.0, d[0], d[1], d[2], o[0], o[1], o[2], kx, ky, kz)
    add_determinant(acc, -1, 1.0, d[0], d[1], d[2], jx, jy, jz, o[0], o[1], o[2])
    side = sign(acc) if dz > 0.0 else -sign(acc)
    return value if side * value > 0.0 else side * TINY


@kernel
def _edge_on_depth(ax, ay, az, bx, by, bz, cx, cy, cz):
    """Where the third axis meets a triangle that it sees edge on, as coordinate along the axis: on the longest edge.

    a, b, c: corners in sheared coordinates.
    """
    ab, bc, ca = (bx - ax) ** 2 + (by - ay) ** 2, (cx - bx) ** 2 + (cy - by) ** 2, (ax - cx) ** 2 + (ay - cy) ** 2
    if bc >= ab and bc >= ca:
        ax, ay, az, bx, by, bz = bx, by, bz, cx, cy, cz
    elif ca >= ab:
        bx, by, bz = cx, cy, cz
    length = (bx - ax) ** 2 + (by - ay) ** 2
    s = -(ax * (bx - ax) + ay * (by - ay)) / length if length > 0.0 else 0.0
    return az + min(max(s, 0.0), 1.0) * (bz - az)
