"""One pair of any boxes, exactly: what the block-wise test of the box level leaves open.

For the vectors u, v of two of the six axes and the offset d of the centres, the plane that they span does not separate
the boxes if |det(u, v, d)| <= sum of half_k |det(u, v, axis_k)|. This is decided with an error bound; where that leaves
planes open, a point that is in both boxes is looked for; then exact arithmetic decides for the planes still open.
"""

import math

import numpy as np

from drone_engine.collision import exact_arithmetic as exact
from drone_engine.kernel import kernel

ROUNDING = 2.0**-48  # 32 roundings, twice what a gap takes
TINY = 1e-290  # below this, rounding is no longer relative: all is left open
STEPS = 4  # to and fro between two boxes, for a point of both
PAIRS = np.array([(i, j) for j in range(9) for i in range(j)])  # of axes; the first 15 are of the six of the boxes


@kernel
def touch(center_a, axes_a, half_a, center_b, axes_b, half_b, axis, half, total, probe):
    """The exact answer for a pair of any boxes, 0 or 1, or -1 for numbers that no box has.

    Flat arrays of 3 and 9; after half_b scratch: (9, 3), (9,) and two accumulators."""
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
    # Axes in one plane leave it open whether the boxes touch in it: with three more of no extent nothing is left open.
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
        if undecided >> n & 1 and _apart(axis, half, center_a, center_b, PAIRS[n, 0], PAIRS[n, 1], total, probe):
            return 0
    return 1


@kernel
def _cross(axis, i, j):
    """The cross product of two axes, and what its rounding errors are relative to."""
    x0, x1, x2, y0, y1, y2 = axis[i, 0], axis[i, 1], axis[i, 2], axis[j, 0], axis[j, 1], axis[j, 2]
    scale = (abs(x0) + abs(x1) + abs(x2)) * (abs(y0) + abs(y1) + abs(y2))
    return x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0, scale


@kernel
def _is_solid(axis, first):
    """Whether the three axes from the first on are independent beyond doubt."""
    x, y, z, scale = _cross(axis, first, first + 1)
    u, v, w = axis[first + 2, 0], axis[first + 2, 1], axis[first + 2, 2]
    return abs(x * u + y * v + z * w) > ROUNDING * scale * (abs(u) + abs(v) + abs(w))


@kernel
def _nearest(axis, half, first, x, y, z):
    """A point of the box at the origin near (x, y, z): its coordinates along the axes, cut at the half extents."""
    px, py, pz = 0.0, 0.0, 0.0
    for i in range(first, first + 3):
        nx, ny, nz, _ = _cross(axis, first + (i + 1) % 3, first + (i + 2) % 3)
        along = (nx * x + ny * y + nz * z) / (nx * axis[i, 0] + ny * axis[i, 1] + nz * axis[i, 2])
        along = min(max(along, -half[i]), half[i])
        px, py, pz = px + along * axis[i, 0], py + along * axis[i, 1], pz + along * axis[i, 2]
    return px, py, pz


@kernel
def _share_a_point(axis, half, dx, dy, dz, size):
    """Whether a point of one box, found by going to and fro between the two, is inside the other beyond doubt."""
    x, y, z = _nearest(axis, half, 3, -dx, -dy, -dz)
    x, y, z = x + dx, y + dy, z + dz  # from a's centre: b's point next to it
    u, v, w = _nearest(axis, half, 0, dx, dy, dz)  # a's point next to b's centre
    for _ in range(STEPS):
        x, y, z = _nearest(axis, half, 0, x, y, z)
        x, y, z = _nearest(axis, half, 3, x - dx, y - dy, z - dz)
        x, y, z = x + dx, y + dy, z + dz
        u, v, w = _nearest(axis, half, 3, u - dx, v - dy, w - dz)
        u, v, w = _nearest(axis, half, 0, u + dx, v + dy, w + dz)
    x, y, z = 0.5 * (x + u), 0.5 * (y + v), 0.5 * (z + w)
    # Of the thinner box, which may be a plate, the point is one by its coordinates; it has to be inside the other.
    if min(half[0], half[1], half[2]) <= min(half[3], half[4], half[5]):
        x, y, z = _nearest(axis, half, 0, x, y, z)
        return _is_inside(axis, half, 3, x - dx, y - dy, z - dz, size)
    x, y, z = _nearest(axis, half, 3, x - dx, y - dy, z - dz)
    return _is_inside(axis, half, 0, x + dx, y + dy, z + dz, size)


@kernel
def _is_inside(axis, half, first, x, y, z, size):
    """Whether a point, known up to a few roundings of `size`, is inside the box at the origin beyond doubt."""
    for i in range(first, first + 3):
        nx, ny, nz, scale = _cross(axis, first + (i + 1) % 3, first + (i + 2) % 3)
        room = half[i] * abs(nx * axis[i, 0] + ny * axis[i, 1] + nz * axis[i, 2]) - abs(nx * x + ny * y + nz * z)
        if not room > ROUNDING * scale * size + TINY:
            return False
    return True


@kernel
def _apart(axis, half, center_a, center_b, i, j, total, probe):
    """Whether the plane that axes i and j span separates the boxes, exactly."""
    ux, uy, uz, vx, vy, vz = axis[i, 0], axis[i, 1], axis[i, 2], axis[j, 0], axis[j, 1], axis[j, 2]
    exact.add_det(probe, 1, 1.0, ux, uy, uz, vx, vy, vz, center_b[0], center_b[1], center_b[2])
    exact.add_det(probe, -1, 1.0, ux, uy, uz, vx, vy, vz, center_a[0], center_a[1], center_a[2])
    side = exact.sign(probe)
    if side == 0:
        return False
    exact.add_det(total, side, 1.0, ux, uy, uz, vx, vy, vz, center_b[0], center_b[1], center_b[2])
    exact.add_det(total, -side, 1.0, ux, uy, uz, vx, vy, vz, center_a[0], center_a[1], center_a[2])
    for k in range(6):
        if k != i and k != j and half[k] != 0.0:
            exact.add_det(probe, 1, 1.0, ux, uy, uz, vx, vy, vz, axis[k, 0], axis[k, 1], axis[k, 2])
            side = exact.sign(probe)
            if side != 0:
                exact.add_det(total, -side, half[k], ux, uy, uz, vx, vy, vz, axis[k, 0], axis[k, 1], axis[k, 2])
    return exact.sign(total) > 0
