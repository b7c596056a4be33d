"""Restitution: points that meet faster than RESTITUTION_THRESHOLD bounce, in the sub-step in which they meet.

A point that closes within a sub-step meets at u, u^2 = u0^2 + 2 a s (Torricelli), from its velocity u0 and separation s
at the start and its acceleration a: so a bounce neither gains nor loses the energy that gravity adds on the way.

A sub-step calls `mark_impacts` before forces are applied, `set_target_velocities` after, and `apply_restitution` once
the contacts are solved. The row RESTITUTION_VELOCITY holds, for a marked point, first its velocity (negative), then the
separation velocity that it is to leave with (positive); 0 for all others. Common parameters as in contact_solver.py.
"""

import math

from drone_engine.dynamics.contact_solver import gather
from drone_engine.dynamics.contact_table import (
    ANCHOR,
    ANGULAR_VELOCITY,
    INV_INERTIA_A,
    INV_INERTIA_B,
    INV_MASS_A,
    INV_MASS_B,
    K01,
    K02,
    K03,
    K12,
    K13,
    K23,
    L2,
    L3,
    LANES,
    NORMAL,
    NORMAL_IMPULSE,
    NORMAL_MASS,
    POINTS,
    RESTITUTION,
    RESTITUTION_VELOCITY,
    SEPARATION,
    TOTAL_IMPULSE,
    VELOCITY_A,
    VELOCITY_B,
    at_anchors,
    cross,
    inverse_inertia_times,
    lane_count,
    per_point,
    point_velocity,
    vector,
)
from drone_engine.kernel import inlined, kernel

RESTITUTION_THRESHOLD = 0.3  # m/s, below which nothing bounces
ITERATIONS = 20  # over all constraints, at most: they may share bodies
POINT_ITERATIONS = 100  # over the points of a constraint, at most: four corners need about thirty
CLOSED = 0.05  # of the way in a sub-step: a separation that counts as none, so that a face that lands flat bounces flat
TOLERANCE = 1e-6  # m/s, of the velocity of a point


@kernel
def mark_impacts(groups, solver, h):
    """Marks the points that meet within h s with their velocity, as it is before forces act. Returns whether any
    does."""
    lanes = lane_count(solver.table)
    v = solver.gathered
    marked = 0.0
    for g in range(groups):
        t = solver.table[g]
        restitution = 0.0
        for k in range(lanes):
            restitution += t[RESTITUTION + k]
        if restitution == 0.0:
            continue
        gather(solver, g)
        for p in range(POINTS):
            at = p * LANES
            for k in range(lanes):
                velocity = _velocity(t, v, k, p)
                meets = (velocity < -RESTITUTION_THRESHOLD) & (t[NORMAL_IMPULSE + at + k] == 0.0) & (
                    t[RESTITUTION + k] > 0.0) & (t[SEPARATION + at + k] + 2.0 * h * velocity < 0.0) & (
                    t[NORMAL_MASS + at + k] > 0.0)
                t[RESTITUTION_VELOCITY + at + k] = velocity if meets else 0.0
            for k in range(lanes):
                marked += t[RESTITUTION_VELOCITY + at + k]
    return marked < 0.0


@kernel
def set_target_velocities(groups, solver, h):
    """Once forces have changed the velocities: sets the target of each marked point, restitution times the speed at
    which it meets."""
    v = solver.gathered
    for g in range(groups):
        t = solver.table[g]
        gather(solver, g)
        for k in range(LANES):
            for p in range(POINTS):
                at = p * LANES + k
                if t[RESTITUTION_VELOCITY + at] < 0.0:
                    start, end = -t[RESTITUTION_VELOCITY + at], -_velocity(t, v, k, p)
                    square = start * start + 2.0 * (end - start) / h * t[SEPARATION + at]
                    t[RESTITUTION_VELOCITY + at] = t[RESTITUTION + k] * math.sqrt(max(square, 0.0))


@inlined
def _velocity(t, v, k, p):
    """Separation velocity at point p, m/s, from the gathered velocities."""
    x, y, z = vector(t, NORMAL, k)
    ax, ay, az = vector(v, VELOCITY_A, k)
    bx, by, bz = vector(v, VELOCITY_B, k)
    centers = x * (bx - ax) + y * (by - ay) + z * (bz - az)
    ax, ay, az = vector(v, VELOCITY_A + L3, k)
    bx, by, bz = vector(v, VELOCITY_B + L3, k)
    ax, ay, az = cross(x, y, z, ax, ay, az)
    bx, by, bz = cross(x, y, z, bx, by, bz)
    return point_velocity(t, k, p, centers, ax, ay, az, bx, by, bz)


