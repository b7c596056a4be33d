"""One unit of contacts, lane by lane: its normal impulses by their couplings, then its friction.

The speeds of all points are worked out at once, each impulse changes those of the points after it, and the bodies get
the sum, which is what impulses one by one would do. No branches: the compiler takes a loop over lanes in one step.
"""

import math

from drone_engine.dynamics.contact_constraints import (
    ACROSS,
    ALIKE,
    ALONG,
    ANCHOR,
    CENTRE_A,
    CENTRE_B,
    COMMON,
    FRICTION,
    GAP,
    HURRY,
    IMPULSE,
    INERTIA_A,
    INERTIA_B,
    K01,
    K02,
    K03,
    K12,
    K13,
    K23,
    LANES,
    LIGHT_A,
    LIGHT_B,
    MASS,
    MASS_11,
    MASS_12,
    MASS_22,
    PUSHED_ACROSS,
    PUSHED_ALONG,
    RADIUS,
    START,
    TWIST_MASS,
    TWISTED,
    turn,
)
from drone_engine.kernel import inlined

PUSH_OUT_SPEED = 0.8  # m/s, the fastest that overlapping bodies are parted
ENOUGH = 1e-5  # m/s, the change of a speed with which a calm contact is met
L2, L3, L4, L5 = 2 * LANES, 3 * LANES, 4 * LANES, 5 * LANES
# What is gathered of the bodies of a group: velocities of a and of b, then how they moved.
VELOCITY_A, VELOCITY_B, WAY_A, WAY_B, PRESSING, UNMET = (LANES * row for row in (0, 6, 12, 19, 26, 27))
GATHERED = 28 * LANES


@inlined
def apply(t, s, k, q, px, py, pz, rx, ry, rz, u, v, w):
    """Gives both bodies the impulse q along the normal, whose sum over points times anchors is p for a and r for b, and
    u, v along the tangents and w about the normal."""
    x, y, z = t[k], t[LANES + k], t[L2 + k]
    fx = u * t[ALONG + k] + v * t[ACROSS + k]
    fy = u * t[ALONG + LANES + k] + v * t[ACROSS + LANES + k]
    fz = u * t[ALONG + L2 + k] + v * t[ACROSS + L2 + k]
    cx, cy, cz = t[CENTRE_A + k], t[CENTRE_A + LANES + k], t[CENTRE_A + L2 + k]
    ax, ay, az = turn(t, INERTIA_A, k, (py * z - pz * y) + (cy * fz - cz * fy) + w * x,
                      (pz * x - px * z) + (cz * fx - cx * fz) + w * y, (px * y - py * x) + (cx * fy - cy * fx) + w * z)
    cx, cy, cz = t[CENTRE_B + k], t[CENTRE_B + LANES + k], t[CENTRE_B + L2 + k]
    bx, by, bz = turn(t, INERTIA_B, k, (ry * z - rz * y) + (cy * fz - cz * fy) + w * x,
                      (rz * x - rx * z) + (cz * fx - cx * fz) + w * y, (rx * y - ry * x) + (cx * fy - cy * fx) + w * z)
    fx, fy, fz = fx + q * x, fy + q * y, fz + q * z
    m, n = t[LIGHT_A + k], t[LIGHT_B + k]
    s[k], s[LANES + k], s[L2 + k] = s[k] - m * fx, s[LANES + k] - m * fy, s[L2 + k] - m * fz
    s[L3 + k], s[L4 + k], s[L5 + k] = s[L3 + k] - ax, s[L4 + k] - ay, s[L5 + k] - az
    e = VELOCITY_B + k
    s[e], s[e + LANES], s[e + L2] = s[e] + n * fx, s[e + LANES] + n * fy, s[e + L2] + n * fz
    s[e + L3], s[e + L4], s[e + L5] = s[e + L3] + bx, s[e + L4] + by, s[e + L5] + bz


@inlined
def sum_of(t, at, q0, q1, q2, q3):
    return q0 * t[at] + q1 * t[at + 6 * LANES] + q2 * t[at + 12 * LANES] + q3 * t[at + 18 * LANES]


