"""What every flight model has in common: the velocity that a drone is to have, and whether it has landed.

After SILENCE without a command the drone stops and holds its position; at rest on a support without a command it
lands, and its rotors stop until the next command.
"""

import math

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.context import Context
from drone_engine.kernel import inlined, kernel
from drone_engine.program.stage import Stage

SILENCE = 0.5  # s of simulated time after which a command is over
STILL = 0.1  # m/s under which a drone counts as at rest
HOLD_SPEED = 1.0  # m/s at most, back to the position that is held, at 1 m/s for each m
LEVEL = 1e-12  # squared length of the nose's shadow under which a drone has no heading


@inlined
def limited(x, y, z, limit):
    """The vector, no longer than the limit."""
    length = math.sqrt(x * x + y * y + z * z)
    scale = limit / length if length > limit else 1.0
    return x * scale, y * scale, z * scale


@inlined
def wish(px, py, pz, qx, qy, qz, qw, vx, vy, vz, cx, cy, cz, turn, silent, hx, hy, hz, max_speed, max_yaw_rate):
    """The wanted velocity in the world and yaw rate, and where the drone holds. p, q, v: where it is, orientation and
    velocity; c, turn: the command, which turns with the heading, not with the tilt. No branches."""
    nx, ny = 1.0 - 2.0 * (qy * qy + qz * qz), 2.0 * (qx * qy + qz * qw)  # the nose's shadow
    square = nx * nx + ny * ny
    scale = 1.0 / math.sqrt(square) if square > LEVEL else 0.0
    nx, ny = nx * scale, ny * scale
    arrived = silent & (hx != hx) & (vx * vx + vy * vy + vz * vz < STILL * STILL)
    hx = px if arrived else hx if silent else np.nan
    hy = py if arrived else hy if silent else np.nan
    hz = pz if arrived else hz if silent else np.nan
    holding = hx == hx
    cx, cy, cz = limited(cx, cy, cz, max_speed)
    bx, by, bz = limited(hx - px, hy - py, hz - pz, min(max_speed, HOLD_SPEED))  # back
    yaw_rate = 0.0 if silent else min(max(turn, -max_yaw_rate), max_yaw_rate)
    return (bx if holding else 0.0 if silent else cx * nx - cy * ny,
            by if holding else 0.0 if silent else cx * ny + cy * nx,
            bz if holding else 0.0 if silent else cz, yaw_rate, hx, hy, hz)


@kernel
def guide(position, orientation, velocity, drone_body, max_speed, max_yaw_rate, command, silence, hold, landed, dt,
          wanted):
    """Writes the wanted velocity (m/s, world) and yaw rate (rad/s) of d drones, (d, 4); commands end the landing."""
    for d in range(drone_body.shape[0]):
        i = drone_body[d]
        silent = silence[d] * dt >= SILENCE
        cx, cy, cz, turn = command[d, 0], command[d, 1], command[d, 2], command[d, 3]
        if not silent and (cx != 0.0 or cy != 0.0 or cz > 0.0 or turn != 0.0):
            landed[d] = 0
        p, q, v = position[i], orientation[i], velocity[i]
        wx, wy, wz, yaw_rate, hx, hy, hz = wish(
            p[0], p[1], p[2], q[0], q[1], q[2], q[3], v[0], v[1], v[2], cx, cy, cz, turn, silent,
            hold[d, 0], hold[d, 1], hold[d, 2], max_speed[d], max_yaw_rate[d])
        wanted[d, 0], wanted[d, 1], wanted[d, 2], wanted[d, 3] = wx, wy, wz, yaw_rate
        if not landed[d]:
            hold[d, 0], hold[d, 1], hold[d, 2] = hx, hy, hz


@kernel
def land(velocity, drone_body, command, silence, dt, contacts, landed):
    """Marks drones as landed that rest on something and are not told to leave it."""
    end, pair, points, normal, total = contacts.end, contacts.pair, contacts.points, contacts.normal, contacts.total
    for d in range(drone_body.shape[0]):
        i = drone_body[d]
        silent = silence[d] * dt >= SILENCE
        staying = silent or (command[d, 0] == 0.0 and command[d, 1] == 0.0 and command[d, 2] <= 0.0
                             and command[d, 3] == 0.0)
        speed = math.sqrt(velocity[i, 0] ** 2 + velocity[i, 1] ** 2 + velocity[i, 2] ** 2)
        if not staying or speed > STILL:
            continue
        for c in range(end[-1]):
            up = normal[c, 2] if pair[c, 1] == i else -normal[c, 2]
            if (pair[c, 0] == i or pair[c, 1] == i) and up > 0.7:
                for k in range(points[c]):
                    if total[c, k] > 0.0:
                        landed[d] = 1


def build(context: Context, wanted: Floats) -> Stage:
    """The stage that turns commands into wanted velocities; wanted: (d, 4), written."""
    return context.stage("pilot", guide, wanted=wanted)


def build_landing(context: Context) -> Stage:
    """The stage, after the motion, that detects which drones have landed."""
    return context.stage("landing", land)
