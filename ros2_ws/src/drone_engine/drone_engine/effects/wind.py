"""Mean wind: the same everywhere, or slower near the ground.

Power law: u(z) = u_r (z / z_r)^p, p = 1/7 over open land (Justus, Mikhail 1976). Logarithmic law:
u(z) = u_r ln(z / z_0) / ln(z_r / z_0), as in MIL-F-8785C, 3.7.3.2. Heights are over z = `ground`.
"""

import math
from typing import Literal, Self

from pydantic import Field, model_validator

from drone_engine.effects import Setting, Stages
from drone_engine.kernel import kernel
from drone_engine.program.stage import Stage
from drone_engine.scene.fields import Strict

LOWEST = 0.9144  # m, 3 ft: MIL-F-8785C knows no wind below; it is taken as there


class Parameters(Strict):
    mean: tuple[float, float, float] = (3.0, 0.0, 0.0)  # m/s, at the reference height
    profile: Literal["uniform", "power", "log"] = "uniform"
    reference: float = Field(10.0, ge=1.0, le=1000.0)  # m over the ground; where weather services measure (WMO)
    exponent: float = Field(1 / 7, ge=0.0, le=1.0)  # of the power law
    roughness: float = Field(0.03, ge=1e-6, le=0.9)  # m, of the logarithmic law; grass (Davenport 1960, class 3)
    ground: float = 0.0  # m

    @model_validator(mode="after")
    def _not_a_storm(self) -> Self:
        if self.speed() > 150.0:
            raise ValueError(f"mean: expected a speed of at most 150 m/s, got {self.speed():g} m/s")
        return self

    def speed(self) -> float:
        """At the reference height, m/s."""
        return math.hypot(*self.mean)

    def factor(self, height: float) -> float:
        """The speed at a height over the ground, in units of that at the reference height."""
        if self.profile == "power":
            return float(power(height, self.reference, self.exponent))
        if self.profile == "log":
            return float(log(height, self.reference, self.roughness))
        return 1.0


@kernel
def power(height, reference, exponent):
    """The power law's factor."""
    return (max(height, LOWEST) / reference) ** exponent


@kernel
def log(height, reference, roughness):
    """The logarithmic law's factor."""
    return math.log(max(height, LOWEST) / roughness) / math.log(reference / roughness)


@kernel
def blow(awake, x, y, z, air):
    """Sets the air's velocity (n, 3) around each body. Wind comes before all else that stirs the air."""
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        air[i, 0], air[i, 1], air[i, 2] = x, y, z


@kernel
def blow_power(awake, position, ground, reference, exponent, x, y, z, air):
    """The same with the power law over height."""
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        factor = power(position[i, 2] - ground, reference, exponent)
        air[i, 0], air[i, 1], air[i, 2] = factor * x, factor * y, factor * z


@kernel
def blow_log(awake, position, ground, reference, roughness, x, y, z, air):
    """The same with the logarithmic law over height."""
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        factor = log(position[i, 2] - ground, reference, roughness)
        air[i, 0], air[i, 1], air[i, 2] = factor * x, factor * y, factor * z


def build(parameters: Parameters, setting: Setting) -> Stages:
    p, state, air = parameters, setting.state, setting.forces.air_w
    where = (state.awake, state.position_w, p.ground, p.reference)
    stage = {
        "uniform": Stage("wind", blow, (state.awake, *p.mean, air)),
        "power": Stage("wind", blow_power, (*where, p.exponent, *p.mean, air)),
        "log": Stage("wind", blow_log, (*where, p.roughness, *p.mean, air)),
    }[p.profile]
    # Gusts move with the wind: where the scene has them, they need to know it once a step, too.
    return Stages(step=(stage,) if "gusts" in setting.active else (), force=(stage,))
