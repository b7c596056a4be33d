"""Cascaded control of a quadrotor, from the wanted velocity to rotor rates, and the forces of the rotors.

The cascade is that of PX4 and of Lee, Leok and McClamroch 2010 (Geometric Tracking Control of a Quadrotor UAV on
SE(3)): the wanted acceleration gives the thrust and the wanted direction of the body's z axis, the error of that axis
gives the wanted body rates, and the error of the rates gives the torque. All functions take and return numbers and
have no branches, so that the compiler can vectorize loops over many drones. Frames: _w the world, _b the body.
"""

import math

from drone_engine.effects import STABLE
from drone_engine.kernel import inlined
from drone_engine.math.rotation import matrix

MAX_VERTICAL = 0.95  # largest share of max_acceleration for the vertical, which has priority over the horizontal
MIN_LIFT = 2.0  # m/s^2 of upward thrust per mass that is always kept, so that the attitude can be controlled
MAX_TILT_RATE = 5.0  # rad/s, of roll and of pitch
HALF_RATE_YAW = 4.0  # rad/s, yaw rate at which the limit of roll and pitch is half: a fast spin resists tilting
UPSIDE_DOWN = 0.02  # 1 + cos(error of the z axis) below which the drone counts as upside down
JUMP = 2.0  # m/s between two controls: more is a collision or a new position, not a disturbance to estimate


@inlined
def rates(c, qx, qy, qz, qw, vx, vy, vz, ax, ay, az, wx, wy, wz, yaw_rate, ex, ey, ez, px, py, pz, weight):
    """The commanded rates of the four rotors (rad/s), and e and p for the next call.

    c: Craft; q: orientation x y z w; v, a: velocity (m/s) and angular velocity (rad/s); w, yaw_rate: the wanted ones;
    e: predicted velocity (m/s; NaN: none); p: estimated disturbance, the acceleration by other forces than thrust and
    weight (m/s^2); weight: gravity to carry (m/s^2). All vectors in the world. Scalars only: a SIMD leaf.
    """
    m = matrix(qx, qy, qz, qw)
    ex, ey, ez = vx - ex, vy - ey, vz - ez
    lost = not ex * ex + ey * ey + ez * ez < JUMP * JUMP
    px, py, pz = 0.0 if lost else px, 0.0 if lost else py, 0.0 if lost else pz
    ex, ey, ez = 0.0 if lost else ex, 0.0 if lost else ey, 0.0 if lost else ez
    thrust, tx, ty, tz = loops(c, m, vx, vy, vz, m[0] * ax + m[3] * ay + m[6] * az,
                               m[1] * ax + m[4] * ay + m[7] * az, m[2] * ax + m[5] * ay + m[8] * az,
                               wx, wy, wz, yaw_rate, px, py, pz, weight)
    f0, f1, f2, f3 = mix(c, thrust, tx, ty, tz)

    # Disturbance observer: the velocity that thrust and weight do not explain is due to another force.
    lifted = c.per_mass * (f0 + f1 + f2 + f3)
    k, u = c.h, c.watch_velocity
    nx = vx - ex + k * (lifted * m[2] + px) + u * ex
    ny = vy - ey + k * (lifted * m[5] + py) + u * ey
    nz = vz - ez + k * (lifted * m[8] - weight + pz) + u * ez
    k, u = c.watch_push, c.most_push
    px, py, pz = (min(max(px + k * ex, -u), u), min(max(py + k * ey, -u), u), min(max(pz + k * ez, -u), u))
    k = c.per_coefficient
    return math.sqrt(k * f0), math.sqrt(k * f1), math.sqrt(k * f2), math.sqrt(k * f3), nx, ny, nz, px, py, pz


@inlined
def loops(c, m, vx, vy, vz, bx, by, bz, wx, wy, wz, yaw_rate, px, py, pz, weight):
    """Thrust (N) and torques about the body's axes (N m).

    c: Craft; m: rotation matrix, row by row; v, w: velocity and wanted velocity, m/s, world; b: body rates, rad/s; p:
    disturbance to cancel, weight: gravity to carry, both m/s^2. Scalars only: a SIMD leaf.
    """
    k, most = c.velocity_gain, c.max_acceleration
    fx, fy, fz = k * (wx - vx), k * (wy - vy), min(max(k * (wz - vz), -MAX_VERTICAL * most), MAX_VERTICAL * most)
    across, reach = math.sqrt(fx * fx + fy * fy), math.sqrt(most * most - fz * fz)
    scale = reach / across if across > reach else 1.0
    fx, fy, fz = fx * scale - px, fy * scale - py, max(fz + weight - pz, MIN_LIFT)
    across, reach = math.sqrt(fx * fx + fy * fy), c.steepest * fz
    scale = reach / across if across > reach else 1.0
    fx, fy = fx * scale, fy * scale
    # The body's z axis has to point along f: the wanted rates are 2 tan(error / 2), in the plane of the two.
    along, length = fx * m[2] + fy * m[5] + fz * m[8], math.sqrt(fx * fx + fy * fy + fz * fz)
    ex, ey, ez = m[5] * fz - m[8] * fy, m[8] * fx - m[2] * fz, m[2] * fy - m[5] * fx
    upright = along + length > UPSIDE_DOWN * length
    scale = 2.0 * c.attitude_gain / (along + length) if upright else 0.0
    rx = scale * (m[0] * ex + m[3] * ey + m[6] * ez) if upright else MAX_TILT_RATE
    ry = scale * (m[1] * ex + m[4] * ey + m[7] * ez)
    fastest = MAX_TILT_RATE / (1.0 + bz * bz / (HALF_RATE_YAW * HALF_RATE_YAW))
    rx, ry = min(max(rx, -fastest), fastest), min(max(ry, -fastest), fastest)
    # Feed-forward: the wanted direction is fixed in the world while the body rotates.
    ahead_x, ahead_y = bz * ry, -bz * rx
    rx, ry, rz = rx + yaw_rate * m[6], ry + yaw_rate * m[7], yaw_rate * m[8]

    # Torque for the wanted change of rates, plus compensation of the gyroscopic torque, limited to rates in the normal
    # range: in a fast spin the full compensation would saturate the rotors, and the spin would not end.
    gx, gy = min(max(bx, -MAX_TILT_RATE), MAX_TILT_RATE), min(max(by, -MAX_TILT_RATE), MAX_TILT_RATE)
    gz = min(max(bz, -MAX_TILT_RATE), MAX_TILT_RATE)
    return (c.mass * max(along, 0.0),
            c.ix * (c.rate_gain * (rx - bx) + ahead_x) + (c.iz - c.iy) * gy * gz,
            c.iy * (c.rate_gain * (ry - by) + ahead_y) + (c.ix - c.iz) * gz * gx,
            c.iz * c.yaw_gain * (rz - bz) + (c.iy - c.ix) * gx * gy)


