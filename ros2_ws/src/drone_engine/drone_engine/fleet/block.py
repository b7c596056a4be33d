"""Blocks of drones that touch nothing: tables with a column for each drone.

The loops over columns have no branches, so that the compiler takes eight drones in each step (structure of arrays).
The leaves are those of a World's stages, in the same order: each drone flies, bit for bit, as in a World of its own.
"""

from drone_engine.effects.drag import resistance
from drone_engine.flight.control import lift, rotor_drag
from drone_engine.flight.craft import SIZE, craft
from drone_engine.flight.pilot import SILENCE, wish
from drone_engine.flight.rotors import turned_on
from drone_engine.kernel import inlined, kernel

LANES = 16  # drones of a block, which stays in the fastest cache with all its rows
# First rows of what is kept: position, orientation, velocity, angular velocity, the rotors' rates and angles, the
# command, steps since it came, where the drone holds, and the velocity and push that it expects.
P, Q, V, A, SPEED, ANGLE, COMMAND, SILENT, HOLD, EXPECTED, PUSH, KEPT = 0, 3, 7, 10, 13, 17, 21, 25, 26, 29, 32, 35
# And of what is forgotten after a step: the wanted velocity and yaw rate; what the rotors are told, and their rates at
# the beginning of a sub-step; orientation and velocity half a sub-step ahead; torque, angular velocity and the next
# one in the body frame; squared angular velocity, or 1 where the next is not found yet.
WANTED, TOLD, START, Q_HALF, V_HALF, TORQUE, SPIN, NEXT, MARK, ROWS = 35, 39, 43, 47, 51, 54, 57, 60, 63, 64
# Where the numbers stand that all drones share, after those of a Craft.
(WEIGHT, H, DT, INVERSE_MASS, MAX_SPEED, MAX_YAW_RATE, HALF_X, HALF_Y, HALF_Z, SHARED) = range(SIZE, SIZE + 10)


@inlined
def three(block, row, k):
    """Column k's numbers from a row on."""
    return block[row * LANES + k], block[(row + 1) * LANES + k], block[(row + 2) * LANES + k]


@inlined
def four(block, row, k):
    return (block[row * LANES + k], block[(row + 1) * LANES + k], block[(row + 2) * LANES + k],
            block[(row + 3) * LANES + k])


@inlined
def put(block, row, k, a, b, c):
    """Writes three numbers into column k from a row on."""
    block[row * LANES + k], block[(row + 1) * LANES + k], block[(row + 2) * LANES + k] = a, b, c


@inlined
def put_four(block, row, k, a, b, c, d):
    put(block, row, k, a, b, c)
    block[(row + 3) * LANES + k] = d


@kernel
def guide(block, n, number):
    """What the first n drones of a block want in this step."""
    dt, max_speed, max_yaw_rate = number[DT], number[MAX_SPEED], number[MAX_YAW_RATE]
    for k in range(n):
        silence = block[SILENT * LANES + k] + 1.0
        block[SILENT * LANES + k] = silence
        px, py, pz = three(block, P, k)
        qx, qy, qz, qw = four(block, Q, k)
        vx, vy, vz = three(block, V, k)
        cx, cy, cz, turn = four(block, COMMAND, k)
        hx, hy, hz = three(block, HOLD, k)
        wx, wy, wz, turn, hx, hy, hz = wish(px, py, pz, qx, qy, qz, qw, vx, vy, vz, cx, cy, cz, turn,
                                            silence * dt >= SILENCE, hx, hy, hz, max_speed, max_yaw_rate)
        put_four(block, WANTED, k, wx, wy, wz, turn)
        put(block, HOLD, k, hx, hy, hz)


@inlined
def act(c, number, drag, rotors, qx, qy, qz, qw, vx, vy, vz, n0, n1, n2, n3):
    """Force and torque on a drone whose rotors turn at n, world. drag: the factor of its body's, or None; rotors: not
    None where theirs counts."""
    _, _, _, _, fx, fy, fz, tx, ty, tz = lift(c, qx, qy, qz, qw, n0, n1, n2, n3)
    if rotors is not None:
        x, y, z = rotor_drag(c, qx, qy, qz, qw, n0, n1, n2, n3, vx, vy, vz, number[H])
        fx, fy, fz = fx + x, fy + y, fz + z
    fz -= number[WEIGHT] * c.mass
    if drag is not None:
        x, y, z = resistance(qx, qy, qz, qw, vx, vy, vz, number[HALF_X], number[HALF_Y], number[HALF_Z], c.mass, drag,
                             number[H])
        fx, fy, fz = fx - x, fy - y, fz - z
    return fx, fy, fz, tx, ty, tz


@kernel
def turn(block, n, number):
    """The rotors' angles after a step."""
    c, dt = craft(number), number[DT]
    for k in range(n):
        s0, s1, s2, s3 = four(block, SPEED, k)
        a0, a1, a2, a3 = four(block, ANGLE, k)
        put_four(block, ANGLE, k, turned_on(a0, c.s0 * s0, dt), turned_on(a1, c.s1 * s1, dt),
                 turned_on(a2, c.s2 * s2, dt), turned_on(a3, c.s3 * s3, dt))
