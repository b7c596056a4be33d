"""Result of a case of motion: measured numbers with their limits, and time series for the plots."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drone_engine.arrays import Floats

SHOWN = 200  # points of a series in a plot
DIGITS = 4  # significant digits of a plotted number


@dataclass(frozen=True)
class Criterion:
    """A measured number and the limit that it must not exceed, both in `unit`."""

    name: str
    value: float
    limit: float
    unit: str = ""

    @property
    def met(self) -> bool:
        """Whether the number is within its limit."""
        return self.value <= self.limit  # false for NaN

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.name}: {self.value:.4g}{unit}, at most {self.limit:g}{unit}"


@dataclass(frozen=True)
class Outcome:
    """Result of one run.

    series: arrays for the plots by name, each (k,) or (k, m).
    """

    criteria: tuple[Criterion, ...]
    series: dict[str, Floats] = field(default_factory=dict)

    @property
    def failures(self) -> list[str]:
        """The criteria that are not met, one line each."""
        return [str(c) for c in self.criteria if not c.met]

    def as_dict(self) -> dict[str, Any]:
        """The outcome as JSON: criteria under "reached", rounded series under "series"."""
        return {"reached": [{"what": c.name, "value": c.value, "limit": c.limit, "unit": c.unit, "met": c.met}
                            for c in self.criteria],
                "series": {name: _rounded(values) for name, values in self.series.items()}}


def thinned(series: Mapping[str, Sequence[Any]]) -> dict[str, Floats]:
    """Series reduced to about SHOWN points by a constant stride; a row is a number or several."""
    return {name: np.array(values[::max(1, len(values) // SHOWN)], float) for name, values in series.items()}


def _rounded(values: Floats) -> Any:
    if values.ndim > 1:
        return [_rounded(row) for row in values]
    return [float(f"{value:.{DIGITS}g}") for value in values.tolist()]
