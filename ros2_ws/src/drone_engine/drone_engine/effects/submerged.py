"""Volume and centroid of the part of a box below a horizontal plane: exact, for any pose."""

import numpy as np

from drone_engine.kernel import kernel

# The faces of a box: corners are numbered by bits, 1 for +x, 2 for +y, 4 for +z; counter-clockwise from outside.
FACES = np.array([[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]], np.int64)
ROWS = 8 + 8  # of the scratch array: corners of the box, and corners of a clipped face
NOTHING = (0.0, 0.0, 0.0, 0.0)


@kernel
def submerged(m, half, height, scratch):
    """Volume below the plane z = height above the center of a box, m^3, and its centroid from the center, world axes.

    m: rows of the box's rotation matrix; half: (3,) m; scratch: (ROWS, 3).
    """
    up = abs(m[6]) * half[0] + abs(m[7]) * half[1] + abs(m[8]) * half[2]
    if height >= up:
        return 8.0 * half[0] * half[1] * half[2], 0.0, 0.0, 0.0
    if height <= -up:
        return NOTHING
    axis = 0
    for c in range(1, 3):
        if abs(m[6 + c]) > abs(m[6 + axis]):
            axis = c
    first, second = (axis + 1) % 3, (axis + 2) % 3
    a, b, c, steep = half[first], half[second], half[axis], m[6 + axis]
    s, t, depth = -m[6 + first] / steep, -m[6 + second] / steep, height / abs(steep) + c
    reach = abs(s) * a + abs(t) * b
    if depth < reach or depth + reach > 2.0 * c:
        return _cut_off(m, half, height, scratch)

    # The plane crosses all four edges along the steepest axis: integrate columns along it, whose depth is linear.
    side = 1.0 if steep > 0.0 else -1.0
    u, v = side * s * a * a / (3.0 * depth), side * t * b * b / (3.0 * depth)
    w = side * (0.5 * (depth * depth + (s * s * a * a + t * t * b * b) / 3.0) / depth - c)
    return (4.0 * a * b * depth, m[first] * u + m[second] * v + m[axis] * w,
            m[3 + first] * u + m[3 + second] * v + m[3 + axis] * w,
            m[6 + first] * u + m[6 + second] * v + m[6 + axis] * w)


@kernel
def _cut_off(m, half, height, scratch):
    """As `submerged`, where the plane cuts the box otherwise.

    Each face is clipped at the plane and forms pyramids whose apex is the point of the plane above the center; the cut
    face itself then has no volume.
    """
    for corner in range(8):
        x = half[0] if corner & 1 else -half[0]
        y = half[1] if corner & 2 else -half[1]
        z = half[2] if corner & 4 else -half[2]
        for c in range(3):
            scratch[corner, c] = m[3 * c] * x + m[3 * c + 1] * y + m[3 * c + 2] * z
        scratch[corner, 2] -= height
    volume = mx = my = mz = 0.0
    for face in range(6):
        end = _cut(face, scratch)
        ax, ay, az = scratch[8, 0], scratch[8, 1], scratch[8, 2]
        for k in range(9, end - 1):
            bx, by, bz = scratch[k, 0], scratch[k, 1], scratch[k, 2]
            cx, cy, cz = scratch[k + 1, 0], scratch[k + 1, 1], scratch[k + 1, 2]
            part = (ax * (by * cz - cy * bz) + ay * (bz * cx - cz * bx) + az * (bx * cy - cx * by)) / 6.0
            volume += part
            mx += 0.25 * part * (ax + bx + cx)
            my += 0.25 * part * (ay + by + cy)
            mz += 0.25 * part * (az + bz + cz)
    if volume <= 0.0:
        return NOTHING
    return volume, mx / volume, my / volume, mz / volume + height


@kernel
def _cut(face, scratch):
    """Writes the corners of a face below the plane to the scratch rows from 8 on; returns where they end."""
    end = 8
    last = FACES[face, 3]
    for k in range(4):
        corner = FACES[face, k]
        z, before = scratch[corner, 2], scratch[last, 2]
        if (z < 0.0) != (before < 0.0):
            t = before / (before - z)
            for c in range(2):
                scratch[end, c] = scratch[last, c] + t * (scratch[corner, c] - scratch[last, c])
            scratch[end, 2] = 0.0
            end += 1
        if z < 0.0:
            for c in range(3):
                scratch[end, c] = scratch[corner, c]
            end += 1
        last = corner
    return end
