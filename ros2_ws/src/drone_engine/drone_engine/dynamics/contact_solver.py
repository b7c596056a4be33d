"""Contacts of rigid bodies: sequential impulses with soft constraints in sub-steps, warm started.

Each sub-step solves the contacts as stiff springs before positions move, and once more without the springs after, so
that what they pushed apart keeps no speed (Catto 2023, Solver2D, 'Soft Step'; the springs are those of Catto 2011, Soft
Constraints). Detection runs once a step; the gaps follow the bodies. One pass each is enough where bodies fall and
tumble. What rests does not forgive what is left over: calm contacts have no softness, so that a stack does not sag, and
are passed over until none changes a speed any more, with the directions of conjugate gradients (Silcowitz, Niebe and
Erleben 2010, A Nonsmooth Nonlinear Conjugate Gradient Method); once they stand, that is at once.

Groups of units come one after the other, the units of a group at once: they share no moving body. Within a unit the
points meet by their couplings: the speeds of all are worked out at once, each impulse changes those of the points after
it, and the bodies get the sum, which is what impulses one by one would do. Loops over lanes are without branches, and
how many there are is a number that the compiler does not know: it would write each lane out.
"""

import math

from drone_engine.dynamics.constraint import (
    L2,
    L3,
    L4,
    L5,
    UNMET,
    VELOCITY_A,
    VELOCITY_B,
    WAY_A,
    WAY_B,
    follow,
    give,
    press,
)
from drone_engine.dynamics.contact_constraints import (
    BEFORE,
    DIRECTION,
    FIELDS,
    HURRY,
    IMPULSE,
    LANES,
    MASS,
    PUSHED_ACROSS,
    PUSHED_ALONG,
    TOTAL,
    TWISTED,
)
from drone_engine.kernel import inlined, kernel

FREQUENCY = 0.125  # of the contacts' springs, of that of the sub-steps; above a quarter no spring is stable
DAMPING_RATIO = 10.0
# A body's row: velocity, angular velocity; since detection the way, the rotation as axis times sine and 1 / (1 + cos);
# whether something presses on it.
WAY, PRESSED, ROW = 6, 13, 16


@inlined
def gather(body, g, moving, s):
    """Copies the velocities of a group's bodies side by side."""
    for k in range(LANES):
        a, b = body[g, 0, k], body[g, 1, k]
        for c in range(6):
            s[VELOCITY_A + c * LANES + k], s[VELOCITY_B + c * LANES + k] = moving[a, c], moving[b, c]


@inlined
def scatter(body, g, moving, s):
    """Copies them back."""
    for k in range(LANES):
        a, b = body[g, 0, k], body[g, 1, k]
        for c in range(6):
            moving[a, c], moving[b, c] = s[VELOCITY_A + c * LANES + k], s[VELOCITY_B + c * LANES + k]


@kernel
def warm_start(groups, body, table, moving, s):
    """Applies the impulses of the last sub-step again, which are nearly those of this one. s: (GATHERED,) scratch."""
    lanes = table.shape[1] // FIELDS
    for g in range(groups):
        t = table[g]
        gather(body, g, moving, s)
        for k in range(lanes):
            q0, q1 = t[IMPULSE + k], t[IMPULSE + LANES + k]
            q2, q3 = t[IMPULSE + L2 + k], t[IMPULSE + L3 + k]
            give(t, s, k, q0, q1, q2, q3, t[PUSHED_ALONG + k], t[PUSHED_ACROSS + k], t[TWISTED + k])
        scatter(body, g, moving, s)


@kernel
def _pass(groups, body, table, moving, s, rate, scale, loss, per, again):
    """Meets all contacts once, or only groups with calm ones (`again`); returns how many of these had to change."""
    lanes = table.shape[1] // FIELDS
    unmet = 0
    for g in range(groups):
        t = table[g]
        if again:
            calm = 0
            for k in range(LANES):
                calm += t[HURRY + k] == 0.0
            if calm == 0:
                continue
        gather(body, g, moving, s)
        for k in range(lanes):
            press(t, s, k, rate, scale, loss, per)
        scatter(body, g, moving, s)
        for k in range(LANES):
            unmet += s[UNMET + k] > 0.0
    return unmet


@kernel
def _keep(groups, table):
    """Notes the impulses before a pass."""
    for g in range(groups):
        t = table[g]
        for k in range(L4):
            t[BEFORE + k] = t[IMPULSE + k]
        for k in range(L3):
            t[BEFORE + L4 + k] = t[PUSHED_ALONG + k]