@inlined
def give(t, s, k, q0, q1, q2, q3, u, v, w):
    """Gives both bodies impulses q at the points along the normal, u, v along the tangents and w about the normal."""
    a = ANCHOR + k
    apply(t, s, k, q0 + q1 + q2 + q3,
          sum_of(t, a, q0, q1, q2, q3), sum_of(t, a + LANES, q0, q1, q2, q3), sum_of(t, a + L2, q0, q1, q2, q3),
          sum_of(t, a + L3, q0, q1, q2, q3), sum_of(t, a + L4, q0, q1, q2, q3), sum_of(t, a + L5, q0, q1, q2, q3),
          u, v, w)


@inlined
def _bias(t, k, rate, per):
    """The speed at which a point (k: its place in a row of four) shall part: a gap may close within this sub-step, and
    no faster; an overlap is pushed apart."""
    gap = t[GAP + k]
    push = max(rate * gap, -PUSH_OUT_SPEED)
    return gap * per if gap > 0.0 else push


@inlined
def _impulse(t, k, p, common, speed, bias, rate, scale, loss):
    """The impulse at a point that has had p, and `common` with all others, and parts at this speed."""
    mass = t[MASS + k]
    apart = t[GAP + k] > 0.0
    soft = mass * scale
    mass = mass if apart else soft
    mass = 0.0 if apart & (p == 0.0) & (rate == 0.0) else mass
    kept = p - loss * p
    kept = (p if apart else kept) + common
    return max(kept - mass * (speed + bias), 0.0)


@inlined
def _lacks(t, k, p, lack, rate):
    """What a point lacks in speed; nothing without springs (rate 0), when bodies have moved already, if it has not met:
    it will in the next sub-step."""
    return 1.0 if (t[GAP + k] > 0.0) & (p == 0.0) & (rate == 0.0) else lack


@inlined
def _in_common(t, k, e0, e1, e2, e3):
    """The impulse that all points of a unit get first if all of them meet: what falls flat is not turned by the order
    in which its corners are met. e: by how much they should part faster, negative."""
    m0, m1 = t[MASS + k] > 0.0, t[MASS + LANES + k] > 0.0
    m2, m3 = t[MASS + L2 + k] > 0.0, t[MASS + L3 + k] > 0.0
    all_meet = ((e0 < 0.0) | (not m0)) & ((e1 < 0.0) | (not m1)) & ((e2 < 0.0) | (not m2)) & ((e3 < 0.0) | (not m3))
    total = (e0 if m0 else 0.0) + (e1 if m1 else 0.0) + (e2 if m2 else 0.0) + (e3 if m3 else 0.0)
    return -total * t[COMMON + k] if all_meet else 0.0


@inlined
def speed_of(t, k, p, apart, ax, ay, az, bx, by, bz):
    """The speed at which point p parts; apart: that of the bodies' centres, a, b: the normal times their spins."""
    at = ANCHOR + 6 * LANES * p + k
    return (apart + (bx * t[at + L3] + by * t[at + L4] + bz * t[at + L5])
            - (ax * t[at] + ay * t[at + LANES] + az * t[at + L2]))


