"""Restitution: what meets faster than BOUNCE_SPEED is thrown back, in the sub-step in which it meets.

A contact that closes somewhere within a sub-step meets at u, u^2 = u0^2 + 2 a s, from its speed u0 and gap s at the
start and its acceleration a (Torricelli): so a bounce neither gains nor loses what gravity does on the way.
"""

import math

from drone_engine.dynamics.constraint import L2, L3, L4, L5, VELOCITY_B, speed_of, sum_of
from drone_engine.dynamics.contact_constraints import (
    ANCHOR,
    BOUNCE,
    FIELDS,
    GAP,
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
    POINTS,
    THROWN,
    TOTAL,
    turn,
)
from drone_engine.dynamics.contact_solver import gather
from drone_engine.kernel import inlined, kernel

BOUNCE_SPEED = 0.3  # m/s, below which nothing bounces
PASSES = 20  # at most: units may share a body
ROUNDS = 100  # at most: the points of a unit do; four corners need about thirty
NEAR = 0.05  # of the way in a sub-step: a gap that counts as none, so that a face that falls flat bounces flat
ENOUGH = 1e-6  # m/s: how near to its speed a point has to come


@inlined
def _parting(t, s, k):
    """Speed apart of the centres along the normal, and the normal times both spins."""
    x, y, z = t[k], t[LANES + k], t[L2 + k]
    e = VELOCITY_B + k
    return (x * (s[e] - s[k]) + y * (s[e + LANES] - s[LANES + k]) + z * (s[e + L2] - s[L2 + k]),
            y * s[L5 + k] - z * s[L4 + k], z * s[L3 + k] - x * s[L5 + k], x * s[L4 + k] - y * s[L3 + k],
            y * s[e + L5] - z * s[e + L4], z * s[e + L3] - x * s[e + L5], x * s[e + L4] - y * s[e + L3])


@kernel
def note(groups, body, table, moving, s, h):
    """Before forces act: marks the points that meet within h s, by their speed in their group; returns how many."""
    marked = 0.0
    lanes = table.shape[1] // FIELDS
    for g in range(groups):
        t = table[g]
        springy = 0.0
        for k in range(lanes):
            springy += t[BOUNCE + k]
        if springy == 0.0:
            continue
        gather(body, g, moving, s)
        for p in range(POINTS):
            at = p * LANES
            for k in range(lanes):
                apart, ax, ay, az, bx, by, bz = _parting(t, s, k)
                speed = speed_of(t, k, p, apart, ax, ay, az, bx, by, bz)
                fast = (speed < -BOUNCE_SPEED) & (t[IMPULSE + at + k] == 0.0) & (t[BOUNCE + k] > 0.0) & (
                    t[GAP + at + k] + 2.0 * h * speed < 0.0) & (t[MASS + at + k] > 0.0)
                t[THROWN + at + k] = speed if fast else 0.0
            for k in range(lanes):
                marked += t[THROWN + at + k]
    return marked < 0.0


@kernel
def aim(groups, body, table, moving, s, h):
    """After forces have acted: what was marked shall leave at the restitution times the speed at which it meets."""
    for g in range(groups):
        t = table[g]
        gather(body, g, moving, s)
        for k in range(LANES):
            apart, ax, ay, az, bx, by, bz = _parting(t, s, k)
            for p in range(POINTS):
                at = p * LANES + k
                if t[THROWN + at] < 0.0:
                    start, end = -t[THROWN + at], -speed_of(t, k, p, apart, ax, ay, az, bx, by, bz)
                    square = start * start + 2.0 * (end - start) / h * t[GAP + at]
                    t[THROWN + at] = t[BOUNCE + k] * math.sqrt(max(square, 0.0))


@kernel
def throw(groups, body, table, moving, h):
    """After the contacts are solved: gives the points that met the speed that they shall leave at."""
    for _ in range(PASSES):
        unmet = 0.0
        for g in range(groups):
            t = table[g]
            thrown = 0.0
            for at in range(POINTS * LANES):
                thrown += max(t[THROWN + at], 0.0)
            if thrown > 0.0:
                for k in range(LANES):
                    unmet = max(unmet, _throw_unit(t, k, body[g, 0, k], body[g, 1, k], moving, h))
        if unmet < ENOUGH:
            break
    for g in range(groups):
        for at in range(POINTS * LANES):
            if table[g, THROWN + at] > 0.0:
                table[g, IMPULSE + at] = 0.0  # it has left


