"""Rotors follow what they are told with a delay of first order: d rate / dt = (told - rate) / time.

Time constants: the 3DR Iris of RotorS (Furrer et al. 2016), which speeds up faster than it slows down. Between two
instants the solution is exact: rate = told + (rate - told) exp(-t / time). For drones of the model 'quadrotor'.
"""

import math

from pydantic import Field

from drone_engine.arrays import Floats
from drone_engine.effects import Setting, Stages
from drone_engine.kernel import inlined, kernel
from drone_engine.program.stage import Stage
from drone_engine.scene.fields import Strict

STOPPED = 1.0  # rad/s, below which friction stops a rotor that is told to


class Parameters(Strict):
    up: float = Field(0.0125, ge=1e-4, le=10.0)  # s
    down: float = Field(0.025, ge=1e-4, le=10.0)  # s


@inlined
def followed(told, rate, keep_up, keep_down):
    """The rate after a while of which is left, of a difference, keep_up if it speeds up, else keep_down."""
    return told + (rate - told) * (keep_up if told > rate else keep_down)


@inlined
def stopped(told, rate):
    """The rate, or 0 where a rotor that is told to stop hardly turns."""
    return 0.0 if (told == 0.0) & (rate < STOPPED) else rate


@kernel
def begin(told, speed, clock, keep_up, keep_down, start, began):
    """At the beginning of a sub-step: keeps the rates (k, 4) there, and writes to `speed` those at its end."""
    began[0] = clock[0]
    for k in range(told.shape[0]):
        for r in range(4):
            start[k, r] = speed[k, r]
            speed[k, r] = stopped(told[k, r], followed(told[k, r], speed[k, r], keep_up, keep_down))


@kernel
def follow(told, start, clock, began, up, down, now):
    """Writes the rates (k, 4) at an instant of the sub-step."""
    t = clock[0] - began[0]
    keep_up, keep_down = math.exp(-t / up), math.exp(-t / down)
    for k in range(told.shape[0]):
        for r in range(4):
            now[k, r] = followed(told[k, r], start[k, r], keep_up, keep_down)


def build(parameters: Parameters, setting: Setting) -> Stages:
    """Nothing by itself: the flight model puts its rotors' lag between the loops and the forces."""
    return Stages(idle="" if setting.model.drones.quadrotor.any() else "no drone flies by the model quadrotor")


def between(parameters: Parameters, told: Floats, speed: Floats, now: Floats, clock: Floats, h: float) -> Stages:
    """From what rotors are told to how they turn `now`; all (k, 4) rad/s. speed: kept; h: s of a sub-step."""
    start, began = told.copy(), clock.copy()
    keep = math.exp(-h / parameters.up), math.exp(-h / parameters.down)
    return Stages(substep=(Stage("motor_lag", begin, (told, speed, clock, *keep, start, began)),),
                  force=(Stage("motor_lag", follow, (told, start, clock, began, parameters.up, parameters.down, now)),))
