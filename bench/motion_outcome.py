"""What a case of motion comes to: numbers beside the limits that they are held to, and what was measured on the way."""

from dataclasses import dataclass, field

import numpy as np

from drone_sim.arrays import Floats

SHOWN = 400  # points of a series that a plot needs


@dataclass(frozen=True)
class Reached:
    """A number that must not exceed its limit."""

    what: str
    value: float
    limit: float
    unit: str = ""

    @property
    def met(self) -> bool:
        return self.value <= self.limit  # and so not NaN

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.what}: {self.value:.4g}{unit}, at most {self.limit:g}{unit}"


@dataclass(frozen=True)
class Outcome:
    """Of one run; series: what a plot shows, each (k,) or (k, m), by name."""

    reached: tuple[Reached, ...]
    series: dict[str, Floats] = field(default_factory=dict)

    @property
    def failures(self) -> list[str]:
        return [str(one) for one in self.reached if not one.met]


def thinned(series: dict[str, list[float]]) -> dict[str, Floats]:
    """Of each run of points the first, the last, and in between those that a plot of SHOWN points can show."""
    found = {}
    for name, values in series.items():
        stride = max(1, len(values) // SHOWN)
        found[name] = np.array(values[::stride], float)
    return found
