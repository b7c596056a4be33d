"""The closest points of two triangles, in rounded arithmetic.

Triangles are tuples of nine numbers, x y z of each corner in turn. The closest points of two triangles that do not
intersect lie on an edge of each, or on a corner of one and the face of the other (Ericson 2005, Real-Time Collision
Detection, 5.1.10).
"""

import numpy as np

from drone_engine.kernel import kernel

PARALLEL_EDGES_SIN2 = 1e-24  # squared sine between two edges below which any point of them may be the closest


@kernel
def closest_points(a, b):
    """The squared distance of two triangles that do not intersect, and their closest points.

    Returns (squared distance, x, y, z of the point of a, x, y, z of the point of b), m.
    """
    best = (np.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for _ in range(3):
        for _ in range(3):
            found = _edge_edge(a, b)
            if found[0] < best[0]:
                best = found
            b = b[3:] + b[:3]
        square, x, y, z = _corner_face(a[0], a[1], a[2], b)
        if square < best[0]:
            best = (square, a[0], a[1], a[2], x, y, z)
        a = a[3:] + a[:3]
    for _ in range(3):
        square, x, y, z = _corner_face(b[0], b[1], b[2], a)
        if square < best[0]:
            best = (square, x, y, z, b[0], b[1], b[2])
        b = b[3:] + b[:3]
    return best


@kernel
def _corner_face(x, y, z, b):
    """The squared distance of a point from its projection onto the plane of triangle b, and that projection (x, y, z);
    the distance is infinite if the projection lies outside of the triangle or the triangle has no area."""
    ux, uy, uz, vx, vy, vz = b[3] - b[0], b[4] - b[1], b[5] - b[2], b[6] - b[0], b[7] - b[1], b[8] - b[2]
    wx, wy, wz = x - b[0], y - b[1], z - b[2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    s = (nx * (wy * vz - wz * vy) + ny * (wz * vx - wx * vz) + nz * (wx * vy - wy * vx)) / square
    t = (nx * (uy * wz - uz * wy) + ny * (uz * wx - ux * wz) + nz * (ux * wy - uy * wx)) / square
    if not (s >= 0.0 and t >= 0.0 and s + t <= 1.0):  # NaN where there is no area: then the edges decide
        return np.inf, 0.0, 0.0, 0.0
    px, py, pz = b[0] + (s * ux + t * vx), b[1] + (s * uy + t * vy), b[2] + (s * uz + t * vz)
    return (x - px) ** 2 + (y - py) ** 2 + (z - pz) ** 2, px, py, pz


@kernel
def _edge_edge(a, b):
    """The squared distance of the first edges of two triangles and their closest points, laid out as the result of
    `closest_points` (Ericson 2005, 5.1.9).

    `continuous.triangle_advancement` and `mesh.features` have the same formula with other roundings: they take the
    squared length of the cross product as uu * vv - uv * uv, which is cheaper.
    """
    ux, uy, uz, vx, vy, vz = a[3] - a[0], a[4] - a[1], a[5] - a[2], b[3] - b[0], b[4] - b[1], b[5] - b[2]
    wx, wy, wz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    uu, vv, uv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, ux * vx + uy * vy + uz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    # By cross products: uu * vv - uv * uv loses all digits where edges are nearly parallel.
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    s = 0.0
    if square > PARALLEL_EDGES_SIN2 * uu * vv:
        s = (nx * (wy * vz - wz * vy) + ny * (wz * vx - wx * vz) + nz * (wx * vy - wy * vx)) / square
        s = min(max(s, 0.0), 1.0)
    t = (s * uv - vw) / vv if vv > 0.0 else 0.0
    if not 0.0 < t < 1.0:
        t = min(max(t, 0.0), 1.0)
        s = min(max((uw + t * uv) / uu, 0.0), 1.0) if uu > 0.0 else 0.0
    px, py, pz = a[0] + s * ux, a[1] + s * uy, a[2] + s * uz
    qx, qy, qz = b[0] + t * vx, b[1] + t * vy, b[2] + t * vz
    return (px - qx) ** 2 + (py - qy) ** 2 + (pz - qz) ** 2, px, py, pz, qx, qy, qz
