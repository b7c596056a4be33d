"""Mean wind: uniform, or with a boundary layer.

Power law: u(z) = u_r (z / z_r)^p, p = 1/7 over open land (Justus, Mikhail 1976). Logarithmic law:
u(z) = u_r ln(z / z_0) / ln(z_r / z_0), as in MIL-F-8785C, 3.7.3.2. Heights are over z = `ground`.
"""

import math
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from drone_engine.context import Context, Stages
from drone_engine.kernel import kernel
from drone_engine.scene.fields import Strict

LOWEST = 0.9144  # m, 3 ft: MIL-F-8785C gives no wind below; constant there


class Parameters(Strict):
    """Keys of the effect in a scene file."""

    mean: tuple[float, float, float] = (3.0, 0.0, 0.0)  # m/s, at the reference height
    profile: Literal["uniform", "power", "log"] = "uniform"
    reference: float = Field(10.0, ge=1.0, le=1000.0)  # m above ground; standard height of anemometers (WMO)
    exponent: float = Field(1 / 7, ge=0.0, le=1.0)  # of the power law
    roughness: float = Field(0.03, ge=1e-6, le=0.9)  # m, of the logarithmic law; grass (Davenport 1960, class 3)
    ground: float = 0.0  # m

    @model_validator(mode="after")
    def _not_a_storm(self) -> Self:
        if self.speed() > 150.0:
            raise ValueError(f"mean: expected a speed of at most 150 m/s, got {self.speed():g} m/s")
        return self

    def speed(self) -> float:
        """Speed at the reference height, m/s."""
        return math.hypot(*self.mean)

    def factor(self, height: float) -> float:
        """Speed at a height above ground (m), relative to that at the reference height."""
        if self.profile == "power":
            return float(power(height, self.reference, self.exponent))
        if self.profile == "log":
            return float(log(height, self.reference, self.roughness))
        return 1.0


@kernel
def power(height, reference, exponent):
    """The factor of the power law at a height in m: (height / reference)^exponent."""
    return (max(height, LOWEST) / reference) ** exponent


@kernel
def log(height, reference, roughness):
    """The factor of the logarithmic law at a height in m: ln(height / roughness) / ln(reference / roughness)."""
    return math.log(max(height, LOWEST) / roughness) / math.log(reference / roughness)


@kernel
def blow(awake, x, y, z, air_velocity):
    """Sets air_velocity (n, 3), m/s, around each awake body to (x, y, z). Runs before other effects that move the
    air."""
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        air_velocity[i, 0], air_velocity[i, 1], air_velocity[i, 2] = x, y, z


@kernel
def blow_power(awake, position, ground, reference, exponent, x, y, z, air_velocity):
    """As `blow`, times the power law over the height above `ground`, m; position: (n, 3) m; reference: m."""
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        factor = power(position[i, 2] - ground, reference, exponent)
        air_velocity[i, 0], air_velocity[i, 1], air_velocity[i, 2] = factor * x, factor * y, factor * z


@kernel
def blow_log(awake, position, ground, reference, roughness, x, y, z, air_velocity):
    """As `blow`, times the logarithmic law over the height above `ground`, m; reference, roughness: m."""
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        factor = log(position[i, 2] - ground, reference, roughness)
        air_velocity[i, 0], air_velocity[i, 1], air_velocity[i, 2] = factor * x, factor * y, factor * z


def build(parameters: Parameters, context: Context) -> Stages:
    """The stages of this effect."""
    p = parameters
    x, y, z = p.mean
    law: dict[str, Any] = {"ground": p.ground, "reference": p.reference}
    stage = {
        "uniform": context.stage("wind", blow, x=x, y=y, z=z),
        "power": context.stage("wind", blow_power, x=x, y=y, z=z, exponent=p.exponent, **law),
        "log": context.stage("wind", blow_log, x=x, y=y, z=z, roughness=p.roughness, **law),
    }[p.profile]
    # Gusts move with the wind, so where the scene has gusts the wind is needed once a step, too.
    return Stages(step=(stage,) if "gusts" in context.active else (), force=(stage,))
