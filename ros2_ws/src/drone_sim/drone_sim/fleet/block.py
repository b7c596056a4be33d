"""Many quadrotors that touch nothing, a block of them at a time: each block flies all its steps in the fastest cache.

A block is a table with a column for each drone, and the loops over its columns have no branches, so that the compiler
takes eight drones in each step (structure of arrays). The leaves are those of a World's stages, in the same order: so
each drone flies, bit for bit, as in a World of its own.
"""

from functools import cache
from typing import Any

from drone_sim.dynamics.integrators import spun
from drone_sim.effects.drag import resistance
from drone_sim.effects.motor_lag import followed, stopped
from drone_sim.flight.control import lift, rates, rotor_drag
from drone_sim.flight.craft import SIZE, craft
from drone_sim.flight.pilot import SILENCE, wish
from drone_sim.flight.rotors import turned_on
from drone_sim.kernel import inlined, kernel
from drone_sim.rotation import LITTLE, matrix, turned, turned_little

LANES = 16  # drones of a block
# First rows of what changes: position, orientation, velocity, angular velocity, the rotors' rates and angles, command,
# steps since it came, and where the drone holds. From KEPT on, what is forgotten after each step: the wanted velocity
# and yaw rate, and the square of the angle that it turned by.
P, Q, V, A, SPEED, ANGLE, COMMAND, SILENT, HOLD, WANTED, SQUARE = 0, 3, 7, 10, 13, 17, 21, 25, 26, 29, 33
KEPT, ROWS = 29, 34
# Where the numbers stand that all drones share, after those of a Craft.
(WEIGHT, H, DT, INVERSE_MASS, MAX_SPEED, MAX_YAW_RATE, HALF_X, HALF_Y, HALF_Z, DRAG, KEEP_UP,
 KEEP_DOWN, SHARED) = range(SIZE, SIZE + 13)


@inlined
def _three(block, row, k):
    """Column k's numbers from a row on."""
    return block[row * LANES + k], block[(row + 1) * LANES + k], block[(row + 2) * LANES + k]


@inlined
def _four(block, row, k):
    return (block[row * LANES + k], block[(row + 1) * LANES + k], block[(row + 2) * LANES + k],
            block[(row + 3) * LANES + k])


@inlined
def _put(block, row, k, a, b, c):
    block[row * LANES + k], block[(row + 1) * LANES + k], block[(row + 2) * LANES + k] = a, b, c


@kernel
def guide(block, n, number):
    """What the first n drones of the block want in this step."""
    dt, max_speed, max_yaw_rate = number[DT], number[MAX_SPEED], number[MAX_YAW_RATE]
    for k in range(n):
        silence = block[SILENT * LANES + k] + 1.0
        block[SILENT * LANES + k] = silence
        px, py, pz = _three(block, P, k)
        qx, qy, qz, qw = _four(block, Q, k)
        vx, vy, vz = _three(block, V, k)
        cx, cy, cz, turn = _four(block, COMMAND, k)
        hx, hy, hz = _three(block, HOLD, k)
        wx, wy, wz, turn, hx, hy, hz = wish(px, py, pz, qx, qy, qz, qw, vx, vy, vz, cx, cy, cz, turn,
                                            silence * dt >= SILENCE, hx, hy, hz, max_speed, max_yaw_rate)
        _put(block, WANTED, k, wx, wy, wz)
        block[(WANTED + 3) * LANES + k] = turn
        _put(block, HOLD, k, hx, hy, hz)


