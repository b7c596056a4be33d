"""Rotors that spin up in flight and run down once the drone has landed."""

import math

from drone_sim.effects import Setting
from drone_sim.kernel import kernel
from drone_sim.stage import Stage

SPIN_TIME = 0.4  # s in which a difference in rate falls to 1/e
STOPPED = 0.05  # of the rate in flight, under which friction stops a rotor


@kernel
def spin(drone, landed, flight_rate, keep, dt, rate, angle):
    """Turns r rotors on by dt s; rate: (r,) rad/s, angle: (r,) rad. keep: what is left of a difference after dt."""
    for r in range(rate.shape[0]):
        wanted = 0.0 if landed[drone[r]] else flight_rate[r]
        rate[r] = wanted + (rate[r] - wanted) * keep
        if wanted == 0.0 and abs(rate[r]) < STOPPED * abs(flight_rate[r]):
            rate[r] = 0.0
        angle[r] = (angle[r] + dt * rate[r]) % (2.0 * math.pi)


def build(setting: Setting) -> Stage:
    rotors, state = setting.model.rotors, setting.state
    return Stage("rotors", spin, (rotors.drone, state.landed, rotors.rate, math.exp(-setting.dt / SPIN_TIME), setting.dt,
                                  state.rotor_rate, state.rotor_angle))
