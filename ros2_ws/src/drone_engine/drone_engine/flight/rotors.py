"""How rotors turn to be seen: a quadrotor's as they really do, others at their rate in flight, until it has landed."""

import math

import numpy as np

from drone_engine.effects import Setting
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
def spin(which, drone, landed, flight_rate, keep, dt, rate, angle):
    """Turns some of r rotors on by dt s; rate: (r,) rad/s, angle: (r,) rad. keep: left of a difference after dt."""
    for r in which:
        wanted = 0.0 if landed[drone[r]] else flight_rate[r]
        rate[r] = wanted + (rate[r] - wanted) * keep
        if wanted == 0.0 and abs(rate[r]) < STOPPED * abs(flight_rate[r]):
            rate[r] = 0.0
        angle[r] = turned_on(angle[r], rate[r], dt)


@kernel
def show(rotor, flight_rate, speed, dt, rate, angle):
    """Turns the rotors of k quadrotors, rotor (k, 4), on by dt s at their speed (k, 4); its sign is as in flight."""
    for k in range(rotor.shape[0]):
        for i in range(4):
            r = rotor[k, i]
            if r >= 0:
                rate[r] = math.copysign(speed[k, i], flight_rate[r])
                angle[r] = turned_on(angle[r], rate[r], dt)


def build(setting: Setting) -> tuple[Stage, ...]:
    m, s, dt = setting.model, setting.state, setting.dt
    rotor = np.array([rotors_of(m, int(d)) for d in np.flatnonzero(m.drones.quadrotor)], np.int64).reshape(-1, 4)
    others = np.setdiff1d(np.arange(len(m.rotors.names)), rotor)
    stages = []
    if (rotor >= 0).any():
        stages.append(Stage("rotors", show, (rotor, m.rotors.rate, s.memory[SPEED], dt, s.rotor_rate, s.rotor_angle)))
    if len(others):
        stages.append(Stage("rotors", spin, (others, m.rotors.drone, s.landed, m.rotors.rate,
                                             math.exp(-dt / SPIN_TIME), dt, s.rotor_rate, s.rotor_angle)))
    return tuple(stages)
