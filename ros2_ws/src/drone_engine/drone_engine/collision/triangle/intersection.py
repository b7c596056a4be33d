"""Triangle against triangle: whether they share a point, exactly.

A triangle is closed and defined by its nine float64 numbers, x y z of each corner in turn, even if it degenerates to a
segment or a point. Two triangles intersect if and only if an edge of one intersects the other triangle. Rounded sums
decide where their error bound allows it, `triangle.exact` decides the rest.
"""

import numpy as np

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.triangle.exact import ERROR_FACTOR, UNDERFLOW_ERROR, triangles_intersect_exact
from drone_engine.collision.triangle.geometry import triangle_at
from drone_engine.kernel import allocating, kernel
from drone_engine.math.scalar import max2, max3, min2, min3


@allocating
def triangles_intersect(a, b):
    """Whether two triangles share a point, exactly; each is a tuple of nine finite numbers, m.

    Tuples instead of arrays: a kernel that takes an array counts its references, which takes longer.
    """
    ax0, ay0, az0, ax1, ay1, az1, ax2, ay2, az2 = a
    bx0, by0, bz0, bx1, by1, bz1, bx2, by2, bz2 = b
    alx, ahx = min3(ax0, ax1, ax2), max3(ax0, ax1, ax2)
    blx, bhx = min3(bx0, bx1, bx2), max3(bx0, bx1, bx2)
    aly, ahy = min3(ay0, ay1, ay2), max3(ay0, ay1, ay2)
    bly, bhy = min3(by0, by1, by2), max3(by0, by1, by2)
    alz, ahz = min3(az0, az1, az2), max3(az0, az1, az2)
    blz, bhz = min3(bz0, bz1, bz2), max3(bz0, bz1, bz2)
    # Gaps between the bounding boxes; the signs of rounded differences are exact. One comparison per stage, since an
    # unpredictable branch costs more than additions.
    x0, y0, z0, x1, y1, z1 = blx - ahx, bly - ahy, blz - ahz, alx - bhx, aly - bhy, alz - bhz
    if max2(max3(x0, y0, z0), max3(x1, y1, z1)) > 0.0:
        return False
    reach = (x0 + x1) + (y0 + y1) + (z0 + z1)  # minus the sum of both boxes' sizes: no difference is larger than that
    bound = UNDERFLOW_ERROR - ERROR_FACTOR * (reach * reach * reach)

    # Relative to a0: a's edges u and v, b's corners p, q, r, and the sides t of a's plane on which these lie.
    ux, uy, uz = ax1 - ax0, ay1 - ay0, az1 - az0
    vx, vy, vz = ax2 - ax0, ay2 - ay0, az2 - az0
    px, py, pz = bx0 - ax0, by0 - ay0, bz0 - az0
    qx, qy, qz = bx1 - ax0, by1 - ay0, bz1 - az0
    rx, ry, rz = bx2 - ax0, by2 - ay0, bz2 - az0
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    t0 = nx * px + ny * py + nz * pz
    t1 = nx * qx + ny * qy + nz * qz
    t2 = nx * rx + ny * ry + nz * rz
    if max2(min3(t0, t1, t2), -max3(t0, t1, t2)) > bound:
        return False
    # The moments of b's edges about a0 (Pluecker coordinates). Their products with u and v give the side on which edge
    # a0a1 (d) and edge a2a0 (f) pass each of b's edges; their sum is b's normal, so the sides s of a's corners follow.
    kx, ky, kz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
    lx, ly, lz = qy * rz - qz * ry, qz * rx - qx * rz, qx * ry - qy * rx
    mx, my, mz = ry * pz - rz * py, rz * px - rx * pz, rx * py - ry * px
    d0, d1, d2 = ux * kx + uy * ky + uz * kz, ux * lx + uy * ly + uz * lz, ux * mx + uy * my + uz * mz
    f0, f1, f2 = -(vx * kx + vy * ky + vz * kz), -(vx * lx + vy * ly + vz * lz), -(vx * mx + vy * my + vz * mz)
    s0 = -(px * lx + py * ly + pz * lz)
    s1, s2 = s0 + (d0 + d1 + d2), s0 - (f0 + f1 + f2)
    if max2(min3(s0, s1, s2), -max3(s0, s1, s2)) > bound:
        return False

    # An edge intersects the other triangle if its ends lie on opposite sides of it and it passes the triangle's three
    # edges on one side. A number within the error bound decides nothing.
    e0, e1, e2 = (t1 - t0) - (d0 + f0), (t2 - t1) - (d1 + f1), (t0 - t2) - (d2 + f2)
    margin_b = max3(_edge_margin(s0, s1, d0, d1, d2), _edge_margin(s1, s2, e0, e1, e2),
                    _edge_margin(s2, s0, f0, f1, f2))
    margin_a = max3(_edge_margin(t0, t1, d0, e0, f0), _edge_margin(t1, t2, d1, e1, f1),
                    _edge_margin(t2, t0, d2, e2, f2))
    margin = max2(margin_a, margin_b)
    if abs(margin) > bound:
        return margin > 0.0
    return triangles_intersect_exact(a, b)


@kernel
def _edge_margin(s, t, x, y, z):
    """Positive if an edge intersects a triangle: if s and t differ in sign and x, y, z agree. Its size is the margin by
    which they do.

    s, t: sides of the edge's ends; x, y, z: sides on which the edge passes the triangle's edges; m^3 each.
    """
    apart, alike = min2(max2(s, t), -min2(s, t)), max2(min3(x, y, z), -max3(x, y, z))
    return min2(apart, alike)


@allocating
def _intersects_all(a, b, out):
    """Writes whether triangle a[i] and triangle b[i], (n, 3, 3), intersect to out (n,)."""
    for i in range(a.shape[0]):
        out[i] = triangles_intersect(triangle_at(a, i), triangle_at(b, i))


def intersects(a: Floats, b: Floats) -> Booleans:
    """Whether triangle a[i] and triangle b[i] share a point, exactly: (n,) for a and b of shape (n, 3, 3), m.

    Touching counts; a triangle may be a segment or a point. Raises ValueError for other shapes and for numbers that are
    not finite.
    """
    a, b = checked_pairs(a, b)
    out = np.empty(len(a), np.bool_)
    _intersects_all(a, b, out)
    return out


def checked_pairs(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Both as contiguous float64 arrays. Raises ValueError unless both have one shape (n, 3, 3) and finite numbers."""
    a, b = _checked_corners("a", a), _checked_corners("b", b)
    if len(a) != len(b):
        raise ValueError(f"triangle: expected as many triangles in b as in a, {len(a)}, got {len(b)}")
    return a, b


def _checked_corners(name: str, corners: Floats) -> Floats:
    """Corners as a contiguous float64 array. Raises ValueError unless they are finite and of shape (n, 3, 3)."""
    corners = np.ascontiguousarray(corners, np.float64)
    if corners.ndim != 3 or corners.shape[1:] != (3, 3):
        raise ValueError(f"triangle: {name}: expected shape (n, 3, 3), got {corners.shape}")
    # A finite sum proves that all numbers are finite; a sum that is not finite may have overflowed.
    with np.errstate(over="ignore", invalid="ignore"):
        total = corners.sum()
    if not np.isfinite(total) and not np.isfinite(corners).all():
        bad = int(np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))[0])
        raise ValueError(f"triangle: {name}[{bad}]: expected finite numbers, got {corners[bad].tolist()}")
    return corners