@inlined
def mix(c, thrust, tx, ty, tz):
    """Mixes thrust (N) and body torques (N m) into the four rotors' thrusts (N), each within c.least and c.most.

    On saturation, priorities are: roll, pitch and a little yaw torque, enough to end a spin; then thrust; then the rest
    of the yaw torque. c: Craft.
    """
    little = min(max(tz, -c.little_yaw), c.little_yaw)
    tz -= little
    q0, q1 = c.r0 * tx + c.p0 * ty + c.w0 * little, c.r1 * tx + c.p1 * ty + c.w1 * little
    q2, q3 = c.r2 * tx + c.p2 * ty + c.w2 * little, c.r3 * tx + c.p3 * ty + c.w3 * little
    spread = max(q0, q1, q2, q3) - min(q0, q1, q2, q3)
    scale = (c.most - c.least) / spread if spread > c.most - c.least else 1.0
    q0, q1, q2, q3 = q0 * scale, q1 * scale, q2 * scale, q3 * scale
    low = max(c.e0 * (c.least - q0), c.e1 * (c.least - q1), c.e2 * (c.least - q2), c.e3 * (c.least - q3))
    high = min(c.e0 * (c.most - q0), c.e1 * (c.most - q1), c.e2 * (c.most - q2), c.e3 * (c.most - q3))
    thrust = min(max(thrust, low), high)
    q0, q1, q2, q3 = q0 + c.t0 * thrust, q1 + c.t1 * thrust, q2 + c.t2 * thrust, q3 + c.t3 * thrust
    y0, y1, y2, y3 = c.w0 * tz, c.w1 * tz, c.w2 * tz, c.w3 * tz
    room = max(0.0, min(c.v0 * _room(c, q0, y0), c.v1 * _room(c, q1, y1), c.v2 * _room(c, q2, y2),
                        c.v3 * _room(c, q3, y3)))
    share = room / abs(tz) if room < abs(tz) else 1.0
    return (min(max(q0 + share * y0, c.least), c.most), min(max(q1 + share * y1, c.least), c.most),
            min(max(q2 + share * y2, c.least), c.most), min(max(q3 + share * y3, c.least), c.most))


@inlined
def _room(c, thrust, more):
    """Margin of a rotor's thrust (N) in the direction of the change `more`. c: Craft."""
    return c.most - thrust if more > 0.0 else thrust - c.least


@inlined
def lift(c, qx, qy, qz, qw, n0, n1, n2, n3):
    """The four rotors' thrusts (N) at the rates n0 to n3 (rad/s), and their force (N) and torque (N m) on the drone in
    the world: ten numbers. c: Craft; q: orientation x y z w."""
    k, m = c.thrust_coefficient, matrix(qx, qy, qz, qw)
    f0, f1, f2, f3 = k * n0 * n0, k * n1 * n1, k * n2 * n2, k * n3 * n3
    total = f0 + f1 + f2 + f3
    x = c.y0 * f0 + c.y1 * f1 + c.y2 * f2 + c.y3 * f3
    y = -(c.x0 * f0 + c.x1 * f1 + c.x2 * f2 + c.x3 * f3)
    z = -c.torque_ratio * (c.s0 * f0 + c.s1 * f1 + c.s2 * f2 + c.s3 * f3)
    return (f0, f1, f2, f3, total * m[2], total * m[5], total * m[8],
            m[0] * x + m[1] * y + m[2] * z, m[3] * x + m[4] * y + m[5] * z, m[6] * x + m[7] * y + m[8] * z)


@inlined
def rotor_drag(c, qx, qy, qz, qw, n0, n1, n2, n3, vx, vy, vz, h):
    """The drag of four rotors on motion across their axes: -rate c v of each, force (N) in the world (Martin and Salaun
    2010, The True Role of Accelerometer Feedback in Quadrotor Control); limited, so that it does not reverse the motion
    within a sub-step of h s. c: Craft; q: orientation; n0 to n3: rates, rad/s; v: velocity through the air, m/s, world.
    """
    m = matrix(qx, qy, qz, qw)
    rate = min(c.rotor_drag * (n0 + n1 + n2 + n3), STABLE * c.mass / h)
    along = vx * m[2] + vy * m[5] + vz * m[8]
    return rate * (along * m[2] - vx), rate * (along * m[5] - vy), rate * (along * m[8] - vz)
