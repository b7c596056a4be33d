"""The flight model 'direct': a force towards the wanted velocity, and a torque that tilts the drone accordingly.

It is cheap and easy to fly, as in a game. It carries the drone's weight and limits the acceleration to that of the
scene. It is a force like any other, so that a contact stops the drone.
"""

import math

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.context import Context, Stages
from drone_engine.effects import needs_thrust
from drone_engine.flight.pilot import limited
from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix, rotate

RESPONSE = 0.25  # s in which a difference in velocity falls to 1/e
TILT = 0.5  # of the tilt that a quadrotor would need for the same acceleration
ATTITUDE_FREQUENCY = 8.0  # rad/s, critically damped


@kernel
def velocity_control(drone, orientation, velocity, angular_velocity, drone_body, mass, body_inertia, max_acceleration,
                     wanted, landed, weight, dt, push):
    """Writes the force (N) and torque (N m) of k drones for the coming step, push (k, 2, 3), in the world; 0 for
    landed ones.

    drone: (k,) indices; drone_body, max_acceleration (m/s^2), landed: (d,); orientation, velocity, angular_velocity,
    mass, body_inertia: of n bodies; wanted: (d, 4) velocity (m/s, world) and yaw rate; weight: gravity to carry,
    m/s^2; dt: s.
    """
    for k in range(drone.shape[0]):
        d = drone[k]
        i = drone_body[d]
        push[k] = 0.0
        if landed[d]:
            continue
        response = max(RESPONSE, dt)
        ax, ay, az = limited((wanted[d, 0] - velocity[i, 0]) / response, (wanted[d, 1] - velocity[i, 1]) / response,
                             (wanted[d, 2] - velocity[i, 2]) / response, max_acceleration[d])
        push[k, 0, 0] = mass[i] * ax
        push[k, 0, 1] = mass[i] * ay
        push[k, 0, 2] = mass[i] * (az + weight)

        # Attitude: the body's z axis towards the tilt, damped; gains are limited to what the step length allows.
        frequency = min(ATTITUDE_FREQUENCY, 0.3 / dt)
        ux, uy, uz = TILT * ax, TILT * ay, 9.81
        scale = 1.0 / math.sqrt(ux * ux + uy * uy + uz * uz)
        q = orientation[i]
        m = matrix(q[0], q[1], q[2], q[3])
        ex = (m[5] * uz - m[8] * uy) * scale
        ey = (m[8] * ux - m[2] * uz) * scale
        # body rates, and the error of the z axis (a cross product) in the body frame
        bx = m[0] * angular_velocity[i, 0] + m[3] * angular_velocity[i, 1] + m[6] * angular_velocity[i, 2]
        by = m[1] * angular_velocity[i, 0] + m[4] * angular_velocity[i, 1] + m[7] * angular_velocity[i, 2]
        bz = m[2] * angular_velocity[i, 0] + m[5] * angular_velocity[i, 1] + m[8] * angular_velocity[i, 2]
        ez = (m[2] * uy - m[5] * ux) * scale
        px, py = m[0] * ex + m[3] * ey + m[6] * ez, m[1] * ex + m[4] * ey + m[7] * ez
        tx = body_inertia[i, 0] * (frequency * frequency * px - 2.0 * frequency * bx)
        ty = body_inertia[i, 1] * (frequency * frequency * py - 2.0 * frequency * by)
        tz = body_inertia[i, 2] * frequency * (wanted[d, 3] - bz)
        t = rotate(q[0], q[1], q[2], q[3], tx, ty, tz)
        for c in range(3):
            push[k, 1, c] = t[c]


@kernel
def apply_push(drone, drone_body, push, force, torque):
    """Adds the forces and torques of k drones, push (k, 2, 3), to force (N) and torque (N m), (n, 3). drone: (k,);
    drone_body: (d,)."""
    for k in range(drone.shape[0]):
        for c in range(3):
            force[drone_body[drone[k]], c] += push[k, 0, c]
            torque[drone_body[drone[k]], c] += push[k, 1, c]


@kernel
def share_thrust(place, push, rotor_drone, thrust):
    """Writes thrust (r,), N: the lift of each drone in equal parts over its rotors. place: (d,) row of a drone in push
    (k, 2, 3), -1 for other models; rotor_drone: (r,)."""
    for r in range(rotor_drone.shape[0]):
        k = place[rotor_drone[r]]
        if k >= 0:
            rotors = 0
            for other in rotor_drone:
                rotors += other == rotor_drone[r]
            thrust[r] = max(push[k, 0, 2], 0.0) / rotors


def build(context: Context, drone: Integers, wanted: Floats, weight: float) -> Stages:
    """The stages of the drones with this flight model. drone: (k,) their indices; wanted: (d, 4) velocity (m/s, world)
    and yaw rate; weight: gravity to carry, m/s^2."""
    push = np.zeros((len(drone), 2, 3))
    step = [context.stage("direct", velocity_control, drone=drone, wanted=wanted, weight=weight, push=push)]
    if needs_thrust(context.active):
        place = np.full(len(context.model.drones.body), -1, np.int64)
        place[drone] = np.arange(len(drone))
        step.append(context.stage("thrust", share_thrust, place=place, push=push))
    return Stages(step=tuple(step), force=(context.stage("flight", apply_push, drone=drone, push=push),))
