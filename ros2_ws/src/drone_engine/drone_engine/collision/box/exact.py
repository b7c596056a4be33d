"""Whether a pair of boxes touches, exactly, for any axes: decides the pairs that the test by blocks leaves undecided.

For the vectors u, v of two of the six axes and the offset d of the centers, the plane that they span does not separate
the boxes if |det(u, v, d)| <= sum of half_k |det(u, v, axis_k)|. First this is tested with an error bound. If planes
remain undecided, a point that is inside both boxes is searched; failing that, exact arithmetic decides those planes.

In the kernels below, `axis` (9, 3) holds the axes of a, of b and of the world, and `half` (9,) their half extents.
"""

import math

import numpy as np

from drone_engine.collision.exact_arithmetic import add_determinant, sign
from drone_engine.kernel import kernel

ROUNDING = 2.0**-48  # 32 roundings, twice what a gap takes
TINY = 1e-290  # below this, rounding errors are not relative any more, and planes are left undecided
PROJECTIONS = 4  # alternating projections onto the two boxes, in search of a point inside both
PAIRS = np.array([(i, j) for j in range(9) for i in range(j)])  # of axes; the first 15 are of the boxes' six axes


@kernel
def boxes_touch(center_a, axes_a, half_a, center_b, axes_b, half_b, axis, half, total, probe):
    """Whether two boxes touch, exactly: 1 or 0, or -1 for numbers that are not finite and negative half extents.

    center (3,), axes (9,), one after the other, of any length and angle, half (3,). Scratch: axis (9, 3), half (9,),
    and total and probe, two accumulators that hold 0.
    """
    finite = True
    for i in range(3):
        half[i], half[3 + i], half[6 + i] = half_a[i], half_b[i], 0.0
        finite &= math.isfinite(center_a[i]) and math.isfinite(center_b[i])
        for c in range(3):
            axis[i, c], axis[3 + i, c], axis[6 + i, c] = axes_a[3 * i + c], axes_b[3 * i + c], 1.0 if i == c else 0.0
    size, ordinary = 0.0, True
    for i in range(6):
        norm = 0.0
        for c in range(3):
            finite &= math.isfinite(axis[i, c])
            norm += abs(axis[i, c])
        finite &= 0.0 <= half[i] < np.inf
        ordinary &= 1e-6 < norm < 1e6
        size += half[i] * norm
    if not finite:
        return -1
    dx, dy, dz = center_b[0] - center_a[0], center_b[1] - center_a[1], center_b[2] - center_a[2]
    size += abs(dx) + abs(dy) + abs(dz)
    ordinary &= size < 1e280  # no product comes near the ends of the exponents
    # Planes of axes that all lie in one plane do not decide whether boxes in it touch: the three axes of the world do.
    count = 15 if ordinary and (_is_solid(axis, 0) or _is_solid(axis, 3)) else 36
    undecided = 0  # a bit for each pair of axes
    for n in range(count):
        if ordinary:
            i, j = PAIRS[n, 0], PAIRS[n, 1]
            x, y, z, scale = _cross(axis, i, j)
            gap = abs(x * dx + y * dy + z * dz)
            for k in range(6):
                if k != i and k != j:
                    gap -= half[k] * abs(x * axis[k, 0] + y * axis[k, 1] + z * axis[k, 2])
            tolerance = ROUNDING * scale * size + TINY
            if gap > tolerance:
                return 0
            if gap < -tolerance:
                continue
        undecided |= 1 << n
    if undecided == 0 or (ordinary and _share_a_point(axis, half, dx, dy, dz, size)):
        return 1
    for n in range(count):
        if undecided >> n & 1 and _separates(axis, half, center_a, center_b, PAIRS[n, 0], PAIRS[n, 1], total, probe):
            return 0
    return 1


@kernel
def _cross(axis, i, j):
    """The cross product of axes i and j, and the magnitude that its rounding error is relative to."""
    x0, x1, x2, y0, y1, y2 = axis[i, 0], axis[i, 1], axis[i, 2], axis[j, 0], axis[j, 1], axis[j, 2]
    scale = (abs(x0) + abs(x1) + abs(x2)) * (abs(y0) + abs(y1) + abs(y2))
    return x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0, scale


@kernel
def _is_solid(axis, first):
    """Whether the three axes from `first` on are certainly linearly independent."""
    x, y, z, scale = _cross(axis, first, first + 1)
    u, v, w = axis[first + 2, 0], axis[first + 2, 1], axis[first + 2, 2]
    return abs(x * u + y * v + z * w) > ROUNDING * scale * (abs(u) + abs(v) + abs(w))