@cache
def push_with(lagging: bool, resisted: bool, dragged: bool) -> Any:
    """The kernel for a sub-step with motor lag, air drag on the body, and drag of the rotors; or without."""
    @kernel
    def push(block, n, number):
        """Velocities of the first n drones after a sub-step, and their rotors' rates."""
        c = craft(number)
        weight, h, dt, inverse_mass = number[WEIGHT], number[H], number[DT], number[INVERSE_MASS]
        half_x, half_y, half_z, factor = number[HALF_X], number[HALF_Y], number[HALF_Z], number[DRAG]
        up, down = number[KEEP_UP], number[KEEP_DOWN]
        for k in range(n):
            qx, qy, qz, qw = _four(block, Q, k)
            vx, vy, vz = _three(block, V, k)
            ax, ay, az = _three(block, A, k)
            wx, wy, wz, turn = _four(block, WANTED, k)
            n0, n1, n2, n3 = rates(c, qx, qy, qz, qw, vx, vy, vz, ax, ay, az, wx, wy, wz, turn, weight)
            t0, t1, t2, t3 = n0, n1, n2, n3
            if lagging:
                s0, s1, s2, s3 = _four(block, SPEED, k)
                n0, n1, n2, n3 = (followed(t0, s0, 1.0, 1.0), followed(t1, s1, 1.0, 1.0), followed(t2, s2, 1.0, 1.0),
                                  followed(t3, s3, 1.0, 1.0))
                t0, t1 = stopped(t0, followed(t0, s0, up, down)), stopped(t1, followed(t1, s1, up, down))
                t2, t3 = stopped(t2, followed(t2, s2, up, down)), stopped(t3, followed(t3, s3, up, down))
            _put(block, SPEED, k, t0, t1, t2)
            block[(SPEED + 3) * LANES + k] = t3
            _, _, _, _, fx, fy, fz, tx, ty, tz = lift(c, qx, qy, qz, qw, n0, n1, n2, n3)
            if dragged:
                x, y, z = rotor_drag(c, qx, qy, qz, qw, n0, n1, n2, n3, vx, vy, vz, dt)
                fx, fy, fz = fx + x, fy + y, fz + z
            fz -= weight * c.mass
            if resisted:
                x, y, z = resistance(qx, qy, qz, qw, vx, vy, vz, half_x, half_y, half_z, c.mass, factor, dt)
                fx, fy, fz = fx - x, fy - y, fz - z
            _put(block, V, k, vx + h * inverse_mass * fx, vy + h * inverse_mass * fy, vz + h * inverse_mass * fz)
            ax, ay, az = spun(matrix(qx, qy, qz, qw), ax, ay, az, tx, ty, tz, c.ix, c.iy, c.iz, h)
            _put(block, A, k, ax, ay, az)
            block[SQUARE * LANES + k] = ax * ax + ay * ay + az * az
    return push


@kernel
def move(block, n, number):
    """Positions and orientations of the first n drones after a sub-step at their velocities."""
    h, fast = number[H], 0
    most = LITTLE / (0.25 * h * h)
    for k in range(n):
        px, py, pz = _three(block, P, k)
        vx, vy, vz = _three(block, V, k)
        _put(block, P, k, px + h * vx, py + h * vy, pz + h * vz)
        fast += block[SQUARE * LANES + k] > 0.99 * most
    if fast:
        for k in range(n):
            qx, qy, qz, qw = _four(block, Q, k)
            ax, ay, az = _three(block, A, k)
            qx, qy, qz, qw = turned(qx, qy, qz, qw, ax, ay, az, h)
            _put(block, Q, k, qx, qy, qz)
            block[(Q + 3) * LANES + k] = qw
        return
    for k in range(n):
        qx, qy, qz, qw = _four(block, Q, k)
        ax, ay, az = _three(block, A, k)
        qx, qy, qz, qw = turned_little(qx, qy, qz, qw, ax, ay, az, h)
        _put(block, Q, k, qx, qy, qz)
        block[(Q + 3) * LANES + k] = qw


@kernel
def turn(block, n, number):
    """The rotors' angles after a step."""
    c, dt = craft(number), number[DT]
    for k in range(n):
        s0, s1, s2, s3 = _four(block, SPEED, k)
        a0, a1, a2, a3 = _four(block, ANGLE, k)
        _put(block, ANGLE, k, turned_on(a0, c.s0 * s0, dt), turned_on(a1, c.s1 * s1, dt), turned_on(a2, c.s2 * s2, dt))
        block[(ANGLE + 3) * LANES + k] = turned_on(a3, c.s3 * s3, dt)


@cache
def advance_with(lagging: bool, resisted: bool, dragged: bool, seen: bool) -> Any:
    """The kernel for whole steps; seen: whether the rotors' angles count."""
    push = push_with(lagging, resisted, dragged)

    @kernel
    def advance(table, block, number, substeps, steps):
        """Flies the drones, columns of the table (KEPT, n), by this many steps; block: room for (ROWS * LANES,)."""
        for first in range(0, table.shape[1], LANES):
            n = min(LANES, table.shape[1] - first)
            for r in range(KEPT):
                for k in range(n):
                    block[r * LANES + k] = table[r, first + k]
            for _ in range(steps):
                guide(block, n, number)
                for _ in range(substeps):
                    push(block, n, number)
                    move(block, n, number)
                if seen:
                    turn(block, n, number)
            for r in range(KEPT):
                for k in range(n):
                    table[r, first + k] = block[r * LANES + k]
    return advance
