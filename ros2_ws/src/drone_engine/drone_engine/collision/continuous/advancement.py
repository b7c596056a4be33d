"""Conservative advancement of two boxes that translate and rotate: time steps within which no contact can occur.

The separation of two shapes along a direction is a lower bound of their distance, and the speed at which they can
approach along it has an upper bound, from their velocities and the speeds of their farthest points on circles about the
axes of rotation. Each separating axis therefore gives a safe time, and the longest one is taken. For boxes that only
translate the result is exact, and each axis is used at most twice.
Sources: Mirtich 1996 (Impulse-based Dynamic Simulation, 2.3); Catto 2013 (Continuous Collision, GDC).

Arrays: motion (MOTION_SIZE,), the relative motion of a pair, and poses (POSES_SIZE,), its poses at one time, hold
numbers from the offsets below on; world axes, origin at the position of body a, SI units. box (6,): center and half
extents in the body's frame.
"""

import math

from drone_engine.kernel import kernel
from drone_engine.math.rotation import integrate_rotation, matrix

NO_IMPACT, IMPACT, UNFINISHED = range(3)  # outcomes
MAX_ITERATIONS = 400  # a grazing contact of fast rotating bodies takes about 200
IMPACT_TOLERANCE = 1.25  # an impact is a separation between one and this many times the target
PARALLEL_EDGES_SIN2 = 1e-20  # squared sine between two edges below which they give no separating axis
OFFSET, VELOCITY, ORIENTATION_A, ANGULAR_VELOCITY_A, ORIENTATION_B, ANGULAR_VELOCITY_B, MOTION_SIZE = (
    0, 3, 6, 10, 13, 17, 20)  # in a motion
AXES_A, AXES_B, POSES_SIZE = 3, 12, 21  # in poses; the offset of b is first


@kernel
def relative_motion(position, orientation, velocity, angular_velocity, a, b, motion):
    """Writes the motion of bodies a and b relative to the position of a, in world axes, to motion (MOTION_SIZE,).

    position, velocity, angular_velocity: (n, 3); orientation: (n, 4) x y z w; world frame. motion: position and
    velocity of b relative to a, orientation and angular velocity of a, those of b.
    """
    for k in range(3):
        motion[OFFSET + k] = position[b, k] - position[a, k]
        motion[VELOCITY + k] = velocity[b, k] - velocity[a, k]
        motion[ANGULAR_VELOCITY_A + k] = angular_velocity[a, k]
        motion[ANGULAR_VELOCITY_B + k] = angular_velocity[b, k]
    for k in range(4):
        motion[ORIENTATION_A + k], motion[ORIENTATION_B + k] = orientation[a, k], orientation[b, k]


@kernel
def poses_at(motion, t, poses):
    """Writes the poses after t s to poses (POSES_SIZE,): the offset of b from a, then the axes of a and of b in the
    world, one per row."""
    for k in range(3):
        poses[k] = motion[OFFSET + k] + motion[VELOCITY + k] * t
    for body in range(2):
        q, w = (ORIENTATION_A, ANGULAR_VELOCITY_A) if body == 0 else (ORIENTATION_B, ANGULAR_VELOCITY_B)
        x, y, z, s = motion[q], motion[q + 1], motion[q + 2], motion[q + 3]
        if motion[w] != 0.0 or motion[w + 1] != 0.0 or motion[w + 2] != 0.0:
            x, y, z, s = integrate_rotation(x, y, z, s, motion[w], motion[w + 1], motion[w + 2], t)
        m = matrix(x, y, z, s)
        row = AXES_A if body == 0 else AXES_B
        for k in range(3):
            poses[row + 3 * k], poses[row + 3 * k + 1], poses[row + 3 * k + 2] = m[k], m[3 + k], m[6 + k]


@kernel
def dot_at(v, i, x, y, z):
    """The dot product of numbers i to i + 2 of v with (x, y, z)."""
    return v[i] * x + v[i + 1] * y + v[i + 2] * z


