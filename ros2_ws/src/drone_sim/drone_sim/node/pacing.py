"""When steps and costly work are due, by the wall clock; a stall delays simulated time but never makes it jump."""

import math

MOST_AT_ONCE = 5  # steps; steps that a stall leaves beyond these are dropped and counted as lag


class Pacer:
    """Number of steps that are due, from wall times in s."""

    def __init__(self, rate: float, factor: float) -> None:
        """rate: steps per simulated s. factor: simulated s per wall s, more than 0."""
        self.period = 1.0 / (rate * factor)  # s of wall time a step
        self.lag = 0.0  # s of wall time dropped so far
        self._next: float | None = None  # when the next step is due

    def due(self, now: float) -> int:
        """Steps to take now, at most MOST_AT_ONCE; to be called at least once a period."""
        if self._next is None:
            self._next = now
        steps = int((now - self._next) / self.period) + 1 if now >= self._next else 0
        self._next += steps * self.period
        if steps > MOST_AT_ONCE:
            self.lag += (steps - MOST_AT_ONCE) * self.period
            steps = MOST_AT_ONCE
        return steps

    def restart(self) -> None:
        """Starts again at the next call; the time since the last call, a pause, is not lag."""
        self._next = None


class Share:
    """Limits work to a share of wall time, from 0 to 1: the longer it took, the later it is due again."""

    def __init__(self, share: float) -> None:
        self._rest = 1.0 / share - 1.0
        self._next = -math.inf

    def due(self, now: float) -> bool:
        """Whether the work may be done at `now`, in s."""
        return now >= self._next

    def took(self, start: float, end: float) -> None:
        """Records that the work was done from `start` to `end`, in s."""
        self._next = end + self._rest * (end - start)
