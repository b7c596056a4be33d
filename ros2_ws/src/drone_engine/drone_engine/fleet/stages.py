"""Kernels of a step that do not depend on the integrator: commands, forces and rotor angles.

Their loops over lanes have no branches, so that the compiler computes several drones per instruction. They call the
same leaf functions as the stages of a World, in the same order: each drone moves bit for bit as in a World of its own.
"""

from drone_engine.effects.drag import resistance
from drone_engine.fleet.layout import (
    COMMAND,
    COMMAND_AGE,
    DT,
    GRAVITY,
    HALF_X,
    HALF_Y,
    HALF_Z,
    HOLD,
    LANES,
    MAX_SPEED,
    MAX_YAW_RATE,
    ORIENTATION,
    POSITION,
    ROTOR_ANGLE,
    ROTOR_SPEED,
    SUBSTEP,
    TARGET,
    VELOCITY,
    load3,
    load4,
    store3,
    store4,
)
from drone_engine.flight.control import lift, rotor_drag
from drone_engine.flight.craft import craft
from drone_engine.flight.pilot import SILENCE, guidance
from drone_engine.flight.rotors import advance_angle
from drone_engine.kernel import inlined, kernel


@kernel
def track_commands(block, n, constants):
    """Target velocities and yaw rates of the first n drones of a block, from their commands, once a step; without a
    command for SILENCE s they hover in place. constants: (CONSTANTS,), see layout.py."""
    dt, max_speed, max_yaw_rate = constants[DT], constants[MAX_SPEED], constants[MAX_YAW_RATE]
    for k in range(n):
        silence = block[COMMAND_AGE * LANES + k] + 1.0
        block[COMMAND_AGE * LANES + k] = silence
        px, py, pz = load3(block, POSITION, k)
        qx, qy, qz, qw = load4(block, ORIENTATION, k)
        vx, vy, vz = load3(block, VELOCITY, k)
        cx, cy, cz, turn = load4(block, COMMAND, k)
        hx, hy, hz = load3(block, HOLD, k)
        wx, wy, wz, turn, hx, hy, hz = guidance(px, py, pz, qx, qy, qz, qw, vx, vy, vz, cx, cy, cz, turn,
                                            silence * dt >= SILENCE, hx, hy, hz, max_speed, max_yaw_rate)
        store4(block, TARGET, k, wx, wy, wz, turn)
        store3(block, HOLD, k, hx, hy, hz)


@inlined
def force_and_torque(c, constants, drag, rotors, qx, qy, qz, qw, vx, vy, vz, n0, n1, n2, n3):
    """Force in N and torque in N m on a drone, both in the world frame (scalars only: a SIMD leaf).

    c: Craft; q: orientation; v: velocity in m/s, world; n0 to n3: rotor speeds in rad/s. drag: 0.5 density coefficient
    of the body's air drag, or None; rotors: None unless the rotors have drag.
    """
    _, _, _, _, fx, fy, fz, tx, ty, tz = lift(c, qx, qy, qz, qw, n0, n1, n2, n3)
    if rotors is not None:
        x, y, z = rotor_drag(c, qx, qy, qz, qw, n0, n1, n2, n3, vx, vy, vz, constants[SUBSTEP])
        fx, fy, fz = fx + x, fy + y, fz + z
    fz -= constants[GRAVITY] * c.mass
    if drag is not None:
        x, y, z = resistance(qx, qy, qz, qw, vx, vy, vz, constants[HALF_X], constants[HALF_Y], constants[HALF_Z],
                             c.mass, drag, constants[SUBSTEP])
        fx, fy, fz = fx - x, fy - y, fz - z
    return fx, fy, fz, tx, ty, tz


@kernel
def rotate_rotors(block, n, constants):
    """Advances the rotor angles of the first n drones of a block by a step."""
    c, dt = craft(constants), constants[DT]
    for k in range(n):
        s0, s1, s2, s3 = load4(block, ROTOR_SPEED, k)
        a0, a1, a2, a3 = load4(block, ROTOR_ANGLE, k)
        store4(block, ROTOR_ANGLE, k, advance_angle(a0, c.s0 * s0, dt), advance_angle(a1, c.s1 * s1, dt),
               advance_angle(a2, c.s2 * s2, dt), advance_angle(a3, c.s3 * s3, dt))
