"""First-order lag of the rotors: d rate / dt = (told - rate) / time, with `told` the commanded rate.

Time constants: the 3DR Iris of RotorS (Furrer et al. 2016), which speed up faster than they slow down. The
solution between two instants is exact: rate = told + (rate - told) exp(-t / time). For drones of the model 'quadrotor'.
"""

import math

from pydantic import Field

from drone_engine.arrays import Floats
from drone_engine.context import Context, Stages
from drone_engine.kernel import inlined, kernel
from drone_engine.scene.fields import Strict

STOPPED = 1.0  # rad/s, below which friction stops a rotor with the command 0


class Parameters(Strict):
    """Keys of the effect in a scene file."""

    up: float = Field(0.0125, ge=1e-4, le=10.0)  # s
    down: float = Field(0.025, ge=1e-4, le=10.0)  # s


@inlined
def followed(told, rate, keep_up, keep_down):
    """The rate (rad/s) after a time in which a difference decays to keep_up of it (speeding up) or keep_down."""
    return told + (rate - told) * (keep_up if told > rate else keep_down)


@inlined
def stopped(told, rate):
    """The rate (rad/s), or 0 for a rotor with command 0 that is below STOPPED."""
    return 0.0 if (told == 0.0) & (rate < STOPPED) else rate


@kernel
def begin(told, speed, time_in_step, keep_up, keep_down, start, began):
    """Keeps the rates at the beginning of a sub-step in `start`, and writes those at its end to `speed`.

    told: commanded rates; all (k, 4) rad/s. keep_up, keep_down: what is left of a difference after a sub-step; began:
    (1,) s, written: when the sub-step began, as time_in_step (1,).
    """
    began[0] = time_in_step[0]
    for k in range(told.shape[0]):
        for r in range(4):
            start[k, r] = speed[k, r]
            speed[k, r] = stopped(told[k, r], followed(told[k, r], speed[k, r], keep_up, keep_down))


@kernel
def follow(told, start, time_in_step, began, up, down, now):
    """Writes the rates `now` (k, 4), rad/s, at time_in_step (1,), s; up, down: time constants, s."""
    t = time_in_step[0] - began[0]
    keep_up, keep_down = math.exp(-t / up), math.exp(-t / down)
    for k in range(told.shape[0]):
        for r in range(4):
            now[k, r] = followed(told[k, r], start[k, r], keep_up, keep_down)


def build(parameters: Parameters, context: Context) -> Stages:
    """Nothing by itself: the flight model puts the lag of its rotors between control and forces."""
    return Stages(idle="" if context.model.drones.quadrotor.any() else "no drone flies by the model quadrotor")


def between(parameters: Parameters, context: Context, told: Floats, speed: Floats, now: Floats) -> Stages:
    """The stages from commanded rotor rates `told` to the rates `now` at each instant; all (k, 4) rad/s. speed: kept
    from sub-step to sub-step."""
    start, began = told.copy(), context.forces.time_in_step.copy()
    up, down = parameters.up, parameters.down
    return Stages(
        substep=(context.stage("motor_lag", begin, told=told, speed=speed, keep_up=math.exp(-context.h / up),
                               keep_down=math.exp(-context.h / down), start=start, began=began),),
        force=(context.stage("motor_lag", follow, told=told, start=start, began=began, up=up, down=down, now=now),))
