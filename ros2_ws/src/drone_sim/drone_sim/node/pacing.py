"""How many steps are due: ties simulated time to the wall clock without ever letting it jump."""

import math

MOST_AT_ONCE = 5  # steps; what a stall leaves beyond these is given up, and reported as lag


class Pacer:
    """Counts the steps that the wall clock asks for, from wall times given in s."""

    def __init__(self, rate: float, factor: float) -> None:
        """rate: steps per simulated s. factor: simulated s per wall s, more than 0."""
        self.period = 1.0 / (rate * factor)  # s of wall time a step
        self.lag = 0.0  # s of wall time given up so far
        self._next: float | None = None  # when the next step is due

    def due(self, now: float) -> int:
        """Steps to take now; call it at least once a period."""
        if self._next is None:
            self._next = now
        steps = int((now - self._next) / self.period) + 1 if now >= self._next else 0
        self._next += steps * self.period
        if steps > MOST_AT_ONCE:
            self.lag += (steps - MOST_AT_ONCE) * self.period
            steps = MOST_AT_ONCE
        return steps

    def restart(self) -> None:
        """Starts anew at the next call, after a pause that is nobody's lag."""
        self._next = None


class Share:
    """Something that may take a share of the time, from 0 to 1: what took long is due again after a longer rest."""

    def __init__(self, share: float) -> None:
        self._rest = 1.0 / share - 1.0
        self._next = -math.inf

    def due(self, now: float) -> bool:
        """Whether it may happen at `now` in s."""
        return now >= self._next

    def took(self, start: float, end: float) -> None:
        """It happened from `start` to `end`."""
        self._next = end + self._rest * (end - start)