@kernel
def center_along(poses, row, box, x, y, z):
    """The coordinate along (x, y, z) of a box's center, from its body's position, m; row: AXES_A or AXES_B."""
    return (box[0] * dot_at(poses, row, x, y, z) + box[1] * dot_at(poses, row + 3, x, y, z)
            + box[2] * dot_at(poses, row + 6, x, y, z))


@kernel
def half_extent_along(poses, row, box, x, y, z):
    """Half the extent of a box along the unit vector (x, y, z), m; row: AXES_A or AXES_B."""
    return (box[3] * abs(dot_at(poses, row, x, y, z)) + box[4] * abs(dot_at(poses, row + 3, x, y, z))
            + box[5] * abs(dot_at(poses, row + 6, x, y, z)))


@kernel
def box_circle(motion, poses, row, rate, box):
    """The cylinder that contains a box which rotates about the axis through its body's position.

    Returns (angular speed, rad/s; radius; coordinate of the center along the axis; half length along the axis, m), all
    0 if the body does not rotate. row: AXES_A or AXES_B, rate: ANGULAR_VELOCITY_A or ANGULAR_VELOCITY_B.
    """
    wx, wy, wz = motion[rate], motion[rate + 1], motion[rate + 2]
    speed = math.sqrt(wx * wx + wy * wy + wz * wz)
    if speed == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    x, y, z = wx / speed, wy / speed, wz / speed
    center = center_along(poses, row, box, x, y, z)
    a, b, c = (box[3] * dot_at(poses, row, x, y, z), box[4] * dot_at(poses, row + 3, x, y, z),
               box[5] * dot_at(poses, row + 6, x, y, z))
    least = min(abs(a + b + c), abs(a + b - c), abs(a - b + c), abs(a - b - c))
    square = box[3] * box[3] + box[4] * box[4] + box[5] * box[5] - least * least
    off = box[0] * box[0] + box[1] * box[1] + box[2] * box[2] - center * center
    return speed, math.sqrt(max(square, 0.0)) + math.sqrt(max(off, 0.0)), center, abs(a) + abs(b) + abs(c)


@kernel
def rotation_reach(motion, rate, circle, x, y, z, support):
    """Upper bounds of the speed (m/s) at which and the distance (m) by which rotation can carry a shape beyond
    `support`, its present largest coordinate along the unit vector (x, y, z).

    circle: from `box_circle` or `triangle_circle`; rate: ANGULAR_VELOCITY_A or ANGULAR_VELOCITY_B.
    """
    speed, radius, center, extent = circle
    if speed == 0.0:
        return 0.0, 0.0
    cosine = min(max(dot_at(motion, rate, x, y, z) / speed, -1.0), 1.0)
    sine = math.sqrt(1.0 - cosine * cosine)
    return speed * radius * sine, max(center * cosine + extent * abs(cosine) + radius * sine - support, 0.0)


@kernel
def _travel_time(room, speed):
    """The time in which a distance is covered at a speed, s: 0 for a negative distance, inf without speed."""
    if room < 0.0:
        return 0.0
    return room / speed if speed > 0.0 else math.inf


@kernel
def _safe_time(room, approach, reach_a, reach_b):
    """The time within which two shapes cannot close a gap of `room` m along some direction, s.

    approach: m/s, speed at which the bodies' positions approach along it. reach_a, reach_b: from `rotation_reach`, what
    rotation adds.
    """
    speed_a, far_a = reach_a
    speed_b, far_b = reach_b
    best = _travel_time(room, approach + speed_a + speed_b)
    if speed_a > 0.0 or speed_b > 0.0:
        best = max(best, _travel_time(room - far_a, approach + speed_b), _travel_time(room - far_b, approach + speed_a),
                   _travel_time(room - far_a - far_b, approach))
    return best


