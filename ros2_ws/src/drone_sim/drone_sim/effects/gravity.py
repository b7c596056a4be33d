"""Uniform gravity: weight = m g, downwards."""

from pydantic import Field

from drone_sim.arrays import Floats
from drone_sim.model import Model
from drone_sim.stage import Stage
from drone_sim.state import State
from drone_sim.strict import Strict


class Parameters(Strict):
    acceleration: float = Field(9.80665, ge=0.0, le=300.0)  # m/s^2; standard gravity (CGPM 1901)


def build(parameters: Parameters, model: Model, state: State, force_w: Floats, dt: float) -> Stage:
    weight = model.bodies.mass * parameters.acceleration
    down = force_w[:, 2]

    def pull() -> None:
        down[:] -= weight

    return pull
