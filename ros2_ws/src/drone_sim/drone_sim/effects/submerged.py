"""How much of a box is under a horizontal plane, and where that part's centroid is: exact, for any pose."""

import numpy as np

from drone_sim.kernel import kernel

# The faces of a box: corners are numbered by bits, 1 for +x, 2 for +y, 4 for +z; counter-clockwise from outside.
FACES = np.array([[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]], np.int64)
MOST = 8  # corners of a face that a plane has cut, and then some


@kernel
def submerged(m, half, height, polygon):
    """Volume below the plane z = height over the centre of a box, m^3, and its centroid from the centre, world axes.

    m: rows of the box's rotation matrix; half: (3,); polygon: (MOST, 3), scratch. Each face is cut at the plane, and
    makes pyramids with the point of the plane above the centre as their apex; what the plane itself cuts off the box
    makes one without volume.
    """
    hx, hy, hz = half[0], half[1], half[2]
    up = abs(m[6]) * hx + abs(m[7]) * hy + abs(m[8]) * hz
    if height >= up:
        return 8.0 * hx * hy * hz, 0.0, 0.0, 0.0
    volume = mx = my = mz = 0.0
    if height > -up:
        for face in range(6):
            count = _cut(m, hx, hy, hz, face, height, polygon)
            for k in range(1, count - 1):
                a, b, c = polygon[0], polygon[k], polygon[k + 1]
                part = (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
                        + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6.0
                volume += part
                mx += 0.25 * part * (a[0] + b[0] + c[0])
                my += 0.25 * part * (a[1] + b[1] + c[1])
                mz += 0.25 * part * (a[2] + b[2] + c[2])
    if volume <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    return volume, mx / volume, my / volume, mz / volume + height


@kernel
def _cut(m, hx, hy, hz, face, height, polygon):
    """Writes the corners of a face below the plane, as seen from the apex; returns how many."""
    count = 0
    lx, ly, lz = _corner(m, hx, hy, hz, FACES[face, 3], height)
    for k in range(4):
        x, y, z = _corner(m, hx, hy, hz, FACES[face, k], height)
        if (z < 0.0) != (lz < 0.0):
            t = lz / (lz - z)
            polygon[count, 0], polygon[count, 1], polygon[count, 2] = lx + t * (x - lx), ly + t * (y - ly), 0.0
            count += 1
        if z < 0.0:
            polygon[count, 0], polygon[count, 1], polygon[count, 2] = x, y, z
            count += 1
        lx, ly, lz = x, y, z
    return count


@kernel
def _corner(m, hx, hy, hz, bits, height):
    """A corner of the box from the apex."""
    x = hx if bits & 1 else -hx
    y = hy if bits & 2 else -hy
    z = hz if bits & 4 else -hz
    return (m[0] * x + m[1] * y + m[2] * z, m[3] * x + m[4] * y + m[5] * z,
            m[6] * x + m[7] * y + m[8] * z - height)
