"""Conservative advancement of two triangles that move and turn with their bodies; as `advancement` does boxes.

The closest points of two triangles that are apart lie on two edges, or on a corner and a face. So the distance is
reached along the line between the closest two edges, or along one of the normals: three directions are enough.
"""

import math

from drone_engine.collision.continuous.advancement import (
    AXES_A,
    AXES_B,
    IMPACT,
    NEAR,
    NONE,
    SPIN_A,
    SPIN_B,
    UNFINISHED,
    VELOCITY,
    along,
    place_at,
    safe_time,
    swing,
)
from drone_engine.kernel import kernel


@kernel
def put(place, row, corners, world):
    """Writes corners (3, 3) of a body in the axes of the world, from the body's position."""
    for i in range(3):
        for k in range(3):
            world[i, k] = (corners[i, 0] * place[row + k] + corners[i, 1] * place[row + 3 + k]
                           + corners[i, 2] * place[row + 6 + k])


@kernel
def extent(world, x, y, z):
    """The least and the largest coordinate of a triangle along (x, y, z)."""
    a = along(world[0], 0, x, y, z)
    b = along(world[1], 0, x, y, z)
    c = along(world[2], 0, x, y, z)
    return min(a, b, c), max(a, b, c)


@kernel
def circle_of(motion, spin, world):
    """What `swing` needs of a triangle that circles the axis through its body's position; as advancement.orbit."""
    wx, wy, wz = motion[spin], motion[spin + 1], motion[spin + 2]
    speed = math.sqrt(wx * wx + wy * wy + wz * wz)
    if speed == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    x, y, z = wx / speed, wy / speed, wz / speed
    low, high = extent(world, x, y, z)
    square = 0.0
    for i in range(3):
        px, py, pz = world[i, 0], world[i, 1], world[i, 2]
        cx, cy, cz = py * z - pz * y, pz * x - px * z, px * y - py * x
        square = max(square, cx * cx + cy * cy + cz * cz)
    return speed, math.sqrt(square), 0.5 * (low + high), 0.5 * (high - low)


@kernel
def between_edges(place, a, i, b, j):
    """The vector between the closest points of edge i of a and edge j of b (Ericson 2005, Real-Time Collision
    Detection, 5.1.9)."""
    i1, j1 = (i + 1) % 3, (j + 1) % 3
    ux, uy, uz = a[i1, 0] - a[i, 0], a[i1, 1] - a[i, 1], a[i1, 2] - a[i, 2]
    vx, vy, vz = b[j1, 0] - b[j, 0], b[j1, 1] - b[j, 1], b[j1, 2] - b[j, 2]
    wx, wy, wz = place[0] + b[j, 0] - a[i, 0], place[1] + b[j, 1] - a[i, 1], place[2] + b[j, 2] - a[i, 2]
    uu, vv, uv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, ux * vx + uy * vy + uz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    square = uu * vv - uv * uv
    s = min(max((uw * vv - uv * vw) / square, 0.0), 1.0) if square > 0.0 else 0.0
    t = (s * uv - vw) / vv if vv > 0.0 else 0.0
    if t < 0.0 or t > 1.0 or vv == 0.0:
        t = min(max(t, 0.0), 1.0)
        s = min(max((uw + t * uv) / uu, 0.0), 1.0) if uu > 0.0 else 0.0
    return wx + t * vx - s * ux, wy + t * vy - s * uy, wz + t * vz - s * uz


@kernel
def between(place, a, b):
    """The shortest of the vectors between edges of a and of b."""
    nearest, nx, ny, nz = math.inf, 0.0, 0.0, 0.0
    for i in range(3):
        for j in range(3):
            x, y, z = between_edges(place, a, i, b, j)
            square = x * x + y * y + z * z
            if square < nearest:
                nearest, nx, ny, nz = square, x, y, z
    return nx, ny, nz


@kernel
def normal(world):
    """Square to a triangle, of any length."""
    ux, uy, uz = world[1, 0] - world[0, 0], world[1, 1] - world[0, 1], world[1, 2] - world[0, 2]
    vx, vy, vz = world[2, 0] - world[0, 0], world[2, 1] - world[0, 1], world[2, 2] - world[0, 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@kernel
def triangles_meet(motion, place, corners_a, corners_b, start, end, target, iterations, world):
    """As advancement.boxes_meet; corners: (3, 3) in the bodies; world: (2, 3, 3) to work in."""
    t = start
    a, b = world[0], world[1]
    for iteration in range(iterations):
        place_at(motion, t, place)
        put(place, AXES_A, corners_a, a)
        put(place, AXES_B, corners_b, b)
        if iteration == 0:
            circle_a, circle_b = circle_of(motion, SPIN_A, a), circle_of(motion, SPIN_B, b)
        widest, leap = 0.0, 0.0
        for k in range(3):
            x, y, z = normal(world[k]) if k < 2 else between(place, a, b)  # this one costs the most
            length = math.sqrt(x * x + y * y + z * z)
            if not length > 0.0:
                continue
            x, y, z = x / length, y / length, z / length
            low_a, high_a = extent(a, x, y, z)
            low_b, high_b = extent(b, x, y, z)
            shift = x * place[0] + y * place[1] + z * place[2]
            separation = shift + low_b - high_a
            if low_a - shift - high_b > separation:  # b is on the other side
                separation = low_a - shift - high_b
                x, y, z, high_a, low_b = -x, -y, -z, -low_a, -high_b
            widest = max(widest, separation)
            if separation > target:
                leap = max(leap, safe_time(separation - target, -along(motion, VELOCITY, x, y, z),
                                           swing(motion, SPIN_A, circle_a, x, y, z, high_a),
                                           swing(motion, SPIN_B, circle_b, -x, -y, -z, -low_b)))
            if t + leap >= end:
                return end, NONE
        if widest <= NEAR * target:
            return t, IMPACT
        t += leap
    return t, UNFINISHED
