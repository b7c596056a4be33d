"""Floating-point filters for pairs of triangles of two meshes: fast answers where rounding cannot change them.

Both triangles are given in the frame of mesh a, whose coordinates are small, so the error bounds are small as well.
Triangle a[i] is row i of a (m, 3, 3), triangle b is the only row of b (1, 3, 3) with the normal (nx, ny, nz) from
`triangle_normal`; m. bound: upper bound of the error of a determinant of differences of their corners, m^3.
"""

import math

from drone_engine.collision.triangle.geometry import triangle_normal
from drone_engine.kernel import kernel
from drone_engine.math.scalar import max3, min3

UNDERFLOW_ERROR = 1e-300  # m^3, more than a determinant can lose to underflow
INTERSECTING, DISJOINT, UNDECIDED = 1, 0, -1  # answers


@kernel
def intersection_filter(a, i, b, nx, ny, nz, bound):
    """Whether triangle a[i] and triangle b intersect: INTERSECTING, DISJOINT, or UNDECIDED if a determinant that
    matters is not above `bound`.

    The signs are those of Guigue and Devillers 2003, Fast and Robust Triangle-Triangle Overlap Test.
    """
    a0, a1, a2 = _plane_sides(nx, ny, nz, b[0, 0, 0], b[0, 0, 1], b[0, 0, 2], a, i)
    if min3(a0, a1, a2) > bound or max3(a0, a1, a2) < -bound:
        return DISJOINT
    mx, my, mz = triangle_normal(a, i)
    b0, b1, b2 = _plane_sides(mx, my, mz, a[i, 0, 0], a[i, 0, 1], a[i, 0, 2], b, 0)
    if min3(b0, b1, b2) > bound or max3(b0, b1, b2) < -bound:
        return DISJOINT
    if not min3(min3(abs(a0), abs(a1), abs(a2)), min3(abs(b0), abs(b1), abs(b2)), math.inf) > bound:
        return UNDECIDED
    p, q, r, above_b = _lone_corner(a0 > 0.0, a1 > 0.0, a2 > 0.0)
    u, v, w, above_a = _lone_corner(b0 > 0.0, b1 > 0.0, b2 > 0.0)
    if not above_b:
        v, w = w, v
    if not above_a:
        q, r = r, q
    s, t = _orient3d(a, i, p, q, b, u, v), _orient3d(a, i, p, r, b, w, u)
    if s > bound or t > bound:
        return DISJOINT
    return INTERSECTING if s < -bound and t < -bound else UNDECIDED


@kernel
def is_outside_box(t, box, node, margin):
    """Whether triangle t (1, 3, 3) is more than `margin` m away from the axis-aligned box of a node, box (k, 6), along
    some axis."""
    for k in range(3):
        reach = box[node, 3 + k] + margin
        if (min3(t[0, 0, k], t[0, 1, k], t[0, 2, k]) - box[node, k] > reach
                or box[node, k] - max3(t[0, 0, k], t[0, 1, k], t[0, 2, k]) > reach):
            return True
    return False


@kernel
def is_farther_apart(a, i, b, nx, ny, nz, margin, bound):
    """Whether the bounding boxes or the planes prove that triangle a[i] and triangle b are more than `margin` m
    apart."""
    for k in range(3):
        if (min3(b[0, 0, k], b[0, 1, k], b[0, 2, k]) - max3(a[i, 0, k], a[i, 1, k], a[i, 2, k]) > margin
                or min3(a[i, 0, k], a[i, 1, k], a[i, 2, k]) - max3(b[0, 0, k], b[0, 1, k], b[0, 2, k]) > margin):
            return True
    far = bound + 1.000001 * margin * math.sqrt(nx * nx + ny * ny + nz * nz)
    a0, a1, a2 = _plane_sides(nx, ny, nz, b[0, 0, 0], b[0, 0, 1], b[0, 0, 2], a, i)
    if min3(a0, a1, a2) > far or max3(a0, a1, a2) < -far:
        return True
    mx, my, mz = triangle_normal(a, i)
    far = bound + 1.000001 * margin * math.sqrt(mx * mx + my * my + mz * mz)
    b0, b1, b2 = _plane_sides(mx, my, mz, a[i, 0, 0], a[i, 0, 1], a[i, 0, 2], b, 0)
    return min3(b0, b1, b2) > far or max3(b0, b1, b2) < -far


@kernel
def _plane_sides(nx, ny, nz, x, y, z, t, i):
    """The heights of the corners of triangle t[i] above the plane through (x, y, z) with normal n, times the length of
    n: determinants, m^3."""
    return (nx * (t[i, 0, 0] - x) + ny * (t[i, 0, 1] - y) + nz * (t[i, 0, 2] - z),
            nx * (t[i, 1, 0] - x) + ny * (t[i, 1, 1] - y) + nz * (t[i, 1, 2] - z),
            nx * (t[i, 2, 0] - x) + ny * (t[i, 2, 1] - y) + nz * (t[i, 2, 2] - z))


@kernel
def _lone_corner(s0, s1, s2):
    """The index of the corner that is alone on its side of a plane, those of the next two in order, and whether the
    lone corner is above the plane. s0, s1, s2: whether each corner is above."""
    if s0 == s1:
        return 2, 0, 1, s2
    if s0 == s2:
        return 1, 2, 0, s1
    return 0, 1, 2, s0


@kernel
def _orient3d(a, i, p, q, b, u, v):
    """det[q - p, u - p, v - p] of corners p, q of triangle a[i] and u, v of triangle b, m^3."""
    x, y, z = a[i, p, 0], a[i, p, 1], a[i, p, 2]
    qx, qy, qz = a[i, q, 0] - x, a[i, q, 1] - y, a[i, q, 2] - z
    ux, uy, uz = b[0, u, 0] - x, b[0, u, 1] - y, b[0, u, 2] - z
    vx, vy, vz = b[0, v, 0] - x, b[0, v, 1] - y, b[0, v, 2] - z
    return qx * (uy * vz - uz * vy) + qy * (uz * vx - ux * vz) + qz * (ux * vy - uy * vx)
