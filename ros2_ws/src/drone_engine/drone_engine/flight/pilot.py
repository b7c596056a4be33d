"""The part that all flight models share: the wanted velocity of a drone, and whether it has landed.

After SILENCE without a command the drone stops and holds its position. At rest on a support and without a command it
lands, and its rotors stop until the next command.
"""

import math

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.context import Context
from drone_engine.kernel import inlined, kernel
from drone_engine.program.stage import Stage

SILENCE = 0.5  # s of simulated time after which a command times out
STILL = 0.1  # m/s below which a drone counts as at rest
HOLD_SPEED = 1.0  # m/s, largest speed back to the held position; below it, 1 m/s per m of distance
NO_HEADING = 1e-12  # squared horizontal length of the body's x axis below which a drone has no heading


@inlined
def limited(x, y, z, limit):
    """The vector (x, y, z), shortened to the limit if it is longer."""
    length = math.sqrt(x * x + y * y + z * z)
    scale = limit / length if length > limit else 1.0
    return x * scale, y * scale, z * scale


@inlined
def guidance(px, py, pz, qx, qy, qz, qw, vx, vy, vz, cx, cy, cz, turn, silent, hx, hy, hz, max_speed, max_yaw_rate):
    """The wanted velocity (m/s, world), yaw rate (rad/s) and hold position (m; NaN: none): seven numbers.

    p, q, v: position, orientation x y z w and velocity in the world; c, turn: commanded velocity in the heading frame
    (m/s) and yaw rate (rad/s); silent: whether the command has timed out; h: hold position. Scalars only and no
    branches: a SIMD leaf.
    """
    # Heading: the body's x axis, projected on the ground plane.
    nx, ny = 1.0 - 2.0 * (qy * qy + qz * qz), 2.0 * (qx * qy + qz * qw)
    square = nx * nx + ny * ny
    scale = 1.0 / math.sqrt(square) if square > NO_HEADING else 0.0
    nx, ny = nx * scale, ny * scale
    arrived = silent & (hx != hx) & (vx * vx + vy * vy + vz * vz < STILL * STILL)
    hx = px if arrived else hx if silent else np.nan
    hy = py if arrived else hy if silent else np.nan
    hz = pz if arrived else hz if silent else np.nan
    holding = hx == hx
    cx, cy, cz = limited(cx, cy, cz, max_speed)
    bx, by, bz = limited(hx - px, hy - py, hz - pz, min(max_speed, HOLD_SPEED))  # towards the hold position
    yaw_rate = 0.0 if silent else min(max(turn, -max_yaw_rate), max_yaw_rate)
    return (bx if holding else 0.0 if silent else cx * nx - cy * ny,
            by if holding else 0.0 if silent else cx * ny + cy * nx,
            bz if holding else 0.0 if silent else cz, yaw_rate, hx, hy, hz)


@kernel
def command_to_velocity(position, orientation, velocity, drone_body, max_speed, max_yaw_rate, command, silence, hold,
                        landed, dt, wanted):
    """Writes the wanted velocity (m/s, world) and yaw rate (rad/s) of d drones, wanted (d, 4).

    position, orientation, velocity: (n, 3), (n, 4), (n, 3) of bodies in the world; drone_body: (d,); max_speed (m/s)
    and max_yaw_rate (rad/s): (d,); command: (d, 4) in the heading frame; silence: (d,) steps since it came; dt: s.
    Updates hold (d, 3), m, and ends landed (d,) for a command that moves the drone.
    """
    for d in range(drone_body.shape[0]):
        i = drone_body[d]
        silent = silence[d] * dt >= SILENCE
        cx, cy, cz, turn = command[d, 0], command[d, 1], command[d, 2], command[d, 3]
        if not silent and (cx != 0.0 or cy != 0.0 or cz > 0.0 or turn != 0.0):
            landed[d] = 0
        p, q, v = position[i], orientation[i], velocity[i]
        wx, wy, wz, yaw_rate, hx, hy, hz = guidance(
            p[0], p[1], p[2], q[0], q[1], q[2], q[3], v[0], v[1], v[2], cx, cy, cz, turn, silent,
            hold[d, 0], hold[d, 1], hold[d, 2], max_speed[d], max_yaw_rate[d])
        wanted[d, 0], wanted[d, 1], wanted[d, 2], wanted[d, 3] = wx, wy, wz, yaw_rate
        if not landed[d]:
            hold[d, 0], hold[d, 1], hold[d, 2] = hx, hy, hz


@kernel
def detect_landing(velocity, drone_body, command, silence, dt, contacts, landed):
    """Sets landed (d,) for drones that rest on a support and have no command to leave it.

    velocity: (n, 3) m/s; drone_body: (d,); command: (d, 4); silence: (d,) steps; dt: s; contacts: ContactArrays.
    """
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
    return context.stage("pilot", command_to_velocity, wanted=wanted)


def build_landing(context: Context) -> Stage:
    """The stage, after the motion, that detects which drones have landed."""
    return context.stage("landing", detect_landing)