@kernel
def apply_restitution(groups, solver, h):
    """Once the contacts are solved: gives the points that have met their target velocities, by sequential impulses."""
    for _ in range(ITERATIONS):
        change = 0.0
        for g in range(groups):
            t = solver.table[g]
            targets = 0.0
            for at in range(POINTS * LANES):
                targets += max(t[RESTITUTION_VELOCITY + at], 0.0)
            if targets > 0.0:
                for k in range(LANES):
                    change = max(change, _apply_to_constraint(t, k, solver.motion[solver.body[g, 0, k]],
                                                              solver.motion[solver.body[g, 1, k]], h))
        if change < TOLERANCE:
            break
    for g in range(groups):
        t = solver.table[g]
        for at in range(POINTS * LANES):
            if t[RESTITUTION_VELOCITY + at] > 0.0:
                t[NORMAL_IMPULSE + at] = 0.0  # no warm start: the point is leaving


@kernel
def _apply_to_constraint(t, k, a, b, h):
    """Gives the points in lane k their target velocities. a, b: rows of the bodies in SolverArrays.motion, changed.
    Returns the largest change of a point's velocity, m/s."""
    w = ANGULAR_VELOCITY
    x, y, z = vector(t, NORMAL, k)
    centers = x * (b[0] - a[0]) + y * (b[1] - a[1]) + z * (b[2] - a[2])
    ax, ay, az = cross(x, y, z, a[w], a[w + 1], a[w + 2])
    bx, by, bz = cross(x, y, z, b[w], b[w + 1], b[w + 2])
    s0 = point_velocity(t, k, 0, centers, ax, ay, az, bx, by, bz)
    s1 = point_velocity(t, k, 1, centers, ax, ay, az, bx, by, bz)
    s2 = point_velocity(t, k, 2, centers, ax, ay, az, bx, by, bz)
    s3 = point_velocity(t, k, 3, centers, ax, ay, az, bx, by, bz)
    m0, m1, m2, m3 = per_point(t, NORMAL_MASS, k)
    k00, k11, k22, k33 = _inverse(m0), _inverse(m1), _inverse(m2), _inverse(m3)
    k01, k02, k03, k12, k13, k23 = t[K01 + k], t[K02 + k], t[K03 + k], t[K12 + k], t[K13 + k], t[K23 + k]
    q0, q1, q2, q3 = 0.0, 0.0, 0.0, 0.0
    largest = 0.0
    for _ in range(POINT_ITERATIONS):
        q = _add_impulse(t, k, s0, h)
        q0, s0, s1, s2, s3 = q0 + q, s0 + k00 * q, s1 + k01 * q, s2 + k02 * q, s3 + k03 * q
        change = abs(q * k00)
        q = _add_impulse(t, LANES + k, s1, h)
        q1, s0, s1, s2, s3 = q1 + q, s0 + k01 * q, s1 + k11 * q, s2 + k12 * q, s3 + k13 * q
        change = max(change, abs(q * k11))
        q = _add_impulse(t, L2 + k, s2, h)
        q2, s0, s1, s2, s3 = q2 + q, s0 + k02 * q, s1 + k12 * q, s2 + k22 * q, s3 + k23 * q
        change = max(change, abs(q * k22))
        q = _add_impulse(t, L3 + k, s3, h)
        q3, s0, s1, s2, s3 = q3 + q, s0 + k03 * q, s1 + k13 * q, s2 + k23 * q, s3 + k33 * q
        change = max(change, abs(q * k33))
        largest = max(largest, change)
        if change < TOLERANCE:
            break
    q = q0 + q1 + q2 + q3
    px, py, pz = at_anchors(t, ANCHOR, k, q0, q1, q2, q3)
    ax, ay, az = cross(px, py, pz, x, y, z)
    ax, ay, az = inverse_inertia_times(t, INV_INERTIA_A, k, ax, ay, az)
    px, py, pz = at_anchors(t, ANCHOR + L3, k, q0, q1, q2, q3)
    bx, by, bz = cross(px, py, pz, x, y, z)
    bx, by, bz = inverse_inertia_times(t, INV_INERTIA_B, k, bx, by, bz)
    m, n = q * t[INV_MASS_A + k], q * t[INV_MASS_B + k]
    a[0], a[1], a[2] = a[0] - m * x, a[1] - m * y, a[2] - m * z
    a[w], a[w + 1], a[w + 2] = a[w] - ax, a[w + 1] - ay, a[w + 2] - az
    b[0], b[1], b[2] = b[0] + n * x, b[1] + n * y, b[2] + n * z
    b[w], b[w + 1], b[w + 2] = b[w] + bx, b[w + 1] + by, b[w + 2] + bz
    return largest


@inlined
def _add_impulse(t, at, velocity, h):
    """Adds the impulse that a point of this separation velocity needs to reach its target, N s, and returns it; 0 for a
    point that has no target or has not met. at: its place in a row per point."""
    impulse, target = t[NORMAL_IMPULSE + at], t[RESTITUTION_VELOCITY + at]
    if target <= 0.0 or (impulse <= 0.0 and t[SEPARATION + at] > CLOSED * h * target):
        return 0.0
    q = max(t[NORMAL_MASS + at] * (target - velocity), -impulse)
    t[NORMAL_IMPULSE + at] = impulse + q
    t[TOTAL_IMPULSE + at] += q
    return q


@inlined
def _inverse(mass):
    """The inverse of an effective mass; 0 for a point that does not exist."""
    return 1.0 / mass if mass > 0.0 else 0.0
