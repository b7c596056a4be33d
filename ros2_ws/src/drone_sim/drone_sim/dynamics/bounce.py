"""Restitution: what meets faster than BOUNCE_SPEED is thrown back, in the sub-step in which it meets.

A contact that closes somewhere within a sub-step meets at u, u^2 = u0^2 + 2 a s, from its speed u0 and gap s at the
start and its acceleration a (Torricelli): so a bounce neither gains nor loses what gravity does on the way.
"""

import math

from drone_sim.dynamics.constraints import (
    ANCHOR, BOUNCE, FIELDS, GAP, IMPULSE, INERTIA_A, INERTIA_B, LANES, LIGHT_A, LIGHT_B, MASS, POINTS, THROWN, TOTAL, turn,
)
from drone_sim.dynamics.solver import L2, L3, L4, L5, VELOCITY_B, gather, speed_of
from drone_sim.kernel import inlined, kernel

BOUNCE_SPEED = 0.3  # m/s, below which nothing bounces
PASSES = 40  # at most: the points of a body share it; four corners need about ten
LEAST = 1e-300  # N s, of a point that was met
ENOUGH = 0.01  # of BOUNCE_SPEED: how near to its speed a point has to come


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
def throw(groups, body, table, moving, s):
    """After the contacts are solved: gives the points that met the speed that they shall leave at."""
    for _ in range(PASSES):
        unmet = 0.0
        for g in range(groups):
            t = table[g]
            for k in range(LANES):
                for p in range(POINTS):
                    at = p * LANES + k
                    if t[THROWN + at] > 0.0 and t[IMPULSE + at] > 0.0:
                        unmet = max(unmet, _throw_one(t, k, p, body[g, 0, k], body[g, 1, k], moving))
        if unmet < ENOUGH * BOUNCE_SPEED:
            break
    for g in range(groups):
        for at in range(POINTS * LANES):
            if table[g, THROWN + at] > 0.0 and table[g, IMPULSE + at] > 0.0:
                table[g, IMPULSE + at] = 0.0  # it has left


@kernel
def _throw_one(t, k, p, a, b, moving):
    """Gives point p of lane k its speed; returns how much of it was missing."""
    x, y, z = t[k], t[LANES + k], t[L2 + k]
    u, v = moving[a], moving[b]
    apart = x * (v[0] - u[0]) + y * (v[1] - u[1]) + z * (v[2] - u[2])
    speed = speed_of(t, k, p, apart, y * u[5] - z * u[4], z * u[3] - x * u[5], x * u[4] - y * u[3],
                     y * v[5] - z * v[4], z * v[3] - x * v[5], x * v[4] - y * v[3])
    at, r = p * LANES + k, ANCHOR + 6 * LANES * p + k
    missing = t[THROWN + at] - speed
    wanted = max(t[IMPULSE + at] + t[MASS + at] * missing, LEAST)
    q = wanted - t[IMPULSE + at]
    t[IMPULSE + at] = wanted
    t[TOTAL + at] += q
    m, n = q * t[LIGHT_A + k], q * t[LIGHT_B + k]
    ax, ay, az = turn(t, INERTIA_A, k, t[r + LANES] * z - t[r + L2] * y, t[r + L2] * x - t[r] * z,
                      t[r] * y - t[r + LANES] * x)
    bx, by, bz = turn(t, INERTIA_B, k, t[r + L4] * z - t[r + L5] * y, t[r + L5] * x - t[r + L3] * z,
                      t[r + L3] * y - t[r + L4] * x)
    u[0], u[1], u[2] = u[0] - m * x, u[1] - m * y, u[2] - m * z
    u[3], u[4], u[5] = u[3] - q * ax, u[4] - q * ay, u[5] - q * az
    v[0], v[1], v[2] = v[0] + n * x, v[1] + n * y, v[2] + n * z
    v[3], v[4], v[5] = v[3] + q * bx, v[4] + q * by, v[5] + q * bz
    return abs(missing)
