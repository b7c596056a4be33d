"""Rotors that spin up in flight and run down once the drone has landed."""

import math

import numpy as np

from drone_sim.model import Model
from drone_sim.stage import Stage
from drone_sim.state import State

SPIN_TIME = 0.4  # s in which a difference in rate falls to 1/e
STOPPED = 0.05  # of the rate in flight, under which friction stops a rotor


def build(model: Model, state: State, dt: float) -> Stage:
    rotors = model.rotors
    keep = math.exp(-dt / SPIN_TIME)

    def spin() -> None:
        wanted = np.where(state.landed[rotors.drone] == 1, 0.0, rotors.rate)
        rate = wanted + (state.rotor_rate - wanted) * keep
        state.rotor_rate[:] = np.where((wanted == 0.0) & (np.abs(rate) < STOPPED * np.abs(rotors.rate)), 0.0, rate)
        state.rotor_angle[:] = (state.rotor_angle + dt * state.rotor_rate) % (2.0 * math.pi)

    return spin
