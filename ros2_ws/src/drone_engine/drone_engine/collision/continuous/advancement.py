"""Conservative advancement of two boxes that move and turn: steps in time that no contact can fall into.

A direction along which two shapes lie apart bounds their distance from below, and how fast they can approach along it
is bounded too: by their velocities and by how fast their farthest points circle. So each separating axis gives a time
that is safe, and the longest is taken. Boxes that only translate are solved exactly, each axis used twice at most.
Sources: Mirtich 1996 (Impulse-based Dynamic Simulation, 2.3); Catto 2013 (Continuous Collision, GDC).
"""

import math

from drone_engine.kernel import kernel
from drone_engine.math.rotation import integrate_rotation, matrix

NONE, IMPACT, UNFINISHED = range(3)
ITERATIONS = 400  # a graze at full spin takes about 200
NEAR = 1.25  # an impact is a separation between once and this many times the target
SHIFT, VELOCITY, TURN_A, SPIN_A, TURN_B, SPIN_B, MOTION = 0, 3, 6, 10, 13, 17, 20  # numbers of a motion
AXES_A, AXES_B, PLACE = 3, 12, 21  # numbers of a place


@kernel
def relative(position, orientation, velocity, spin, a, b, motion):
    """Writes how body b moves as seen from the position of a, axes of the world: where it starts and its velocity,
    then the orientation and angular velocity of a, and those of b; 20 numbers."""
    for k in range(3):
        motion[SHIFT + k] = position[b, k] - position[a, k]
        motion[VELOCITY + k] = velocity[b, k] - velocity[a, k]
        motion[SPIN_A + k], motion[SPIN_B + k] = spin[a, k], spin[b, k]
    for k in range(4):
        motion[TURN_A + k], motion[TURN_B + k] = orientation[a, k], orientation[b, k]


@kernel
def place_at(motion, t, place):
    """Writes where b is from a after t s, and the axes of both, one a row: 21 numbers."""
    for k in range(3):
        place[k] = motion[SHIFT + k] + motion[VELOCITY + k] * t
    for body in range(2):
        q, w = (TURN_A, SPIN_A) if body == 0 else (TURN_B, SPIN_B)
        x, y, z, s = motion[q], motion[q + 1], motion[q + 2], motion[q + 3]
        if motion[w] != 0.0 or motion[w + 1] != 0.0 or motion[w + 2] != 0.0:
            x, y, z, s = integrate_rotation(x, y, z, s, motion[w], motion[w + 1], motion[w + 2], t)
        m = matrix(x, y, z, s)
        row = AXES_A if body == 0 else AXES_B
        for k in range(3):
            place[row + 3 * k], place[row + 3 * k + 1], place[row + 3 * k + 2] = m[k], m[3 + k], m[6 + k]


@kernel
def along(v, i, x, y, z):
    """The dot product of the numbers i to i + 2 of v with (x, y, z)."""
    return v[i] * x + v[i + 1] * y + v[i + 2] * z


@kernel
def middle(place, row, box, x, y, z):
    """How far a box's middle lies from its body's position along (x, y, z)."""
    return (box[0] * along(place, row, x, y, z) + box[1] * along(place, row + 3, x, y, z)
            + box[2] * along(place, row + 6, x, y, z))


@kernel
def reach(place, row, box, x, y, z):
    """How far a box reaches from its middle along (x, y, z)."""
    return (box[3] * abs(along(place, row, x, y, z)) + box[4] * abs(along(place, row + 3, x, y, z))
            + box[5] * abs(along(place, row + 6, x, y, z)))


@kernel
def orbit(motion, place, row, spin, box):
    """Of a box that circles the axis through its body's position: angular speed, the distance of its farthest point
    from the axis, the place of its middle on the axis, and how far it reaches along the axis from there."""
    wx, wy, wz = motion[spin], motion[spin + 1], motion[spin + 2]
    speed = math.sqrt(wx * wx + wy * wy + wz * wz)
    if speed == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    x, y, z = wx / speed, wy / speed, wz / speed
    centre = middle(place, row, box, x, y, z)
    a, b, c = (box[3] * along(place, row, x, y, z), box[4] * along(place, row + 3, x, y, z),
               box[5] * along(place, row + 6, x, y, z))
    least = min(abs(a + b + c), abs(a + b - c), abs(a - b + c), abs(a - b - c))
    square = box[3] * box[3] + box[4] * box[4] + box[5] * box[5] - least * least
    off = box[0] * box[0] + box[1] * box[1] + box[2] * box[2] - centre * centre
    return speed, math.sqrt(max(square, 0.0)) + math.sqrt(max(off, 0.0)), centre, abs(a) + abs(b) + abs(c)


