"""Contact solver: sequential impulses with soft constraints in sub-steps, warm started.

Each sub-step solves the contacts as stiff springs before bodies move (`solve`), and without springs afterwards
(`relax`), so that the velocity that pushed them apart is removed again (Catto 2023, Solver2D, 'Soft Step'; Catto 2011,
Soft Constraints). Contacts are detected once a step; separations follow the bodies. One iteration each is enough for
bodies that fall and tumble. Resting contacts need a converged solution: slow constraints are rigid, so that a stack
does not sag, and are iterated until no velocity changes any more, along conjugate directions (Silcowitz, Niebe and
Erleben 2010, A Nonsmooth Nonlinear Conjugate Gradient Method). Once bodies rest, the first iteration finds them
converged.

Groups are solved one after the other, the constraints of a group at once. Common parameters: groups, the number of
groups; solver, SolverArrays, whose tables and motions change; h, the length of a sub-step in s; iterations, the maximum
for rigid constraints.
"""

import math

from drone_engine.dynamics.constraint import Softness, apply_impulses, solve_constraint, update_separation
from drone_engine.dynamics.contact_table import (
    DIRECTION,
    DISPLACEMENT_A,
    DISPLACEMENT_B,
    DISPLACEMENT_FIELDS,
    L3,
    L4,
    LANES,
    LOADED,
    NORMAL_IMPULSE,
    NORMAL_MASS,
    PREVIOUS,
    RESIDUAL,
    SOFT,
    TANGENT_IMPULSE_1,
    TANGENT_IMPULSE_2,
    TOTAL_IMPULSE,
    TRANSLATION,
    TWIST_IMPULSE,
    VELOCITY_A,
    VELOCITY_B,
    lane_count,
    per_point,
    vector,
)
from drone_engine.kernel import inlined, kernel

FREQUENCY = 0.125  # of the contacts' springs, of the frequency of sub-steps; above a quarter no spring is stable
DAMPING_RATIO = 10.0
IMPULSES = 7  # of a constraint: four along the normal, two along the tangents, the twist


@inlined
def gather(solver, g):
    """Copies the velocities of a group's bodies into lanes."""
    v, motion = solver.gathered, solver.motion
    for k in range(LANES):
        a, b = solver.body[g, 0, k], solver.body[g, 1, k]
        for c in range(6):
            v[VELOCITY_A + c * LANES + k], v[VELOCITY_B + c * LANES + k] = motion[a, c], motion[b, c]


@inlined
def scatter(solver, g):
    """Copies the velocities in lanes back to a group's bodies."""
    v, motion = solver.gathered, solver.motion
    for k in range(LANES):
        a, b = solver.body[g, 0, k], solver.body[g, 1, k]
        for c in range(6):
            motion[a, c], motion[b, c] = v[VELOCITY_A + c * LANES + k], v[VELOCITY_B + c * LANES + k]


@kernel
def warm_start(groups, solver):
    """Applies the impulses of the last sub-step, which are close to those of this one."""
    lanes = lane_count(solver.table)
    v = solver.gathered
    for g in range(groups):
        t = solver.table[g]
        gather(solver, g)
        for k in range(lanes):
            q0, q1, q2, q3 = per_point(t, NORMAL_IMPULSE, k)
            apply_impulses(t, v, k, q0, q1, q2, q3, t[TANGENT_IMPULSE_1 + k], t[TANGENT_IMPULSE_2 + k],
                           t[TWIST_IMPULSE + k])
        scatter(solver, g)


@kernel
def solve(groups, solver, h, iterations):
    """Solves the contacts with springs, before bodies move; marks the bodies that a contact pushes as LOADED."""
    omega = 2.0 * math.pi * FREQUENCY / h
    a1 = 2.0 * DAMPING_RATIO + h * omega
    a2 = h * omega * a1
    _iterate(groups, solver, Softness(omega / a1, a2 / (1.0 + a2), 1.0 / (1.0 + a2), 1.0 / h), iterations)
    for g in range(groups):
        t = solver.table[g]
        for k in range(LANES):
            q0, q1, q2, q3 = per_point(t, NORMAL_IMPULSE, k)
            if q0 + q1 + q2 + q3 > 0.0:
                solver.motion[solver.body[g, 0, k], LOADED] = solver.motion[solver.body[g, 1, k], LOADED] = 1.0