@inlined
def follow(t, s, k):
    """Brings the gaps to where the bodies are now: n ((R - 1) r) = r (n x v + f (v (n v) - n v^2)), with the rotation's
    axis times its sine v and f = 1 / (1 + cos)."""
    x, y, z = t[k], t[LANES + k], t[L2 + k]
    a, b = WAY_A + k, WAY_B + k
    way = x * (s[b] - s[a]) + y * (s[b + LANES] - s[a + LANES]) + z * (s[b + L2] - s[a + L2])
    u, v, w, f = s[a + L3], s[a + L4], s[a + L5], s[a + 6 * LANES]
    along, square = f * (x * u + y * v + z * w), f * (u * u + v * v + w * w)
    ax, ay, az = (y * w - z * v + u * along - x * square, z * u - x * w + v * along - y * square,
                  x * v - y * u + w * along - z * square)
    u, v, w, f = s[b + L3], s[b + L4], s[b + L5], s[b + 6 * LANES]
    along, square = f * (x * u + y * v + z * w), f * (u * u + v * v + w * w)
    bx, by, bz = (y * w - z * v + u * along - x * square, z * u - x * w + v * along - y * square,
                  x * v - y * u + w * along - z * square)
    t[GAP + k] = t[START + k] + speed_of(t, k, 0, way, ax, ay, az, bx, by, bz)
    t[GAP + LANES + k] = t[START + LANES + k] + speed_of(t, k, 1, way, ax, ay, az, bx, by, bz)
    t[GAP + L2 + k] = t[START + L2 + k] + speed_of(t, k, 2, way, ax, ay, az, bx, by, bz)
    t[GAP + L3 + k] = t[START + L3 + k] + speed_of(t, k, 3, way, ax, ay, az, bx, by, bz)


