"""How rotors turn to be seen: a quadrotor's as they really do, others at their rate in flight, until it has landed."""

import math

import numpy as np

from drone_engine.context import Context
from drone_engine.flight.quadrotor import SPEED, rotors_of
from drone_engine.kernel import inlined, kernel
from drone_engine.program.stage import Stage

SPIN_TIME = 0.4  # s in which a difference in rate falls to 1/e
STOPPED = 0.05  # of the rate in flight, under which friction stops a rotor
TURN = 2.0 * math.pi


@inlined
def turned_on(angle, rate, dt):
    """The angle after dt s, from 0 to a full turn, in rad."""
    angle = angle + dt * rate
    return angle - TURN * np.floor(angle * (1.0 / TURN))


@kernel
def spin(which, rotor_drone, landed, flight_rate, keep, dt, rotor_rate, rotor_angle):
    """Turns some of r rotors on by dt s; rotor_rate: (r,) rad/s and rotor_angle: (r,) rad,
    in and out. keep: what is left of a difference in rate after dt."""
    for r in which:
        wanted = 0.0 if landed[rotor_drone[r]] else flight_rate[r]
        rotor_rate[r] = wanted + (rotor_rate[r] - wanted) * keep
        if wanted == 0.0 and abs(rotor_rate[r]) < STOPPED * abs(flight_rate[r]):
            rotor_rate[r] = 0.0
        rotor_angle[r] = turned_on(rotor_angle[r], rotor_rate[r], dt)


@kernel
def show(rotor, flight_rate, speed, dt, rotor_rate, rotor_angle):
    """Turns the rotors of k quadrotors, rotor (k, 4), on by dt s at their speed (k, 4); its sign is as in flight."""
    for k in range(rotor.shape[0]):
        for i in range(4):
            r = rotor[k, i]
            if r >= 0:
                rotor_rate[r] = math.copysign(speed[k, i], flight_rate[r])
                rotor_angle[r] = turned_on(rotor_angle[r], rotor_rate[r], dt)


def build(context: Context) -> tuple[Stage, ...]:
    """The stages that turn the scene's rotors: quadrotors' at their simulated rates, others' at their rate in
    flight."""
    m = context.model
    rotor = np.array([rotors_of(m, int(d)) for d in np.flatnonzero(m.drones.quadrotor)], np.int64).reshape(-1, 4)
    others = np.setdiff1d(np.arange(len(m.rotors.names)), rotor)
    stages = []
    if (rotor >= 0).any():
        stages.append(context.stage("rotors", show, rotor=rotor, speed=context.state.memory[SPEED]))
    if len(others):
        stages.append(context.stage("rotors", spin, which=others, keep=math.exp(-context.dt / SPIN_TIME)))
    return tuple(stages)
