"""Conservative advancement of two triangles that translate and rotate with their bodies; see `advancement` for boxes.

The closest points of two disjoint triangles lie on two edges, or on a corner and a face. The direction of the distance
is therefore that between the closest two edges or one of the normals: three directions are enough.

motion, poses: as in `advancement`. Triangles (3, 3): a corner per row, m.
"""

import math

from drone_engine.collision.continuous.advancement import (
    ANGULAR_VELOCITY_A,
    ANGULAR_VELOCITY_B,
    AXES_A,
    AXES_B,
    IMPACT,
    IMPACT_TOLERANCE,
    NO_IMPACT,
    UNFINISHED,
    axis_safe_time,
    dot_at,
    poses_at,
)
from drone_engine.collision.triangle.geometry import triangle_normal
from drone_engine.kernel import kernel


@kernel
def rotate_corners(poses, row, corners, world):
    """Writes corners (3, 3), given in a body's frame, in world axes from the body's position, to world (3, 3); row:
    AXES_A or AXES_B."""
    for i in range(3):
        for k in range(3):
            world[i, k] = (corners[i, 0] * poses[row + k] + corners[i, 1] * poses[row + 3 + k]
                           + corners[i, 2] * poses[row + 6 + k])


@kernel
def interval_along(world, x, y, z):
    """The smallest and the largest coordinate of a triangle along (x, y, z)."""
    a = dot_at(world[0], 0, x, y, z)
    b = dot_at(world[1], 0, x, y, z)
    c = dot_at(world[2], 0, x, y, z)
    return min(a, b, c), max(a, b, c)


@kernel
def triangle_circle(motion, rate, world):
    """The cylinder that contains a triangle which rotates about the axis through its body's position.

    world: (3, 3) from the body's position. Returns the same as `advancement.box_circle`; rate: ANGULAR_VELOCITY_A or
    ANGULAR_VELOCITY_B.
    """
    wx, wy, wz = motion[rate], motion[rate + 1], motion[rate + 2]
    speed = math.sqrt(wx * wx + wy * wy + wz * wz)
    if speed == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    x, y, z = wx / speed, wy / speed, wz / speed
    low, high = interval_along(world, x, y, z)
    square = 0.0
    for i in range(3):
        px, py, pz = world[i, 0], world[i, 1], world[i, 2]
        cx, cy, cz = py * z - pz * y, pz * x - px * z, px * y - py * x
        square = max(square, cx * cx + cy * cy + cz * cz)
    return speed, math.sqrt(square), 0.5 * (low + high), 0.5 * (high - low)


@kernel
def edge_edge_vector(poses, a, i, b, j):
    """The vector between the closest points of edge i of triangle a and edge j of triangle b, m (Ericson 2005,
    Real-Time Collision Detection, 5.1.9).

    a, b: (3, 3) in world axes, each from its body's position. `triangle.closest` has the same formula with other
    roundings: it takes s from cross products, which is more accurate for nearly parallel edges.
    """
    i1, j1 = (i + 1) % 3, (j + 1) % 3
    ux, uy, uz = a[i1, 0] - a[i, 0], a[i1, 1] - a[i, 1], a[i1, 2] - a[i, 2]
    vx, vy, vz = b[j1, 0] - b[j, 0], b[j1, 1] - b[j, 1], b[j1, 2] - b[j, 2]
    wx, wy, wz = poses[0] + b[j, 0] - a[i, 0], poses[1] + b[j, 1] - a[i, 1], poses[2] + b[j, 2] - a[i, 2]
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
def closest_edges_vector(poses, a, b):
    """The shortest of the nine vectors between an edge of a and an edge of b, as `edge_edge_vector`."""
    nearest, nx, ny, nz = math.inf, 0.0, 0.0, 0.0
    for i in range(3):
        for j in range(3):
            x, y, z = edge_edge_vector(poses, a, i, b, j)
            square = x * x + y * y + z * z
            if square < nearest:
                nearest, nx, ny, nz = square, x, y, z
    return nx, ny, nz


@kernel
def triangle_time_of_impact(motion, poses, corners_a, corners_b, start, end, target, iterations, world):
    """The time of impact of two triangles, (t, outcome), as `advancement.box_time_of_impact`.

    corners_a, corners_b: (3, 3) in the frames of the bodies. poses (POSES_SIZE,) and world (2, 3, 3) are scratch.
    """
    t = start
    a, b = world[0], world[1]
    for iteration in range(iterations):
        poses_at(motion, t, poses)
        rotate_corners(poses, AXES_A, corners_a, a)
        rotate_corners(poses, AXES_B, corners_b, b)
        if iteration == 0:
            circle_a = triangle_circle(motion, ANGULAR_VELOCITY_A, a)
            circle_b = triangle_circle(motion, ANGULAR_VELOCITY_B, b)
        largest, advance = 0.0, 0.0
        for k in range(3):
            # The vector between edges comes last since it costs the most.
            x, y, z = triangle_normal(world, k) if k < 2 else closest_edges_vector(poses, a, b)
            length = math.sqrt(x * x + y * y + z * z)
            if not length > 0.0:
                continue
            x, y, z = x / length, y / length, z / length
            low_a, high_a = interval_along(a, x, y, z)
            low_b, high_b = interval_along(b, x, y, z)
            shift = x * poses[0] + y * poses[1] + z * poses[2]
            separation = shift + low_b - high_a
            if low_a - shift - high_b > separation:  # b is on the other side: the axis is to point from a to b
                separation = low_a - shift - high_b
                x, y, z, high_a, low_b = -x, -y, -z, -low_a, -high_b
            largest = max(largest, separation)
            if separation > target:
                advance = max(advance, axis_safe_time(motion, x, y, z, separation - target, circle_a, circle_b,
                                                      high_a, -low_b))
            if t + advance >= end:
                return end, NO_IMPACT
        if largest <= IMPACT_TOLERANCE * target:
            return t, IMPACT
        t += advance
    return t, UNFINISHED