@kernel
def _turn(groups, body, table, moving, s, last):
    """After a pass: how far the impulses of calm units went, squared, by the mass that they push; and if that is less
    than `last`, goes on by as much of the way as before. Sets the direction anew."""
    lanes = table.shape[1] // FIELDS
    square = 0.0
    for g in range(groups):
        t = table[g]
        for k in range(L4):
            step = t[IMPULSE + k] - t[BEFORE + k]
            mass = t[MASS + k]
            t[BEFORE + k] = step
            s[k] = step * step / mass if mass > 0.0 else 0.0
        for k in range(L3):
            t[BEFORE + L4 + k] = t[PUSHED_ALONG + k] - t[BEFORE + L4 + k]
        for k in range(LANES):
            square += (1.0 - t[HURRY + k]) * (s[k] + s[LANES + k] + s[L2 + k] + s[L3 + k])
    share = square / last if 0.0 < square < last else 0.0
    for g in range(groups):
        t = table[g]
        for row in range(7):
            for k in range(LANES):
                way = share * t[DIRECTION + row * LANES + k] * (1.0 - t[HURRY + k]) if share > 0.0 else 0.0
                t[DIRECTION + row * LANES + k] = way + t[BEFORE + row * LANES + k]
                t[BEFORE + row * LANES + k] = way
        if share > 0.0:
            gather(body, g, moving, s)
            for k in range(lanes):
                q0, q1 = t[BEFORE + k], t[BEFORE + LANES + k]
                q2, q3 = t[BEFORE + L2 + k], t[BEFORE + L3 + k]
                u, v, w = t[BEFORE + L4 + k], t[BEFORE + L5 + k], t[BEFORE + 6 * LANES + k]
                give(t, s, k, q0, q1, q2, q3, u, v, w)
            scatter(body, g, moving, s)
            for k in range(L4):
                t[IMPULSE + k] += t[BEFORE + k]
            for k in range(L3):
                t[PUSHED_ALONG + k] += t[BEFORE + L4 + k]
    return square


@kernel
def _meet(groups, body, table, moving, s, rate, scale, loss, per, passes):
    """One pass over all contacts, and up to `passes` over the calm ones."""
    if passes == 1 or _pass(groups, body, table, moving, s, rate, scale, loss, per, False) == 0:
        if passes == 1:
            _pass(groups, body, table, moving, s, rate, scale, loss, per, False)
        return
    last = 0.0
    for _ in range(1, passes):
        _keep(groups, table)
        unmet = _pass(groups, body, table, moving, s, rate, scale, loss, per, True)
        if unmet == 0:
            break
        last = _turn(groups, body, table, moving, s, last)
    else:
        _pass(groups, body, table, moving, s, rate, scale, loss, per, True)  # so that the last word is a valid one


@kernel
def press_apart(groups, body, table, moving, s, h, passes):
    """Passes over all contacts with springs, for a sub-step of h s; marks who is pressed on."""
    omega = 2.0 * math.pi * FREQUENCY / h
    a1 = 2.0 * DAMPING_RATIO + h * omega
    a2 = h * omega * a1
    _meet(groups, body, table, moving, s, omega / a1, a2 / (1.0 + a2), 1.0 / (1.0 + a2), 1.0 / h, passes)
    for g in range(groups):
        t = table[g]
        for k in range(LANES):
            if t[IMPULSE + k] + t[IMPULSE + LANES + k] + t[IMPULSE + L2 + k] + t[IMPULSE + L3 + k] > 0.0:
                moving[body[g, 0, k], PRESSED] = moving[body[g, 1, k], PRESSED] = 1.0


@kernel
def relax(groups, body, table, moving, s, h, passes):
    """The last passes of a sub-step of h s, without springs, once bodies have moved; adds up the impulses."""
    lanes = table.shape[1] // FIELDS
    for g in range(groups):
        for k in range(LANES):
            a, b = body[g, 0, k], body[g, 1, k]
            for c in range(7):
                s[WAY_A + c * LANES + k], s[WAY_B + c * LANES + k] = moving[a, WAY + c], moving[b, WAY + c]
        t = table[g]
        for k in range(lanes):
            follow(t, s, k)
    _meet(groups, body, table, moving, s, 0.0, 1.0, 0.0, 1.0 / h, passes)
    for g in range(groups):
        t = table[g]
        for k in range(L4):
            t[TOTAL + k] += t[IMPULSE + k]
