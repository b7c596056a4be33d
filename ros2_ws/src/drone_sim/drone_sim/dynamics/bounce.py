"""Restitution: what meets faster than BOUNCE_SPEED is thrown back, in the sub-step in which it meets.

A contact that closes somewhere within a sub-step meets at u, u^2 = u0^2 + 2 a s, from its speed u0 and gap s at the
start and its acceleration a (Torricelli): so a bounce neither gains nor loses what gravity does on the way.
"""

import math

from drone_sim.dynamics.constraints import BOUNCE, GAP, IMPULSE, LIGHT_A, LIGHT_B, MASS, SPEED, TOTAL
from drone_sim.kernel import inlined, kernel

BOUNCE_SPEED = 0.3  # m/s, below which nothing bounces
PASSES = 40  # at most: the points of a body share it; four corners need about ten
ENOUGH = 0.01  # of BOUNCE_SPEED: how near to its speed a point has to come


@inlined
def speed_apart(velocity, angular, a, b, head, row):
    """Speed along the normal at which b's point leaves a's."""
    return ((head[0] * (velocity[b, 0] - velocity[a, 0]) + head[1] * (velocity[b, 1] - velocity[a, 1])
             + head[2] * (velocity[b, 2] - velocity[a, 2]))
            + (row[3] * angular[b, 0] + row[4] * angular[b, 1] + row[5] * angular[b, 2])
            - (row[0] * angular[a, 0] + row[1] * angular[a, 1] + row[2] * angular[a, 2]))


@kernel
def note(count, pair, points, head, row, velocity, angular, h):
    """Before forces act: marks the points that meet within h s, by their speed in their row; returns how many."""
    marked = 0
    for i in range(count):
        if head[i, BOUNCE] == 0.0:
            continue
        for k in range(points[i]):
            r = row[i, k]
            r[SPEED] = 0.0
            if r[IMPULSE] == 0.0:
                speed = speed_apart(velocity, angular, pair[i, 0], pair[i, 1], head[i], r)
                if speed < -BOUNCE_SPEED and r[GAP] + 2.0 * h * speed < 0.0:
                    r[SPEED] = speed
                    marked += 1
    return marked


@kernel
def aim(count, pair, points, head, row, velocity, angular, h):
    """After forces have acted: what was marked shall leave at the restitution times the speed at which it meets."""
    for i in range(count):
        if head[i, BOUNCE] == 0.0:
            continue
        for k in range(points[i]):
            r = row[i, k]
            if r[SPEED] < 0.0:
                start = -r[SPEED]
                end = -speed_apart(velocity, angular, pair[i, 0], pair[i, 1], head[i], r)
                square = start * start + 2.0 * (end - start) / h * r[GAP]
                r[SPEED] = head[i, BOUNCE] * math.sqrt(max(square, 0.0))


@kernel
def throw(count, pair, points, head, row, velocity, angular):
    """After the contacts are solved: gives the points that met the speed that they shall leave at."""
    for _ in range(PASSES):
        unmet = 0.0
        for i in range(count):
            if head[i, BOUNCE] == 0.0:
                continue
            a, b, h = pair[i, 0], pair[i, 1], head[i]
            for k in range(points[i]):
                r = row[i, k]
                if r[SPEED] <= 0.0 or r[IMPULSE] <= 0.0:
                    continue
                missing = r[SPEED] - speed_apart(velocity, angular, a, b, h, r)
                wanted = max(r[IMPULSE] + r[MASS] * missing, 1e-300)
                q = wanted - r[IMPULSE]
                r[IMPULSE] = wanted
                r[TOTAL] += q
                unmet = max(unmet, abs(missing))
                for c in range(3):
                    velocity[a, c] -= h[LIGHT_A] * q * h[c]
                    velocity[b, c] += h[LIGHT_B] * q * h[c]
                    angular[a, c] -= q * r[6 + c]
                    angular[b, c] += q * r[9 + c]
        if unmet < ENOUGH * BOUNCE_SPEED:
            break
    for i in range(count):
        if head[i, BOUNCE] > 0.0:
            for k in range(points[i]):
                if row[i, k, SPEED] > 0.0:
                    row[i, k, IMPULSE] = 0.0  # it has left
