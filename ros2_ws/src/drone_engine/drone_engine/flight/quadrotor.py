"""The flight model 'quadrotor': cascaded control, mixing and four rotors.

The controller runs once per sub-step and sets the rotors' rates; the rotors are a force at every instant. Without the
effect motor_lag, rotors have their commanded rates at once.
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

# Names in the state's memory, of k quadrotors: rotor rates (k, 4), rad/s; and (k, 6): predicted velocity, m/s (NaN:
# none), and estimated disturbance, m/s^2, in the world.
SPEED, EXPECTED = "rotor_speed", "expected_velocity_and_push"


@kernel
def control(drone, drone_body, row, orientation, velocity, angular_velocity, wanted, landed, weight, expected, told):
    """Writes the commanded rates of k quadrotors' rotors, told (k, 4), rad/s: 0 for landed ones.

    drone: (k,) indices; drone_body: (d,); row: (k, SIZE) Craft parameters; orientation, velocity, angular_velocity: of
    bodies in the world; wanted: (d, 4) velocity (m/s, world) and yaw rate (rad/s); landed: (d,); weight: gravity to
    carry, m/s^2; expected: (k, 6) predicted velocity and disturbance, in and out.
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
def apply_rotors(drone, drone_body, row, rotor, orientation, now, force, torque, thrust):
    """Adds thrust and drag torque of k quadrotors' rotors at the rates now (k, 4), rad/s, to force (N) and torque (N
    m), (n, 3) in the world.

    row: (k, SIZE) Craft parameters; orientation: (n, 4); rotor: (k, 4) indices among the scene's rotors, whose thrust
    (r,), N, is written; -1: none.
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
    """Writes thrust (r,), N, at the beginning of a sub-step, for effects that need it before `apply_rotors` has run.
    speed: (k, 4) rad/s; rotor: (k, 4) indices, or -1; row: (k, SIZE) Craft parameters."""
    for k in range(rotor.shape[0]):
        for i in range(4):
            if rotor[k, i] >= 0:
                thrust[rotor[k, i]] = craft(row[k]).thrust_coefficient * speed[k, i] ** 2


@kernel
def apply_rotor_drag(drone, drone_body, row, orientation, velocity, air_velocity, now, h, force):
    """Adds the drag of k quadrotors' rotors at the rates now (k, 4), rad/s, to force (n, 3), N. air_velocity: (n, 3)
    m/s, or (0, 3) where the air is at rest; h: s of a sub-step."""
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
    """Indices (4,) of a drone's rotors among the scene's; four times -1 if it does not have exactly four."""
    name = model.bodies.names[model.drones.body[drone]]
    own = np.flatnonzero(model.rotors.drone == drone)
    four = len(own) == 4 and all(model.rotors.parents[r] == name for r in own)
    return own if four else np.full(4, -1, np.int64)


def arms(model: Model, drone: int) -> tuple[Arm, ...]:
    """Positions and directions of a drone's rotors about its center of mass: of its rotors in the scene, else those of
    its airframe."""
    rotors, centre = rotors_of(model, drone), model.bodies.center_b[model.drones.body[drone]]
    if rotors[0] < 0:
        return (model.drones.flights[drone].quadrotor or Airframe()).arms
    at = model.rotors.pose_p[rotors, :2] - centre[:2]
    return tuple((float(x), float(y), 1 if model.rotors.rate[r] > 0.0 else -1)
                 for (x, y), r in zip(at, rotors, strict=True))


def row_of(model: Model, drone: int, h: float, path: Path) -> Floats:
    """Craft parameters (SIZE,) of a quadrotor that is controlled every h s; path: of the scene. Raises SceneError."""
    i = model.drones.body[drone]
    try:
        return numbers(model.drones.flights[drone], float(model.bodies.mass[i]), model.bodies.inertia_b[i],
                       arms(model, drone), h)
    except ValueError as error:
        raise SceneError(f"{path}: objects.{model.bodies.names[i]}.flight: {error}") from None


def build(context: Context, drone: Integers, wanted: Floats, weight: float, path: Path) -> Stages:
    """The stages of the drones with this flight model. drone: (k,) their indices; wanted: (d, 4) velocity (m/s, world)
    and yaw rate; weight: gravity to carry, m/s^2; path: of the scene. Raises SceneError."""
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
    force = [context.stage("flight", apply_rotors, drone=drone, row=row, rotor=rotor, now=now)]
    if row[:, ROTOR_DRAG].any():
        force.append(context.stage("rotor drag", apply_rotor_drag, drone=drone, row=row, now=now))
    substep = [context.stage("control", control, drone=drone, row=row, wanted=wanted, weight=weight, expected=expected,
                             told=told)]
    if needs_thrust(active):
        substep.append(context.stage("thrust", thrust_of_rates, row=row, rotor=rotor, speed=speed))
    return Stages(substep=(*substep, *lag.substep), force=(*lag.force, *force))
