"""The flight model 'direct': a force towards the commanded velocity, and a torque that leans into it.

Cheap and forgiving, like a game's. It carries the drone's weight, limits acceleration to what the scene allows,
and is a force like any other: what stands in the way wins. After SILENCE without a command the drone stops and
holds its position; at rest on a support without a command it lands, and its rotors stop until the next command.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from drone_sim.collision.manifold import Manifolds
from drone_sim.effects import Setting, Stages
from drone_sim.kernel import kernel
from drone_sim.rotation import matrix, rotate
from drone_sim.stage import Stage

SILENCE = 0.5  # s of simulated time after which a command is over
RESPONSE = 0.25  # s in which a difference in velocity falls to 1/e
STILL = 0.1  # m/s under which a drone counts as at rest
HOLD_SPEED = 1.0  # m/s at most, back to the position that is held
LEAN = 0.5  # of the tilt that a quadrotor would need for the same acceleration
ATTITUDE_FREQUENCY = 8.0  # rad/s, critically damped


@kernel
def steer(position, orientation, velocity, angular, body, mass, inertia, max_speed, max_acceleration, max_yaw_rate,
          command, silence, hold, landed, weight, dt, push):
    """Writes the force (N) and torque (N m) of d drones, (d, 2, 3) in the world, for the coming step. `weight` is the
    gravity to carry, m/s^2."""
    for d in range(body.shape[0]):
        i = body[d]
        push[d] = 0.0
        speed = math.sqrt(velocity[i, 0] ** 2 + velocity[i, 1] ** 2 + velocity[i, 2] ** 2)
        silent = silence[d] * dt >= SILENCE
        cx, cy, cz, yaw_rate = command[d, 0], command[d, 1], command[d, 2], command[d, 3]
        if silent:
            cx = cy = cz = yaw_rate = 0.0
        else:
            hold[d, 0] = np.nan
        if cx != 0.0 or cy != 0.0 or cz > 0.0 or yaw_rate != 0.0:
            landed[d] = 0
        if landed[d]:
            continue

        # The wanted velocity: commands turn with the drone's heading, not with its tilt.
        q = orientation[i]
        yaw = math.atan2(2.0 * (q[3] * q[2] + q[0] * q[1]), 1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]))
        wx, wy, wz = cx * math.cos(yaw) - cy * math.sin(yaw), cx * math.sin(yaw) + cy * math.cos(yaw), cz
        limit = max_speed[d]
        if silent:
            if math.isnan(hold[d, 0]) and speed < STILL:
                for k in range(3):
                    hold[d, k] = position[i, k]
            if not math.isnan(hold[d, 0]):
                wx, wy, wz = hold[d, 0] - position[i, 0], hold[d, 1] - position[i, 1], hold[d, 2] - position[i, 2]
                limit = min(limit, HOLD_SPEED)
        wx, wy, wz = _limited(wx, wy, wz, limit)
        yaw_rate = min(max(yaw_rate, -max_yaw_rate[d]), max_yaw_rate[d])

        response = max(RESPONSE, dt)
        ax, ay, az = _limited((wx - velocity[i, 0]) / response, (wy - velocity[i, 1]) / response,
                              (wz - velocity[i, 2]) / response, max_acceleration[d])
        push[d, 0, 0] = mass[i] * ax
        push[d, 0, 1] = mass[i] * ay
        push[d, 0, 2] = mass[i] * (az + weight)

        # Attitude: body z towards the lean, damped; the gains are what the step length can follow.
        frequency = min(ATTITUDE_FREQUENCY, 0.3 / dt)
        ux, uy, uz = LEAN * ax, LEAN * ay, 9.81
        scale = 1.0 / math.sqrt(ux * ux + uy * uy + uz * uz)
        m = matrix(q[0], q[1], q[2], q[3])
        ex = (m[5] * uz - m[8] * uy) * scale
        ey = (m[8] * ux - m[2] * uz) * scale
        # body rates, and the error of the z axis (a cross product) in the body frame
        bx = m[0] * angular[i, 0] + m[3] * angular[i, 1] + m[6] * angular[i, 2]
        by = m[1] * angular[i, 0] + m[4] * angular[i, 1] + m[7] * angular[i, 2]
        bz = m[2] * angular[i, 0] + m[5] * angular[i, 1] + m[8] * angular[i, 2]
        ez = (m[2] * uy - m[5] * ux) * scale
        px, py = m[0] * ex + m[3] * ey + m[6] * ez, m[1] * ex + m[4] * ey + m[7] * ez
        tx = inertia[i, 0] * (frequency * frequency * px - 2.0 * frequency * bx)
        ty = inertia[i, 1] * (frequency * frequency * py - 2.0 * frequency * by)
        tz = inertia[i, 2] * frequency * (yaw_rate - bz)
        t = rotate(q[0], q[1], q[2], q[3], tx, ty, tz)
        for k in range(3):
            push[d, 1, k] = t[k]


@kernel
def add(body, push, force, torque):
    """Adds what `steer` wrote to the forces on the bodies."""
    for d in range(body.shape[0]):
        for k in range(3):
            force[body[d], k] += push[d, 0, k]
            torque[body[d], k] += push[d, 1, k]


@kernel
def _limited(x, y, z, limit):
    """The vector, no longer than the limit."""
    length = math.sqrt(x * x + y * y + z * z)
    if length <= limit:
        return x, y, z
    return x * limit / length, y * limit / length, z * limit / length


@kernel
def land(velocity, body, command, silence, dt, end, pair, points, normal, total, landed):
    """Marks drones as landed that rest on something and are not told to leave it."""
    for d in range(body.shape[0]):
        i = body[d]
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


def build(setting: Setting, weight: float) -> Stages:
    """weight: the gravity to carry, m/s^2."""
    b, drones, s, forces = setting.model.bodies, setting.model.drones, setting.state, setting.forces
    push = np.zeros((len(drones.body), 2, 3))
    return Stages(
        step=(Stage("flight", steer, (
            s.position_w, s.orientation_w, s.velocity_w, s.angular_velocity_w, drones.body, b.mass, b.inertia_b,
            drones.max_speed, drones.max_acceleration, drones.max_yaw_rate, s.command_b, s.silence, s.hold_w, s.landed,
            weight, setting.dt, push)),),
        force=(Stage("flight", add, (drones.body, push, forces.force_w, forces.torque_w)),))


def build_landing(setting: Setting, manifolds: Callable[[], Manifolds]) -> Stage:
    """After the contacts: who has come to rest."""
    s, body = setting.state, setting.model.drones.body

    def arguments() -> tuple[Any, ...]:
        m = manifolds()
        return (s.velocity_w, body, s.command_b, s.silence, setting.dt, m.end, m.pair, m.points, m.normal_w, m.total,
                s.landed)

    return Stage("landing", land, arguments)