@kernel
def _nearest(axis, half, first, x, y, z):
    """A point near (x, y, z) in a box centered at the origin: its coordinates along the axes, clamped.

    first: 0 for box a, 3 for b.
    """
    px, py, pz = 0.0, 0.0, 0.0
    for i in range(first, first + 3):
        nx, ny, nz, _ = _cross(axis, first + (i + 1) % 3, first + (i + 2) % 3)
        along = (nx * x + ny * y + nz * z) / (nx * axis[i, 0] + ny * axis[i, 1] + nz * axis[i, 2])
        along = min(max(along, -half[i]), half[i])
        px, py, pz = px + along * axis[i, 0], py + along * axis[i, 1], pz + along * axis[i, 2]
    return px, py, pz


@kernel
def _share_a_point(axis, half, dx, dy, dz, size):
    """Whether a point of one box, found by alternating projections, is certainly inside the other.

    (dx, dy, dz): from the center of a to that of b, m; size: what rounding errors are relative to, m.
    """
    x, y, z = _nearest(axis, half, 3, -dx, -dy, -dz)
    x, y, z = x + dx, y + dy, z + dz  # the point of b next to the center of a, from there
    u, v, w = _nearest(axis, half, 0, dx, dy, dz)  # the point of a next to the center of b
    for _ in range(PROJECTIONS):
        x, y, z = _nearest(axis, half, 0, x, y, z)
        x, y, z = _nearest(axis, half, 3, x - dx, y - dy, z - dz)
        x, y, z = x + dx, y + dy, z + dz
        u, v, w = _nearest(axis, half, 3, u - dx, v - dy, w - dz)
        u, v, w = _nearest(axis, half, 0, u + dx, v + dy, w + dz)
    x, y, z = 0.5 * (x + u), 0.5 * (y + v), 0.5 * (z + w)
    # The point is projected onto the thinner box, which may be flat; it has to be inside the other one.
    if min(half[0], half[1], half[2]) <= min(half[3], half[4], half[5]):
        x, y, z = _nearest(axis, half, 0, x, y, z)
        return _is_inside(axis, half, 3, x - dx, y - dy, z - dz, size)
    x, y, z = _nearest(axis, half, 3, x - dx, y - dy, z - dz)
    return _is_inside(axis, half, 0, x + dx, y + dy, z + dz, size)


@kernel
def _is_inside(axis, half, first, x, y, z, size):
    """Whether a point, known up to a few roundings of `size`, is certainly inside a box centered at the origin."""
    for i in range(first, first + 3):
        nx, ny, nz, scale = _cross(axis, first + (i + 1) % 3, first + (i + 2) % 3)
        room = half[i] * abs(nx * axis[i, 0] + ny * axis[i, 1] + nz * axis[i, 2]) - abs(nx * x + ny * y + nz * z)
        if not room > ROUNDING * scale * size + TINY:
            return False
    return True


@kernel
def _separates(axis, half, center_a, center_b, i, j, total, probe):
    """Whether the plane that axes i and j span separates the boxes, exactly."""
    ux, uy, uz, vx, vy, vz = axis[i, 0], axis[i, 1], axis[i, 2], axis[j, 0], axis[j, 1], axis[j, 2]
    add_determinant(probe, 1, 1.0, ux, uy, uz, vx, vy, vz, center_b[0], center_b[1], center_b[2])
    add_determinant(probe, -1, 1.0, ux, uy, uz, vx, vy, vz, center_a[0], center_a[1], center_a[2])
    side = sign(probe)
    if side == 0:
        return False
    add_determinant(total, side, 1.0, ux, uy, uz, vx, vy, vz, center_b[0], center_b[1], center_b[2])
    add_determinant(total, -side, 1.0, ux, uy, uz, vx, vy, vz, center_a[0], center_a[1], center_a[2])
    for k in range(6):
        if k != i and k != j and half[k] != 0.0:
            add_determinant(probe, 1, 1.0, ux, uy, uz, vx, vy, vz, axis[k, 0], axis[k, 1], axis[k, 2])
            side = sign(probe)
            if side != 0:
                add_determinant(total, -side, half[k], ux, uy, uz, vx, vy, vz, axis[k, 0], axis[k, 1], axis[k, 2])
    return sign(total) > 0
