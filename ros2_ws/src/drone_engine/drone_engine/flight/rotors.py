"""Visible rotation of rotors: simulated rates for quadrotors; others rotate at their rate in flight until they land."""

import math

import numpy as np

from drone_engine.context import Context
from drone_engine.flight.quadrotor import SPEED, rotors_of
from drone_engine.kernel import inlined, kernel
from drone_engine.program.stage import Stage

TIME_CONSTANT = 0.4  # s, of a rotor that starts or stops
STOPPED = 0.05  # share of the rate in flight below which friction stops a rotor
TURN = 2.0 * math.pi


@inlined
def advance_angle(angle, rate, dt):
    """The angle (rad, in [0, 2 pi)) after dt s at a rate (rad/s)."""
    angle = angle + dt * rate
    return angle - TURN * np.floor(angle * (1.0 / TURN))


@kernel
def advance_rotors(which, rotor_drone, landed, flight_rate, keep, dt, rotor_rate, rotor_angle):
    """Advances the rotors `which` by dt s: rotor_rate (r,), rad/s, and rotor_angle (r,), rad, in and out. rotor_drone:
    (r,); landed: (d,); flight_rate: (r,) rad/s; keep: remaining share of a difference in rate after dt."""
    for r in which:
        wanted = 0.0 if landed[rotor_drone[r]] else flight_rate[r]
        rotor_rate[r] = wanted + (rotor_rate[r] - wanted) * keep
        if wanted == 0.0 and abs(rotor_rate[r]) < STOPPED * abs(flight_rate[r]):
            rotor_rate[r] = 0.0
        rotor_angle[r] = advance_angle(rotor_angle[r], rotor_rate[r], dt)


@kernel
def show_quadrotors(rotor, flight_rate, speed, dt, rotor_rate, rotor_angle):
    """Advances the rotors of k quadrotors by dt s: writes rotor_rate (r,), rad/s, and advances rotor_angle (r,), rad.
    rotor: (k, 4) indices, or -1; speed: (k, 4) rad/s; flight_rate: (r,), whose sign is the direction."""
    for k in range(rotor.shape[0]):
        for i in range(4):
            r = rotor[k, i]
            if r >= 0:
                rotor_rate[r] = math.copysign(speed[k, i], flight_rate[r])
                rotor_angle[r] = advance_angle(rotor_angle[r], rotor_rate[r], dt)


def build(context: Context) -> tuple[Stage, ...]:
    """The stages that turn the scene's rotors: quadrotors' at their simulated rates, others' at their rate in
    flight."""
    m = context.model
    rotor = np.array([rotors_of(m, int(d)) for d in np.flatnonzero(m.drones.quadrotor)], np.int64).reshape(-1, 4)
    others = np.setdiff1d(np.arange(len(m.rotors.names)), rotor)
    stages = []
    if (rotor >= 0).any():
        stages.append(context.stage("rotors", show_quadrotors, rotor=rotor, speed=context.state.memory[SPEED]))
    if len(others):
        stages.append(context.stage("rotors", advance_rotors, which=others, keep=math.exp(-context.dt / TIME_CONSTANT)))
    return tuple(stages)
