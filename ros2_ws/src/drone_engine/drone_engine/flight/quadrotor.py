"""The flight model 'quadrotor': loops, mixing and four rotors.

The loops run once every sub-step and set the rotors' rates; what these do is a force at every instant. Without the
effect motor_lag the rotors turn as they are told at once.
"""

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.context import Context, Stages
from drone_engine.effects import EFFECTS, needs_thrust
from drone_engine.flight.control import lift, rates, rotor_drag
from drone_engine.flight.craft import ROTOR_DRAG, craft, hovering, numbers
from drone_engine.kernel import kernel
from drone_engine.model import Model
from drone_engine.scene.airframe import Airframe, Arm
from drone_engine.scene.errors import SceneError

# Of k quadrotors, in the state's memory: rad/s, (k, 4); and the velocity that is expected (NaN: none), m/s, and what
# pushes the drone, m/s^2, in the world, (k, 6).
SPEED, EXPECTED = "rotor_speed", "expected_velocity_and_push"


@kernel
def control(drone, drone_body, row, orientation, velocity, angular_velocity, wanted, landed, weight, expected, told):
    """Writes the rates that the rotors of k quadrotors are to have, (k, 4) rad/s; landed ones stop.

    row: (k, SIZE) as Craft names them; wanted: (d, 4) velocity in the world, yaw rate; weight: to carry, m/s^2.
    """
    for k in range(drone.shape[0]):
        d = drone[k]
        i = drone_body[d]
        if landed[d]:
            told[k] = 0.0
            expected[k] = np.nan
            continue
        q, v, a, e = orientation[i], velocity[i], angular_velocity[i], expected[k]
        (told[k, 0], told[k, 1], told[k, 2], told[k, 3], e[0], e[1], e[2], e[3], e[4], e[5]) = rates(
            craft(row[k]), q[0], q[1], q[2], q[3], v[0], v[1], v[2], a[0], a[1], a[2],
            wanted[d, 0], wanted[d, 1], wanted[d, 2], wanted[d, 3], e[0], e[1], e[2], e[3], e[4], e[5], weight)


@kernel
def fly(drone, drone_body, row, rotor, orientation, now, force, torque, thrust):
    """Adds thrust and drag torque of rotors that turn at `now`, (k, 4) rad/s, to the forces on the bodies.

    rotor: (k, 4) where each stands among the scene's, whose `thrust` (r,) is written, or -1.
    """
    for k in range(drone.shape[0]):
        i = drone_body[drone[k]]
        q, n = orientation[i], now[k]
        f0, f1, f2, f3, fx, fy, fz, tx, ty, tz = lift(craft(row[k]), q[0], q[1], q[2], q[3], n[0], n[1], n[2], n[3])
        force[i, 0], force[i, 1], force[i, 2] = force[i, 0] + fx, force[i, 1] + fy, force[i, 2] + fz
        torque[i, 0], torque[i, 1], torque[i, 2] = torque[i, 0] + tx, torque[i, 1] + ty, torque[i, 2] + tz
        if rotor[k, 0] >= 0:
            thrust[rotor[k, 0]], thrust[rotor[k, 1]], thrust[rotor[k, 2]], thrust[rotor[k, 3]] = f0, f1, f2, f3


@kernel
def thrust_of_rates(row, rotor, speed, thrust):
    """Writes thrust (r,) as it is when a sub-step begins, for effects that ask before `fly` has run."""
    for k in range(rotor.shape[0]):
        for i in range(4):
            if rotor[k, i] >= 0:
                thrust[rotor[k, i]] = craft(row[k]).thrust_coefficient * speed[k, i] ** 2


@kernel
def resist(drone, drone_body, row, orientation, velocity, air_velocity, now, h, force):
    """Adds the rotors' drag to force (n, 3); air: (n, 3), or (0, 3) where it is still."""
    for k in range(drone.shape[0]):
        i = drone_body[drone[k]]
        vx, vy, vz = velocity[i, 0], velocity[i, 1], velocity[i, 2]
        if air_velocity.shape[0]:
            vx, vy, vz = vx - air_velocity[i, 0], vy - air_velocity[i, 1], vz - air_velocity[i, 2]
        q, n = orientation[i], now[k]
        x, y, z = rotor_drag(craft(row[k]), q[0], q[1], q[2], q[3], n[0], n[1], n[2], n[3], vx, vy, vz, h)
        force[i, 0] += x
        force[i, 1] += y
        force[i, 2] += z


def rotors_of(model: Model, drone: int) -> Integers:
    """Where the four rotors of a drone stand among the scene's, or four times -1 if it has not exactly four."""
    name = model.bodies.names[model.drones.body[drone]]
    own = np.flatnonzero(model.rotors.drone == drone)
    four = len(own) == 4 and all(model.rotors.parents[r] == name for r in own)
    return own if four else np.full(4, -1, np.int64)


def arms(model: Model, drone: int) -> tuple[Arm, ...]:
    """Its rotors about its centre of mass, as the scene has them, else as its airframe says."""
    rotors, centre = rotors_of(model, drone), model.bodies.center_b[model.drones.body[drone]]
    if rotors[0] < 0:
        return (model.drones.flights[drone].quadrotor or Airframe()).arms
    at = model.rotors.pose_p[rotors, :2] - centre[:2]
    return tuple((float(x), float(y), 1 if model.rotors.rate[r] > 0.0 else -1)
                 for (x, y), r in zip(at, rotors, strict=True))


def row_of(model: Model, drone: int, h: float, path: Path) -> Floats:
    """A quadrotor's numbers as Craft names them. Raises SceneError."""
    i = model.drones.body[drone]
    try:
        return numbers(model.drones.flights[drone], float(model.bodies.mass[i]), model.bodies.inertia_b[i],
                       arms(model, drone), h)
    except ValueError as error:
        raise SceneError(f"{path}: objects.{model.bodies.names[i]}.flight: {error}") from None


def build(context: Context, drone: Integers, wanted: Floats, weight: float, path: Path) -> Stages:
    """drone: (k,) those of this model; wanted: (d, 4) velocity in the world, yaw rate; weight: m/s^2 to carry; path: of
    the scene. Raises SceneError."""
    m, active = context.model, context.active
    row = np.array([row_of(m, int(d), context.h, path) for d in drone])
    rotor = np.array([rotors_of(m, int(d)) for d in drone])
    speed = context.state.remember(SPEED, np.array([hovering(r, weight) for r in row]))
    expected = context.state.remember(EXPECTED, np.full((len(row), 6), np.nan))
    told, now, lag = speed, speed, Stages()
    if "motor_lag" in active:
        told, now = np.zeros_like(speed), np.zeros_like(speed)
        motor_lag: Any = import_module(EFFECTS["motor_lag"])  # imported only where a scene has it
        lag = motor_lag.between(active["motor_lag"], context, told, speed, now)
    force = [context.stage("flight", fly, drone=drone, row=row, rotor=rotor, now=now)]
    if row[:, ROTOR_DRAG].any():
        force.append(context.stage("rotor drag", resist, drone=drone, row=row, now=now))
    substep = [context.stage("control", control, drone=drone, row=row, wanted=wanted, weight=weight, expected=expected,
                             told=told)]
    if needs_thrust(active):
        substep.append(context.stage("thrust", thrust_of_rates, row=row, rotor=rotor, speed=speed))
    return Stages(substep=(*substep, *lag.substep), force=(*lag.force, *force))
