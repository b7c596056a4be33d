"""The integrators of the dynamics, for blocks of drones that touch nothing; one call is one sub-step."""

from drone_engine.dynamics.integrators import (
    NEWTON_ITERATIONS,
    cayley,
    euler_angular_velocity,
    is_slow,
    midpoint_fixed_point,
    midpoint_newton_step,
)
from drone_engine.effects.motor_lag import followed, stopped
from drone_engine.fleet.layout import (
    ANGULAR_VELOCITY,
    BODY_RATE,
    COMMANDED_SPEED,
    DISTURBANCE,
    EXPECTED_VELOCITY,
    FLAG,
    GRAVITY,
    HALF_ORIENTATION,
    HALF_VELOCITY,
    INVERSE_MASS,
    LANES,
    NEXT_BODY_RATE,
    ORIENTATION,
    POSITION,
    ROTOR_SPEED,
    START_SPEED,
    SUBSTEP,
    TARGET,
    TORQUE,
    VELOCITY,
    load3,
    load4,
    store3,
    store4,
)
from drone_engine.fleet.stages import force_and_torque
from drone_engine.flight.control import rates
from drone_engine.flight.craft import craft
from drone_engine.kernel import inlined, kernel
from drone_engine.math.rotation import (
    SERIES_LIMIT,
    integrate_rotation,
    integrate_small_rotation,
    matrix,
    rotate,
)


@inlined
def control_rotors(block, k, c, gravity, lag, qx, qy, qz, qw, vx, vy, vz):
    """Rotor speeds at the start of a sub-step, rad/s, by the control loops of the drone in lane k.

    Writes the speeds at the end of the sub-step, and the observer's state, into the block. c: Craft; gravity: m/s^2;
    lag: (substeps + 1, 2) as in `advance`, or None; q, v: orientation and velocity.
    """
    ax, ay, az = load3(block, ANGULAR_VELOCITY, k)
    wx, wy, wz, yaw_rate = load4(block, TARGET, k)
    ex, ey, ez = load3(block, EXPECTED_VELOCITY, k)
    px, py, pz = load3(block, DISTURBANCE, k)
    t0, t1, t2, t3, ex, ey, ez, px, py, pz = rates(c, qx, qy, qz, qw, vx, vy, vz, ax, ay, az, wx, wy, wz, yaw_rate,
                                                   ex, ey, ez, px, py, pz, gravity)
    store3(block, EXPECTED_VELOCITY, k, ex, ey, ez)
    store3(block, DISTURBANCE, k, px, py, pz)
    if lag is None:
        store4(block, ROTOR_SPEED, k, t0, t1, t2, t3)
        return t0, t1, t2, t3
    up, down = lag[0, 0], lag[0, 1]
    s0, s1, s2, s3 = load4(block, ROTOR_SPEED, k)
    store4(block, COMMANDED_SPEED, k, t0, t1, t2, t3)
    store4(block, START_SPEED, k, s0, s1, s2, s3)
    store4(block, ROTOR_SPEED, k, stopped(t0, followed(t0, s0, up, down)), stopped(t1, followed(t1, s1, up, down)),
           stopped(t2, followed(t2, s2, up, down)), stopped(t3, followed(t3, s3, up, down)))
    return (followed(t0, s0, 1.0, 1.0), followed(t1, s1, 1.0, 1.0), followed(t2, s2, 1.0, 1.0),
            followed(t3, s3, 1.0, 1.0))


@kernel
def euler(block, n, constants, lag, drag, rotors):
    """Moves the first n drones of a block by a sub-step: semi-implicit Euler. Arguments as in `advance`."""
    c, gravity, h, inverse_mass = craft(constants), constants[GRAVITY], constants[SUBSTEP], constants[INVERSE_MASS]
    for k in range(n):
        qx, qy, qz, qw = load4(block, ORIENTATION, k)
        vx, vy, vz = load3(block, VELOCITY, k)
        n0, n1, n2, n3 = control_rotors(block, k, c, gravity, lag, qx, qy, qz, qw, vx, vy, vz)
        fx, fy, fz, tx, ty, tz = force_and_torque(c, constants, drag, rotors, qx, qy, qz, qw, vx, vy, vz,
                                                  n0, n1, n2, n3)
        vx, vy, vz = vx + h * inverse_mass * fx, vy + h * inverse_mass * fy, vz + h * inverse_mass * fz
        ax, ay, az = load3(block, ANGULAR_VELOCITY, k)
        ax, ay, az = euler_angular_velocity(matrix(qx, qy, qz, qw), c.ix, c.iy, c.iz, ax, ay, az, tx, ty, tz, h)
        store3(block, VELOCITY, k, vx, vy, vz)
        store3(block, ANGULAR_VELOCITY, k, ax, ay, az)
        block[FLAG * LANES + k] = ax * ax + ay * ay + az * az
    fast, most = 0, 0.99 * SERIES_LIMIT / (0.25 * h * h)
    for k in range(n):
        px, py, pz = load3(block, POSITION, k)
        vx, vy, vz = load3(block, VELOCITY, k)
        store3(block, POSITION, k, px + h * vx, py + h * vy, pz + h * vz)
        fast += block[FLAG * LANES + k] > most
    if fast == 0:
        for k in range(n):
            qx, qy, qz, qw = load4(block, ORIENTATION, k)
            ax, ay, az = load3(block, ANGULAR_VELOCITY, k)
            qx, qy, qz, qw = integrate_small_rotation(qx, qy, qz, qw, ax, ay, az, h)
            store4(block, ORIENTATION, k, qx, qy, qz, qw)
    else:
        for k in range(n):
            qx, qy, qz, qw = load4(block, ORIENTATION, k)
            ax, ay, az = load3(block, ANGULAR_VELOCITY, k)
            qx, qy, qz, qw = integrate_rotation(qx, qy, qz, qw, ax, ay, az, h)
            store4(block, ORIENTATION, k, qx, qy, qz, qw)