@kernel
def _more(t, at, speed, h):
    """The impulse that a point of this speed still lacks; none if it has not met."""
    pressed = t[IMPULSE + at]
    if t[THROWN + at] <= 0.0 or (pressed <= 0.0 and t[GAP + at] > NEAR * h * t[THROWN + at]):
        return 0.0
    q = max(t[MASS + at] * (t[THROWN + at] - speed), -pressed)
    t[IMPULSE + at] = pressed + q
    t[TOTAL + at] += q
    return q


@kernel
def _throw_unit(t, k, a, b, moving, h):
    """Gives the points of lane k their speeds; returns how much a speed changed at most."""
    x, y, z = t[k], t[LANES + k], t[L2 + k]
    u, v = moving[a], moving[b]
    apart = x * (v[0] - u[0]) + y * (v[1] - u[1]) + z * (v[2] - u[2])
    ax, ay, az = y * u[5] - z * u[4], z * u[3] - x * u[5], x * u[4] - y * u[3]
    bx, by, bz = y * v[5] - z * v[4], z * v[3] - x * v[5], x * v[4] - y * v[3]
    s0, s1 = speed_of(t, k, 0, apart, ax, ay, az, bx, by, bz), speed_of(t, k, 1, apart, ax, ay, az, bx, by, bz)
    s2, s3 = speed_of(t, k, 2, apart, ax, ay, az, bx, by, bz), speed_of(t, k, 3, apart, ax, ay, az, bx, by, bz)
    k01, k02, k03, k12, k13, k23 = t[K01 + k], t[K02 + k], t[K03 + k], t[K12 + k], t[K13 + k], t[K23 + k]
    per0, per1 = _per(t[MASS + k]), _per(t[MASS + LANES + k])
    per2, per3 = _per(t[MASS + L2 + k]), _per(t[MASS + L3 + k])
    q0, q1, q2, q3 = 0.0, 0.0, 0.0, 0.0
    most = 0.0
    for _ in range(ROUNDS):
        q = _more(t, k, s0, h)
        q0, s0, s1, s2, s3 = q0 + q, s0 + per0 * q, s1 + k01 * q, s2 + k02 * q, s3 + k03 * q
        change = abs(q * per0)
        q = _more(t, LANES + k, s1, h)
        q1, s0, s1, s2, s3 = q1 + q, s0 + k01 * q, s1 + per1 * q, s2 + k12 * q, s3 + k13 * q
        change = max(change, abs(q * per1))
        q = _more(t, L2 + k, s2, h)
        q2, s0, s1, s2, s3 = q2 + q, s0 + k02 * q, s1 + k12 * q, s2 + per2 * q, s3 + k23 * q
        change = max(change, abs(q * per2))
        q = _more(t, L3 + k, s3, h)
        q3, s0, s1, s2, s3 = q3 + q, s0 + k03 * q, s1 + k13 * q, s2 + k23 * q, s3 + per3 * q
        change = max(change, abs(q * per3))
        most = max(most, change)
        if change < ENOUGH:
            break
    r = ANCHOR + k
    q = q0 + q1 + q2 + q3
    px, py, pz = sum_of(t, r, q0, q1, q2, q3), sum_of(t, r + LANES, q0, q1, q2, q3), sum_of(t, r + L2, q0, q1, q2, q3)
    ex, ey, ez = turn(t, INERTIA_A, k, py * z - pz * y, pz * x - px * z, px * y - py * x)
    px, py, pz = sum_of(t, r + L3, q0, q1, q2, q3), sum_of(t, r + L4, q0, q1, q2, q3), sum_of(t, r + L5, q0, q1, q2, q3)
    fx, fy, fz = turn(t, INERTIA_B, k, py * z - pz * y, pz * x - px * z, px * y - py * x)
    m, n = q * t[LIGHT_A + k], q * t[LIGHT_B + k]
    u[0], u[1], u[2] = u[0] - m * x, u[1] - m * y, u[2] - m * z
    u[3], u[4], u[5] = u[3] - ex, u[4] - ey, u[5] - ez
    v[0], v[1], v[2] = v[0] + n * x, v[1] + n * y, v[2] + n * z
    v[3], v[4], v[5] = v[3] + fx, v[4] + fy, v[5] + fz
    return most


@inlined
def _per(mass):
    return 1.0 / mass if mass > 0.0 else 0.0

