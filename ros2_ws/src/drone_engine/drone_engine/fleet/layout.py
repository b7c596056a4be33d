"""Rows of a block of drones, and access to them.

A block is a flat array of BLOCK_ROWS rows with LANES columns, one drone a column (structure of arrays). Row r of lane k
is block[r * LANES + k]. The first STATE_ROWS rows are kept from step to step; the others are scratch within a step.
"""

from drone_engine.flight.craft import SIZE
from drone_engine.kernel import inlined

LANES = 16  # drones of a block: with all its rows, it stays in the fastest cache

# First row of each quantity of the state.
POSITION = 0  # 3 rows, m, world
ORIENTATION = 3  # 4 rows, quaternion x y z w
VELOCITY = 7  # 3 rows, m/s, world
ANGULAR_VELOCITY = 10  # 3 rows, rad/s, world
ROTOR_SPEED = 13  # 4 rows, rad/s
ROTOR_ANGLE = 17  # 4 rows, rad
COMMAND = 21  # 4 rows: forward, left, up in m/s; yaw rate in rad/s
COMMAND_AGE = 25  # 1 row, steps since the latest command
HOLD = 26  # 3 rows, m, world: where a drone without commands hovers; NaN until it has stopped
EXPECTED_VELOCITY = 29  # 3 rows, m/s: state of the observer in flight/control.py; NaN before its first step
DISTURBANCE = 32  # 3 rows, m/s^2: acceleration by unknown forces, estimated by that observer
STATE_ROWS = 35

# First row of each quantity of the scratch.
TARGET = 35  # 4 rows: velocity in m/s, world; yaw rate in rad/s
COMMANDED_SPEED = 39  # 4 rows, rad/s: rotor speeds set by the controller
START_SPEED = 43  # 4 rows, rad/s: rotor speeds at the start of the sub-step
HALF_ORIENTATION = 47  # 4 rows: orientation in the middle of the sub-step
HALF_VELOCITY = 51  # 3 rows, m/s: velocity in the middle of the sub-step
TORQUE = 54  # 3 rows, N m, body
BODY_RATE = 57  # 3 rows, rad/s: angular velocity in the body frame
NEXT_BODY_RATE = 60  # 3 rows, rad/s: the same at the end of the sub-step
FLAG = 63  # 1 row: squared angular velocity (Euler); 1 until Newton's method has converged (midpoint)
BLOCK_ROWS = 64

# Indices of the constants that all drones share, after the SIZE numbers of a Craft.
(GRAVITY, SUBSTEP, DT, INVERSE_MASS, MAX_SPEED, MAX_YAW_RATE, HALF_X, HALF_Y, HALF_Z,
 CONSTANTS) = range(SIZE, SIZE + 10)


@inlined
def load3(block, row, k):
    """Three rows of lane k, from `row` on."""
    return block[row * LANES + k], block[(row + 1) * LANES + k], block[(row + 2) * LANES + k]


@inlined
def load4(block, row, k):
    """Four rows of lane k, from `row` on."""
    return (block[row * LANES + k], block[(row + 1) * LANES + k], block[(row + 2) * LANES + k],
            block[(row + 3) * LANES + k])


@inlined
def store3(block, row, k, a, b, c):
    """Writes three rows of lane k, from `row` on."""
    block[row * LANES + k], block[(row + 1) * LANES + k], block[(row + 2) * LANES + k] = a, b, c


@inlined
def store4(block, row, k, a, b, c, d):
    """Writes four rows of lane k, from `row` on."""
    store3(block, row, k, a, b, c)
    block[(row + 3) * LANES + k] = d