@kernel
def midpoint(block, n, constants, lag, drag, rotors, sub):
    """Moves the first n drones of a block by sub-step `sub` of the step: midpoint rule. Arguments as in `advance`."""
    c, gravity, h, inverse_mass = craft(constants), constants[GRAVITY], constants[SUBSTEP], constants[INVERSE_MASS]
    half = 0.5 * h
    for k in range(n):
        qx, qy, qz, qw = load4(block, ORIENTATION, k)
        vx, vy, vz = load3(block, VELOCITY, k)
        n0, n1, n2, n3 = control_rotors(block, k, c, gravity, lag, qx, qy, qz, qw, vx, vy, vz)
        fx, fy, fz, _, _, _ = force_and_torque(c, constants, drag, rotors, qx, qy, qz, qw, vx, vy, vz,
                                                  n0, n1, n2, n3)
        store3(block, HALF_VELOCITY, k, vx + half * inverse_mass * fx, vy + half * inverse_mass * fy,
               vz + half * inverse_mass * fz)
        ax, ay, az = load3(block, ANGULAR_VELOCITY, k)
        wx, wy, wz = rotate(-qx, -qy, -qz, qw, ax, ay, az)
        store3(block, BODY_RATE, k, wx, wy, wz)
        hx, hy, hz, hw = cayley(qx, qy, qz, qw, wx, wy, wz, half)
        store4(block, HALF_ORIENTATION, k, hx, hy, hz, hw)
    for k in range(n):
        n0, n1, n2, n3 = load4(block, ROTOR_SPEED, k)
        if lag is not None:
            up, down = lag[1 + sub, 0], lag[1 + sub, 1]
            t0, t1, t2, t3 = load4(block, COMMANDED_SPEED, k)
            s0, s1, s2, s3 = load4(block, START_SPEED, k)
            n0, n1 = followed(t0, s0, up, down), followed(t1, s1, up, down)
            n2, n3 = followed(t2, s2, up, down), followed(t3, s3, up, down)
        qx, qy, qz, qw = load4(block, HALF_ORIENTATION, k)
        vx, vy, vz = load3(block, HALF_VELOCITY, k)
        fx, fy, fz, tx, ty, tz = force_and_torque(c, constants, drag, rotors, qx, qy, qz, qw, vx, vy, vz,
                                                  n0, n1, n2, n3)
        tx, ty, tz = rotate(-qx, -qy, -qz, qw, tx, ty, tz)
        store3(block, TORQUE, k, tx, ty, tz)
        wx, wy, wz = load3(block, BODY_RATE, k)
        bx, by, bz = midpoint_fixed_point(c.ix, c.iy, c.iz, wx, wy, wz, tx, ty, tz, h)
        found = is_slow(wx, wy, wz, h)
        store3(block, NEXT_BODY_RATE, k, bx if found else wx + h / c.ix * tx, by if found else wy + h / c.iy * ty,
               bz if found else wz + h / c.iz * tz)
        block[FLAG * LANES + k] = 0.0 if found else 1.0
        ox, oy, oz = load3(block, VELOCITY, k)
        vx, vy, vz = ox + h * inverse_mass * fx, oy + h * inverse_mass * fy, oz + h * inverse_mass * fz
        store3(block, VELOCITY, k, vx, vy, vz)
        px, py, pz = load3(block, POSITION, k)
        store3(block, POSITION, k, px + half * (ox + vx), py + half * (oy + vy), pz + half * (oz + vz))
    for _ in range(NEWTON_ITERATIONS):
        missing = 0.0
        for k in range(n):
            missing += block[FLAG * LANES + k]
        if missing == 0.0:
            break
        for k in range(n):
            wx, wy, wz = load3(block, BODY_RATE, k)
            bx, by, bz = load3(block, NEXT_BODY_RATE, k)
            tx, ty, tz = load3(block, TORQUE, k)
            x, y, z, found = midpoint_newton_step(c.ix, c.iy, c.iz, wx, wy, wz, tx, ty, tz, h, bx, by, bz)
            found |= block[FLAG * LANES + k] == 0.0
            store3(block, NEXT_BODY_RATE, k, bx if found else x, by if found else y, bz if found else z)
            block[FLAG * LANES + k] = 0.0 if found else 1.0
    for k in range(n):
        qx, qy, qz, qw = load4(block, ORIENTATION, k)
        wx, wy, wz = load3(block, BODY_RATE, k)
        bx, by, bz = load3(block, NEXT_BODY_RATE, k)
        qx, qy, qz, qw = cayley(qx, qy, qz, qw, 0.5 * (wx + bx), 0.5 * (wy + by), 0.5 * (wz + bz), h)
        store4(block, ORIENTATION, k, qx, qy, qz, qw)
        ax, ay, az = rotate(qx, qy, qz, qw, bx, by, bz)
        store3(block, ANGULAR_VELOCITY, k, ax, ay, az)
