"""The parameters of a quadrotor in one row of numbers, with the mixing matrix of its rotors."""

import math
from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.kernel import inlined
from drone_engine.scene.airframe import Airframe, Arm
from drone_engine.scene.schema import Flight

SIZE = 61  # numbers of a Craft
MAX_CORRECTION = 0.35  # largest share of an error that the inner loop removes per control step; more would overshoot
MAX_DISTURBANCE = 0.6  # of max_acceleration: the strongest disturbance that is canceled
YAW_RESERVE = 0.2  # share of a rotor's range that yaw gets before thrust does
CASCADE = 2.5  # least ratio of the bandwidths of a loop and the one around it


class Craft(NamedTuple):
    """SI units. Rotor i is at (x, y) from the center of mass and rotates in direction s: +1 is counter-clockwise from
    above. Its thrust is t per total thrust, r, p and w per roll, pitch and yaw torque (N per N, N per N m)."""

    mass: float
    ix: float
    iy: float
    iz: float
    thrust_coefficient: float
    torque_ratio: float
    rotor_drag: float
    least: float  # N, smallest thrust of a rotor in flight; `most`: the largest
    most: float
    velocity_gain: float
    attitude_gain: float
    rate_gain: float
    yaw_gain: float
    max_acceleration: float
    steepest: float  # tangent of the largest tilt
    x0: float
    x1: float
    x2: float
    x3: float
    y0: float
    y1: float
    y2: float
    y3: float
    s0: float
    s1: float
    s2: float
    s3: float
    t0: float
    t1: float
    t2: float
    t3: float
    r0: float
    r1: float
    r2: float
    r3: float
    p0: float
    p1: float
    p2: float
    p3: float
    w0: float
    w1: float
    w2: float
    w3: float
    h: float  # s between two controls
    watch_velocity: float  # observer gain: share of the velocity error that is corrected per control
    watch_push: float  # observer gain: m/s^2 of disturbance per m/s of velocity error
    most_push: float  # m/s^2, largest estimated disturbance
    # Reciprocals, since division is slow.
    per_mass: float
    per_coefficient: float
    per_ix: float
    per_iy: float
    per_iz: float
    e0: float  # 1 / t
    e1: float
    e2: float
    e3: float
    v0: float  # 1 / |w|
    v1: float
    v2: float
    v3: float
    little_yaw: float  # N m, yaw torque with priority over thrust


ROTOR_DRAG = Craft._fields.index("rotor_drag")  # column of a row


@inlined
def craft(row):
    """The numbers of a row (SIZE,) as a Craft."""
    return Craft(row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10], row[11],
                 row[12], row[13], row[14], row[15], row[16], row[17], row[18], row[19], row[20], row[21], row[22],
                 row[23], row[24], row[25], row[26], row[27], row[28], row[29], row[30], row[31], row[32], row[33],
                 row[34], row[35], row[36], row[37], row[38], row[39], row[40], row[41], row[42], row[43], row[44],
                 row[45], row[46], row[47], row[48], row[49], row[50], row[51], row[52], row[53], row[54], row[55],
                 row[56], row[57], row[58], row[59], row[60])


def numbers(flight: Flight, mass: float, inertia: Floats, arms: tuple[Arm, ...], h: float) -> Floats:
    """The row (SIZE,) of a quadrotor that is controlled every h s. mass: kg; inertia: (3,) kg m^2; arms: of its rotors.
    Raises ValueError for arms that cannot control it."""
    frame = flight.quadrotor or Airframe()
    x, y, s = np.array(arms).T
    effect = np.array([np.ones(4), y, -x, -frame.torque_ratio * s])  # thrusts -> thrust, roll, pitch, yaw torque
    if np.linalg.cond(effect) > 1e6:
        raise ValueError("its four rotors cannot rotate it about every axis")
    shares = np.linalg.inv(effect).T
    if shares[0].min() <= 0.0:
        raise ValueError("its centre of mass is not between its four rotors")
    rate = min(frame.gains.rate, MAX_CORRECTION / h)
    attitude = min(frame.gains.attitude, rate / CASCADE)
    velocity = min(frame.gains.velocity, attitude / CASCADE)
    watch = min(frame.gains.disturbance, 0.5 * MAX_CORRECTION / h)
    least, most = (frame.thrust_coefficient * turn**2 for turn in (frame.min_rate, frame.max_rate))
    return np.array([
        mass, *inertia, frame.thrust_coefficient, frame.torque_ratio, frame.rotor_drag, least, most,
        velocity, attitude, rate, min(frame.gains.yaw_rate, MAX_CORRECTION / h), flight.max_acceleration,
        math.tan(frame.max_tilt), *x, *y, *s, *shares.ravel(), h, 2.0 * watch * h, watch**2 * h,
        MAX_DISTURBANCE * flight.max_acceleration, 1.0 / mass, 1.0 / frame.thrust_coefficient, *(1.0 / inertia),
        *(1.0 / shares[0]), *(1.0 / np.abs(shares[3])),
        YAW_RESERVE * (most - least) / np.abs(shares[3]).max()])


def hovering(row: Floats, weight: float) -> Floats:
    """Rates (4,), rad/s, of the rotors in hover under gravity `weight`, m/s^2."""
    c = Craft(*row)
    thrusts: Floats = np.clip(c.mass * weight * np.array([c.t0, c.t1, c.t2, c.t3]), c.least, c.most)
    return np.sqrt(thrusts / c.thrust_coefficient)