@inlined
def press(t, s, k, rate, scale, loss, per):
    """Meets the normal conditions of a unit, then those of friction."""
    hurry = t[HURRY + k]
    loss = loss * hurry
    scale = 1.0 - (1.0 - scale) * hurry
    x, y, z = t[k], t[LANES + k], t[L2 + k]
    wax, way, waz = s[L3 + k], s[L4 + k], s[L5 + k]
    e = VELOCITY_B + k
    wbx, wby, wbz = s[e + L3], s[e + L4], s[e + L5]
    dx, dy, dz = s[e] - s[k], s[e + LANES] - s[LANES + k], s[e + L2] - s[L2 + k]
    apart = x * dx + y * dy + z * dz
    ax, ay, az = y * waz - z * way, z * wax - x * waz, x * way - y * wax
    bx, by, bz = y * wbz - z * wby, z * wbx - x * wbz, x * wby - y * wbx
    s0, s1 = speed_of(t, k, 0, apart, ax, ay, az, bx, by, bz), speed_of(t, k, 1, apart, ax, ay, az, bx, by, bz)
    s2, s3 = speed_of(t, k, 2, apart, ax, ay, az, bx, by, bz), speed_of(t, k, 3, apart, ax, ay, az, bx, by, bz)
    p0, p1 = t[IMPULSE + k], t[IMPULSE + LANES + k]
    p2, p3 = t[IMPULSE + L2 + k], t[IMPULSE + L3 + k]
    b0, b1 = _bias(t, k, rate, per), _bias(t, LANES + k, rate, per)
    b2, b3 = _bias(t, L2 + k, rate, per), _bias(t, L3 + k, rate, per)
    common = _in_common(t, k, _lacks(t, k, p0, s0 + b0, rate), _lacks(t, LANES + k, p1, s1 + b1, rate),
                        _lacks(t, L2 + k, p2, s2 + b2, rate), _lacks(t, L3 + k, p3, s3 + b3, rate))
    s0, s1 = s0 + common * t[ALIKE + k], s1 + common * t[ALIKE + LANES + k]
    s2, s3 = s2 + common * t[ALIKE + L2 + k], s3 + common * t[ALIKE + L3 + k]
    c0 = common if t[MASS + k] > 0.0 else 0.0
    c1 = common if t[MASS + LANES + k] > 0.0 else 0.0
    c2 = common if t[MASS + L2 + k] > 0.0 else 0.0
    c3 = common if t[MASS + L3 + k] > 0.0 else 0.0
    n0 = _impulse(t, k, p0, c0, s0, b0, rate, scale, loss)
    q0 = n0 - p0
    d = q0 - c0
    s1, s2, s3 = s1 + t[K01 + k] * d, s2 + t[K02 + k] * d, s3 + t[K03 + k] * d
    n1 = _impulse(t, LANES + k, p1, c1, s1, b1, rate, scale, loss)
    q1 = n1 - p1
    d = q1 - c1
    s2, s3 = s2 + t[K12 + k] * d, s3 + t[K13 + k] * d
    n2 = _impulse(t, L2 + k, p2, c2, s2, b2, rate, scale, loss)
    q2 = n2 - p2
    s3 = s3 + t[K23 + k] * (q2 - c2)
    n3 = _impulse(t, L3 + k, p3, c3, s3, b3, rate, scale, loss)
    q3 = n3 - p3
    t[IMPULSE + k], t[IMPULSE + LANES + k], t[IMPULSE + L2 + k], t[IMPULSE + L3 + k] = n0, n1, n2, n3
    s[UNMET + k] = (1.0 - hurry) * max(max(abs(q0) - ENOUGH * t[MASS + k], abs(q1) - ENOUGH * t[MASS + LANES + k]),
                                       max(abs(q2) - ENOUGH * t[MASS + L2 + k], abs(q3) - ENOUGH * t[MASS + L3 + k]))
    a = ANCHOR + k
    q = q0 + q1 + q2 + q3
    px, py, pz = sum_of(t, a, q0, q1, q2, q3), sum_of(t, a + LANES, q0, q1, q2, q3), sum_of(t, a + L2, q0, q1, q2, q3)
    rx, ry, rz = sum_of(t, a + L3, q0, q1, q2, q3), sum_of(t, a + L4, q0, q1, q2, q3), sum_of(t, a + L5, q0, q1, q2, q3)
    # What the bodies will have of it, for friction
    ax, ay, az = turn(t, INERTIA_A, k, py * z - pz * y, pz * x - px * z, px * y - py * x)
    bx, by, bz = turn(t, INERTIA_B, k, ry * z - rz * y, rz * x - rx * z, rx * y - ry * x)
    wax, way, waz, wbx, wby, wbz = wax - ax, way - ay, waz - az, wbx + bx, wby + by, wbz + bz
    f = (t[LIGHT_A + k] + t[LIGHT_B + k]) * q
    dx, dy, dz = dx + f * x, dy + f * y, dz + f * z
    cx, cy, cz = t[CENTRE_A + k], t[CENTRE_A + LANES + k], t[CENTRE_A + L2 + k]
    dx, dy, dz = dx - (way * cz - waz * cy), dy - (waz * cx - wax * cz), dz - (wax * cy - way * cx)
    cx, cy, cz = t[CENTRE_B + k], t[CENTRE_B + LANES + k], t[CENTRE_B + L2 + k]
    dx, dy, dz = dx + (wby * cz - wbz * cy), dy + (wbz * cx - wbx * cz), dz + (wbx * cy - wby * cx)
    pressed = n0 + n1 + n2 + n3
    limit = t[FRICTION + k] * pressed
    u = dx * t[ALONG + k] + dy * t[ALONG + LANES + k] + dz * t[ALONG + L2 + k]
    v = dx * t[ACROSS + k] + dy * t[ACROSS + LANES + k] + dz * t[ACROSS + L2 + k]
    p0, p1, p2 = t[PUSHED_ALONG + k], t[PUSHED_ACROSS + k], t[TWISTED + k]
    q0 = p0 - (t[MASS_11 + k] * u + t[MASS_12 + k] * v)
    q1 = p1 - (t[MASS_12 + k] * u + t[MASS_22 + k] * v)
    square = q0 * q0 + q1 * q1
    shrink = limit / math.sqrt(square)
    shrink = shrink if square > limit * limit else 1.0  # Coulomb's cone
    q0, q1 = q0 * shrink, q1 * shrink
    limit = limit * t[RADIUS + k]
    q2 = p2 - t[TWIST_MASS + k] * (x * (wbx - wax) + y * (wby - way) + z * (wbz - waz))
    q2 = min(max(q2, -limit), limit)
    t[PUSHED_ALONG + k], t[PUSHED_ACROSS + k], t[TWISTED + k] = q0, q1, q2
    apply(t, s, k, q, px, py, pz, rx, ry, rz, q0 - p0, q1 - p1, q2 - p2)
    s[PRESSING + k] = pressed