@kernel
def axis_safe_time(motion, x, y, z, room, circle_a, circle_b, support_a, support_b):
    """The time within which two shapes cannot close a gap of `room` m along the unit vector (x, y, z) from a to b, s.

    circle_a, circle_b: from `box_circle` or `triangle_circle`. support_a: the largest coordinate of a along the vector,
    support_b: that of b along the opposite one; from the bodies' positions, m.
    """
    return _safe_time(room, -dot_at(motion, VELOCITY, x, y, z),
                     rotation_reach(motion, ANGULAR_VELOCITY_A, circle_a, x, y, z, support_a),
                     rotation_reach(motion, ANGULAR_VELOCITY_B, circle_b, -x, -y, -z, support_b))


@kernel
def separating_axis(poses, k):
    """Candidate k of the 15 separating axes of two boxes, a unit vector: 3 face normals of a, 3 of b, 9 products of
    edges; 0 where two edges are parallel."""
    if k < 6:
        i = AXES_A + 3 * k
        return poses[i], poses[i + 1], poses[i + 2]
    i, j = AXES_A + 3 * ((k - 6) // 3), AXES_B + 3 * ((k - 6) % 3)
    x = poses[i + 1] * poses[j + 2] - poses[i + 2] * poses[j + 1]
    y = poses[i + 2] * poses[j] - poses[i] * poses[j + 2]
    z = poses[i] * poses[j + 1] - poses[i + 1] * poses[j]
    square = x * x + y * y + z * z
    if square < PARALLEL_EDGES_SIN2:
        return 0.0, 0.0, 0.0
    scale = 1.0 / math.sqrt(square)
    return x * scale, y * scale, z * scale


@kernel
def box_time_of_impact(motion, poses, box_a, box_b, start, end, target, iterations):
    """The time of impact of two boxes, (t, outcome): between `start` and t s they are at least `target` m apart.

    IMPACT: at t they are `target` to IMPACT_TOLERANCE * target apart, or closer if t is `start`. NO_IMPACT: t is `end`.
    UNFINISHED: `iterations` were not enough, nothing is known after t. poses: (POSES_SIZE,) scratch.
    """
    t = start
    poses_at(motion, t, poses)
    circle_a = box_circle(motion, poses, AXES_A, ANGULAR_VELOCITY_A, box_a)
    circle_b = box_circle(motion, poses, AXES_B, ANGULAR_VELOCITY_B, box_b)
    turning = circle_a[0] > 0.0 or circle_b[0] > 0.0
    for iteration in range(iterations):
        if iteration > 0:
            if turning:
                poses_at(motion, t, poses)
            else:
                for k in range(3):
                    poses[k] = motion[OFFSET + k] + motion[VELOCITY + k] * t
        largest, advance = -math.inf, 0.0
        for k in range(15):
            x, y, z = separating_axis(poses, k)
            if x == 0.0 and y == 0.0 and z == 0.0:
                continue
            at_a, at_b = center_along(poses, AXES_A, box_a, x, y, z), center_along(poses, AXES_B, box_b, x, y, z)
            far_a = half_extent_along(poses, AXES_A, box_a, x, y, z)
            far_b = half_extent_along(poses, AXES_B, box_b, x, y, z)
            distance = x * poses[0] + y * poses[1] + z * poses[2] + at_b - at_a
            separation = abs(distance) - far_a - far_b
            largest = max(largest, separation)
            if separation <= target:
                continue
            if distance < 0.0:  # so that the axis points from a to b
                x, y, z, at_a, at_b = -x, -y, -z, -at_a, -at_b
            advance = max(advance, axis_safe_time(motion, x, y, z, separation - target, circle_a, circle_b,
                                                  at_a + far_a, far_b - at_b))
            if t + advance >= end:
                return end, NO_IMPACT
        if largest <= IMPACT_TOLERANCE * target:
            return t, IMPACT
        t += advance
    return t, UNFINISHED
