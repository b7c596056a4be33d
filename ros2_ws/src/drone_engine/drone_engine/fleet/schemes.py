"""The integrators of dynamics/schemes.py for blocks of drones, and the loop over blocks and steps."""

import math

import numpy as np

from drone_engine.dynamics.integrators import NEWTON, nearer, slow, spun_euler, spun_slow, turned_midpoint
from drone_engine.effects.motor_lag import followed, stopped
from drone_engine.fleet.block import (
    COMMAND,
    EXPECTED,
    INVERSE_MASS,
    KEPT,
    LANES,
    MARK,
    NEXT,
    PUSH,
    Q_HALF,
    SILENT,
    SPEED,
    SPIN,
    START,
    TOLD,
    TORQUE,
    V_HALF,
    WANTED,
    WEIGHT,
    A,
    H,
    P,
    Q,
    V,
    act,
    four,
    guide,
    put,
    put_four,
    three,
    turn,
)
from drone_engine.flight.control import rates
from drone_engine.flight.craft import craft
from drone_engine.kernel import inlined, kernel
from drone_engine.math.rotation import SERIES_LIMIT, integrate_rotation, integrate_small_rotation, matrix, rotate


@inlined
def steer(block, k, c, weight, lag, qx, qy, qz, qw, vx, vy, vz):
    """What the rotors are told, and their rates at the end of the sub-step into the block; returns those at its
    beginning. lag: (substeps + 1, 2) as `advance` has it, or None."""
    ax, ay, az = three(block, A, k)
    wx, wy, wz, yaw_rate = four(block, WANTED, k)
    ex, ey, ez = three(block, EXPECTED, k)
    px, py, pz = three(block, PUSH, k)
    t0, t1, t2, t3, ex, ey, ez, px, py, pz = rates(c, qx, qy, qz, qw, vx, vy, vz, ax, ay, az, wx, wy, wz, yaw_rate,
                                                   ex, ey, ez, px, py, pz, weight)
    put(block, EXPECTED, k, ex, ey, ez)
    put(block, PUSH, k, px, py, pz)
    if lag is None:
        put_four(block, SPEED, k, t0, t1, t2, t3)
        return t0, t1, t2, t3
    up, down = lag[0, 0], lag[0, 1]
    s0, s1, s2, s3 = four(block, SPEED, k)
    put_four(block, TOLD, k, t0, t1, t2, t3)
    put_four(block, START, k, s0, s1, s2, s3)
    put_four(block, SPEED, k, stopped(t0, followed(t0, s0, up, down)), stopped(t1, followed(t1, s1, up, down)),
             stopped(t2, followed(t2, s2, up, down)), stopped(t3, followed(t3, s3, up, down)))
    return (followed(t0, s0, 1.0, 1.0), followed(t1, s1, 1.0, 1.0), followed(t2, s2, 1.0, 1.0),
            followed(t3, s3, 1.0, 1.0))


@kernel
def euler(block, n, number, lag, drag, rotors):
    """Moves the first n drones of a block by a sub-step: semi-implicit Euler."""
    c, weight, h, inverse_mass = craft(number), number[WEIGHT], number[H], number[INVERSE_MASS]
    for k in range(n):
        qx, qy, qz, qw = four(block, Q, k)
        vx, vy, vz = three(block, V, k)
        n0, n1, n2, n3 = steer(block, k, c, weight, lag, qx, qy, qz, qw, vx, vy, vz)
        fx, fy, fz, tx, ty, tz = act(c, number, drag, rotors, qx, qy, qz, qw, vx, vy, vz, n0, n1, n2, n3)
        vx, vy, vz = vx + h * inverse_mass * fx, vy + h * inverse_mass * fy, vz + h * inverse_mass * fz
        ax, ay, az = three(block, A, k)
        ax, ay, az = spun_euler(matrix(qx, qy, qz, qw), c.ix, c.iy, c.iz, ax, ay, az, tx, ty, tz, h)
        put(block, V, k, vx, vy, vz)
        put(block, A, k, ax, ay, az)
        block[MARK * LANES + k] = ax * ax + ay * ay + az * az
    fast, most = 0, 0.99 * SERIES_LIMIT / (0.25 * h * h)
    for k in range(n):
        px, py, pz = three(block, P, k)
        vx, vy, vz = three(block, V, k)
        put(block, P, k, px + h * vx, py + h * vy, pz + h * vz)
        fast += block[MARK * LANES + k] > most
    if fast == 0:
        for k in range(n):
            qx, qy, qz, qw = four(block, Q, k)
            ax, ay, az = three(block, A, k)
            qx, qy, qz, qw = integrate_small_rotation(qx, qy, qz, qw, ax, ay, az, h)
            put_four(block, Q, k, qx, qy, qz, qw)
    else:
        for k in range(n):
            qx, qy, qz, qw = four(block, Q, k)
            ax, ay, az = three(block, A, k)
            qx, qy, qz, qw = integrate_rotation(qx, qy, qz, qw, ax, ay, az, h)
            put_four(block, Q, k, qx, qy, qz, qw)