@kernel
def swing(motion, spin, circle, x, y, z, support):
    """How fast, and how far at most, a circling box can reach beyond `support` along the unit vector (x, y, z)."""
    speed, radius, centre, extent = circle
    if speed == 0.0:
        return 0.0, 0.0
    cosine = min(max(along(motion, spin, x, y, z) / speed, -1.0), 1.0)
    sine = math.sqrt(1.0 - cosine * cosine)
    return speed * radius * sine, max(centre * cosine + extent * abs(cosine) + radius * sine - support, 0.0)


@kernel
def _ratio(room, speed):
    if room < 0.0:
        return 0.0
    return room / speed if speed > 0.0 else math.inf


@kernel
def safe_time(room, approach, swing_a, swing_b):
    """How long two shapes with this room between them along some direction need at least to use it up, s.

    approach: m/s, of their positions. swing: (m/s, m) of each, how fast and how far it can come on top of that.
    """
    fast_a, far_a = swing_a
    fast_b, far_b = swing_b
    best = _ratio(room, approach + fast_a + fast_b)
    if fast_a > 0.0 or fast_b > 0.0:
        best = max(best, _ratio(room - far_a, approach + fast_b), _ratio(room - far_b, approach + fast_a),
                   _ratio(room - far_a - far_b, approach))
    return best


@kernel
def direction(place, k):
    """The k-th of the 15 separating axes of two boxes, a unit vector; 0 where two edges are parallel."""
    if k < 6:
        i = AXES_A + 3 * k
        return place[i], place[i + 1], place[i + 2]
    i, j = AXES_A + 3 * ((k - 6) // 3), AXES_B + 3 * ((k - 6) % 3)
    x = place[i + 1] * place[j + 2] - place[i + 2] * place[j + 1]
    y = place[i + 2] * place[j] - place[i] * place[j + 2]
    z = place[i] * place[j + 1] - place[i + 1] * place[j]
    square = x * x + y * y + z * z
    if square < 1e-20:
        return 0.0, 0.0, 0.0
    scale = 1.0 / math.sqrt(square)
    return x * scale, y * scale, z * scale


@kernel
def boxes_meet(motion, place, box_a, box_b, start, end, target, iterations):
    """(t, outcome): from `start` to t s the boxes are `target` m apart or more. IMPACT: at t they are about that;
    NONE: t is `end`; UNFINISHED: later is unknown, `iterations` ran out. box: six numbers, middle and half extents in
    the body. Boxes that are closer at the start meet there.
    """
    t = start
    place_at(motion, t, place)
    circle_a = orbit(motion, place, AXES_A, SPIN_A, box_a)
    circle_b = orbit(motion, place, AXES_B, SPIN_B, box_b)
    turning = circle_a[0] > 0.0 or circle_b[0] > 0.0
    for iteration in range(iterations):
        if iteration > 0:
            if turning:
                place_at(motion, t, place)
            else:
                for k in range(3):
                    place[k] = motion[SHIFT + k] + motion[VELOCITY + k] * t
        widest, leap = -math.inf, 0.0
        for k in range(15):
            x, y, z = direction(place, k)
            if x == 0.0 and y == 0.0 and z == 0.0:
                continue
            at_a, at_b = middle(place, AXES_A, box_a, x, y, z), middle(place, AXES_B, box_b, x, y, z)
            far_a, far_b = reach(place, AXES_A, box_a, x, y, z), reach(place, AXES_B, box_b, x, y, z)
            gap = x * place[0] + y * place[1] + z * place[2] + at_b - at_a
            separation = abs(gap) - far_a - far_b
            widest = max(widest, separation)
            if separation <= target:
                continue
            if gap < 0.0:  # from a to b
                x, y, z, at_a, at_b = -x, -y, -z, -at_a, -at_b
            leap = max(leap, safe_time(separation - target, -along(motion, VELOCITY, x, y, z),
                                       swing(motion, SPIN_A, circle_a, x, y, z, at_a + far_a),
                                       swing(motion, SPIN_B, circle_b, -x, -y, -z, far_b - at_b)))
            if t + leap >= end:
                return end, NONE
        if widest <= NEAR * target:
            return t, IMPACT
        t += leap
    return t, UNFINISHED
