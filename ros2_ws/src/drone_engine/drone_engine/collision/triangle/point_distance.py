"""The distance of a point from a triangle, in rounded arithmetic."""

import math

from drone_engine.kernel import kernel


@kernel
def squared_distance(x, y, z, t):
    """The squared distance of a point from triangle t, a corner per row, m^2; inf for a triangle without area (Ericson
    2005, Real-Time Collision Detection, 5.1.5)."""
    ux, uy, uz = t[1, 0] - t[0, 0], t[1, 1] - t[0, 1], t[1, 2] - t[0, 2]
    vx, vy, vz = t[2, 0] - t[0, 0], t[2, 1] - t[0, 1], t[2, 2] - t[0, 2]
    px, py, pz = x - t[0, 0], y - t[0, 1], z - t[0, 2]
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    pu, pv = px * ux + py * uy + pz * uz, px * vx + py * vy + pz * vz
    area = uu * vv - uv * uv
    if area <= 0.0:
        return math.inf
    s, w = vv * pu - uv * pv, uu * pv - uv * pu
    if s >= 0.0 and w >= 0.0 and s + w <= area:  # the point projects into the triangle
        s, w = s / area, w / area
        return (px - s * ux - w * vx) ** 2 + (py - s * uy - w * vy) ** 2 + (pz - s * uz - w * vz) ** 2
    first = _squared_segment_distance(px, py, pz, ux, uy, uz, pu, uu)
    second = _squared_segment_distance(px, py, pz, vx, vy, vz, pv, vv)
    ex, ey, ez = vx - ux, vy - uy, vz - uz
    qx, qy, qz = px - ux, py - uy, pz - uz
    third = _squared_segment_distance(qx, qy, qz, ex, ey, ez, qx * ex + qy * ey + qz * ez, ex * ex + ey * ey + ez * ez)
    return min(first, second, third)


@kernel
def _squared_segment_distance(px, py, pz, ux, uy, uz, pu, uu):
    """The squared distance of point p from the segment from the origin to u; pu, uu: their dot products."""
    s = min(max(pu / uu, 0.0), 1.0)
    return (px - s * ux) ** 2 + (py - s * uy) ** 2 + (pz - s * uz) ** 2