@kernel
def midpoint(block, n, number, lag, drag, rotors, sub):
    """The same by the midpoint rule; sub: which sub-step of the step."""
    c, weight, h, inverse_mass = craft(number), number[WEIGHT], number[H], number[INVERSE_MASS]
    half = 0.5 * h
    for k in range(n):
        qx, qy, qz, qw = four(block, Q, k)
        vx, vy, vz = three(block, V, k)
        n0, n1, n2, n3 = steer(block, k, c, weight, lag, qx, qy, qz, qw, vx, vy, vz)
        fx, fy, fz, _, _, _ = act(c, number, drag, rotors, qx, qy, qz, qw, vx, vy, vz, n0, n1, n2, n3)
        put(block, V_HALF, k, vx + half * inverse_mass * fx, vy + half * inverse_mass * fy,
            vz + half * inverse_mass * fz)
        ax, ay, az = three(block, A, k)
        wx, wy, wz = rotate(-qx, -qy, -qz, qw, ax, ay, az)
        put(block, SPIN, k, wx, wy, wz)
        hx, hy, hz, hw = turned_midpoint(qx, qy, qz, qw, wx, wy, wz, half)
        put_four(block, Q_HALF, k, hx, hy, hz, hw)
    for k in range(n):
        n0, n1, n2, n3 = four(block, SPEED, k)
        if lag is not None:
            up, down = lag[1 + sub, 0], lag[1 + sub, 1]
            t0, t1, t2, t3 = four(block, TOLD, k)
            s0, s1, s2, s3 = four(block, START, k)
            n0, n1 = followed(t0, s0, up, down), followed(t1, s1, up, down)
            n2, n3 = followed(t2, s2, up, down), followed(t3, s3, up, down)
        qx, qy, qz, qw = four(block, Q_HALF, k)
        vx, vy, vz = three(block, V_HALF, k)
        fx, fy, fz, tx, ty, tz = act(c, number, drag, rotors, qx, qy, qz, qw, vx, vy, vz, n0, n1, n2, n3)
        tx, ty, tz = rotate(-qx, -qy, -qz, qw, tx, ty, tz)
        put(block, TORQUE, k, tx, ty, tz)
        wx, wy, wz = three(block, SPIN, k)
        bx, by, bz = spun_slow(c.ix, c.iy, c.iz, wx, wy, wz, tx, ty, tz, h)
        found = slow(wx, wy, wz, h)
        put(block, NEXT, k, bx if found else wx + h / c.ix * tx, by if found else wy + h / c.iy * ty,
            bz if found else wz + h / c.iz * tz)
        block[MARK * LANES + k] = 0.0 if found else 1.0
        ox, oy, oz = three(block, V, k)
        vx, vy, vz = ox + h * inverse_mass * fx, oy + h * inverse_mass * fy, oz + h * inverse_mass * fz
        put(block, V, k, vx, vy, vz)
        px, py, pz = three(block, P, k)
        put(block, P, k, px + half * (ox + vx), py + half * (oy + vy), pz + half * (oz + vz))
    for _ in range(NEWTON):
        missing = 0.0
        for k in range(n):
            missing += block[MARK * LANES + k]
        if missing == 0.0:
            break
        for k in range(n):
            wx, wy, wz = three(block, SPIN, k)
            bx, by, bz = three(block, NEXT, k)
            tx, ty, tz = three(block, TORQUE, k)
            x, y, z, found = nearer(c.ix, c.iy, c.iz, wx, wy, wz, tx, ty, tz, h, bx, by, bz)
            found |= block[MARK * LANES + k] == 0.0
            put(block, NEXT, k, bx if found else x, by if found else y, bz if found else z)
            block[MARK * LANES + k] = 0.0 if found else 1.0
    for k in range(n):
        qx, qy, qz, qw = four(block, Q, k)
        wx, wy, wz = three(block, SPIN, k)
        bx, by, bz = three(block, NEXT, k)
        qx, qy, qz, qw = turned_midpoint(qx, qy, qz, qw, 0.5 * (wx + bx), 0.5 * (wy + by), 0.5 * (wz + bz), h)
        put_four(block, Q, k, qx, qy, qz, qw)
        ax, ay, az = rotate(qx, qy, qz, qw, bx, by, bz)
        put(block, A, k, ax, ay, az)


@kernel
def advance(table, block, number, lag, drag, rotors, seen, second_order, substeps, steps):
    """Flies the drones, columns of the table (KEPT, n), by this many steps; block: room for (ROWS * LANES,).

    number: (SHARED,) what all have in common. lag: (substeps + 1, 2), how much of a difference in the rotors' rates is
    left after a sub-step and after half of each, speeding up and slowing down; drag: factor; rotors, seen: whether
    their drag, and their angles count. What is None is not compiled.
    """
    for first in range(0, table.shape[1], LANES):
        n = min(LANES, table.shape[1] - first)
        for r in range(KEPT):
            for k in range(n):
                block[r * LANES + k] = table[r, first + k]
        for _ in range(steps):
            guide(block, n, number)
            for sub in range(substeps):
                if second_order is None:
                    euler(block, n, number, lag, drag, rotors)
                else:
                    midpoint(block, n, number, lag, drag, rotors, sub)
            if seen is not None:
                turn(block, n, number)
        for r in range(KEPT):
            for k in range(n):
                table[r, first + k] = block[r * LANES + k]


@kernel
def tell(table, command, limit):
    """Gives each drone its command, row of (n, 4), or all the one of (1, 4); False, and none, if one is not finite."""
    if not np.isfinite(command).all():
        return False
    for k in range(table.shape[1]):
        for c in range(4):
            table[COMMAND + c, k] = min(max(command[k % command.shape[0], c], -limit), limit)
        table[SILENT, k] = -1.0  # which the next step makes 0
    return True


@kernel
def left_over(h, substeps, up, down, lag):
    """Writes what `advance` needs to know of the rotors' lag, as a World's stages reckon it."""
    lag[0, 0], lag[0, 1] = math.exp(-h / up), math.exp(-h / down)
    for sub in range(substeps):
        t = (sub + 0.5) * h - sub * h
        lag[1 + sub, 0], lag[1 + sub, 1] = math.exp(-t / up), math.exp(-t / down)
