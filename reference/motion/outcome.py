"""What a case of motion comes to: numbers beside the limits that they are held to, and what was measured on the way."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drone_engine.arrays import Floats

SHOWN = 200  # points of a series that a plot needs
DIGITS = 4  # of a number in a plot


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


    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"reached": [{"what": one.what, "value": one.value, "limit": one.limit, "unit": one.unit, "met": one.met}
                            for one in self.reached],
                "series": {name: _rounded(values) for name, values in self.series.items()}}


def thinned(series: Mapping[str, Sequence[Any]]) -> dict[str, Floats]:
    """Every so many points, as a plot of SHOWN points can show; each row a number or several."""
    return {name: np.array(values[::max(1, len(values) // SHOWN)], float) for name, values in series.items()}


def _rounded(values: Floats) -> Any:
    if values.ndim > 1:
        return [_rounded(row) for row in values]
    return [float(f"{value:.{DIGITS}g}") for value in values.tolist()]