@kernel
def relax(groups, solver, h, iterations):
    """Updates the separations once bodies have moved, solves the contacts without springs, and adds the normal impulses
    to those of the step."""
    lanes = lane_count(solver.table)
    v, motion = solver.gathered, solver.motion
    for g in range(groups):
        for k in range(LANES):
            a, b = solver.body[g, 0, k], solver.body[g, 1, k]
            for c in range(DISPLACEMENT_FIELDS):
                v[DISPLACEMENT_A + c * LANES + k] = motion[a, TRANSLATION + c]
                v[DISPLACEMENT_B + c * LANES + k] = motion[b, TRANSLATION + c]
        t = solver.table[g]
        for k in range(lanes):
            update_separation(t, v, k)
    _iterate(groups, solver, Softness(0.0, 1.0, 0.0, 1.0 / h), iterations)
    for g in range(groups):
        t = solver.table[g]
        for k in range(L4):
            t[TOTAL_IMPULSE + k] += t[NORMAL_IMPULSE + k]


@kernel
def _iterate(groups, solver, softness, iterations):
    """One iteration over all constraints, then further ones over rigid ones, up to `iterations` in all."""
    unconverged = _iteration(groups, solver, softness, False)
    if iterations == 1 or unconverged == 0:
        return
    residual = 0.0
    for _ in range(1, iterations):
        _save_impulses(groups, solver.table)
        if _iteration(groups, solver, softness, True) == 0:
            break
        residual = _conjugate_step(groups, solver, residual)
    else:
        _iteration(groups, solver, softness, True)  # a conjugate step may leave impulses outside of their limits


@kernel
def _iteration(groups, solver, softness, rigid_only):
    """One Gauss-Seidel iteration over all constraints, or over groups with a rigid one. Returns how many rigid
    constraints have not converged."""
    lanes = lane_count(solver.table)
    v = solver.gathered
    unconverged = 0
    for g in range(groups):
        t = solver.table[g]
        if rigid_only:
            rigid = 0
            for k in range(LANES):
                rigid += t[SOFT + k] == 0.0
            if rigid == 0:
                continue
        gather(solver, g)
        for k in range(lanes):
            solve_constraint(t, v, k, softness)
        scatter(solver, g)
        for k in range(LANES):
            unconverged += v[RESIDUAL + k] > 0.0
    return unconverged


@kernel
def _save_impulses(groups, table):
    """Copies the impulses of all constraints to PREVIOUS."""
    for g in range(groups):
        t = table[g]
        for k in range(L4):
            t[PREVIOUS + k] = t[NORMAL_IMPULSE + k]
        for k in range(L3):
            t[PREVIOUS + L4 + k] = t[TANGENT_IMPULSE_1 + k]


@kernel
def _conjugate_step(groups, solver, last):
    """Moves the impulses of rigid constraints along the search direction, after an iteration (Fletcher and Reeves).

    The change by the iteration is the negative gradient. Its squared norm (by the points' effective masses) is
    returned; beta is its ratio to `last`, that of the iteration before, and the direction restarts where it would not
    shrink.
    """
    lanes = lane_count(solver.table)
    v = solver.gathered  # its first rows are scratch here
    square = 0.0
    for g in range(groups):
        t = solver.table[g]
        for k in range(L4):
            change = t[NORMAL_IMPULSE + k] - t[PREVIOUS + k]
            mass = t[NORMAL_MASS + k]
            t[PREVIOUS + k] = change
            v[k] = change * change / mass if mass > 0.0 else 0.0
        for k in range(L3):
            t[PREVIOUS + L4 + k] = t[TANGENT_IMPULSE_1 + k] - t[PREVIOUS + L4 + k]
        for k in range(LANES):
            s0, s1, s2, s3 = per_point(v, 0, k)
            square += (1.0 - t[SOFT + k]) * (s0 + s1 + s2 + s3)
    beta = square / last if 0.0 < square < last else 0.0
    for g in range(groups):
        t = solver.table[g]
        for row in range(IMPULSES):
            for k in range(LANES):
                step = beta * t[DIRECTION + row * LANES + k] * (1.0 - t[SOFT + k]) if beta > 0.0 else 0.0
                t[DIRECTION + row * LANES + k] = step + t[PREVIOUS + row * LANES + k]
                t[PREVIOUS + row * LANES + k] = step
        if beta > 0.0:
            gather(solver, g)
            for k in range(lanes):
                q0, q1, q2, q3 = per_point(t, PREVIOUS, k)
                tangent_1, tangent_2, twist = vector(t, PREVIOUS + L4, k)
                apply_impulses(t, v, k, q0, q1, q2, q3, tangent_1, tangent_2, twist)
            scatter(solver, g)
            for k in range(L4):
                t[NORMAL_IMPULSE + k] += t[PREVIOUS + k]
            for k in range(L3):
                t[TANGENT_IMPULSE_1 + k] += t[PREVIOUS + L4 + k]
    return square
