"""When pictures are drawn: live ones evenly spaced in wall time, those of a film without gaps."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from drone_engine.arrays import Floats
from drone_render.frame.history import SECOND, FrameTimes, History, Moment

LATE_PERIODS = 5  # a live picture that is late by more is dropped; a short delay is caught up with
MAX_PERIOD = 0.25  # s; a longer interval between states is a pause, and is not averaged into the period


@dataclass
class Due:
    """A moment to draw from the wall time `at`, in s, on; for live subscribers, for the film, or for both."""

    moment: Moment
    at: float
    live: bool
    film: bool


class Schedule:
    """Turns arriving states into moments to draw.

    names, start: as for History; physics: rate of the states; live, film: rates of pictures, in Hz; film is None if no
    film is made. The moments between two states are due when the later state has arrived, spread evenly over the wall
    time until the next one is expected.
    """

    def __init__(
        self, names: Sequence[str], start: Floats, physics: float, live: float, film: float | None = None
    ) -> None:  # fmt: skip
        self.history = History(names, start)
        self.dropped = 0
        """Number of live pictures dropped so far."""
        self._live = FrameTimes(live)
        self._film = None if film is None else FrameTimes(film)
        self._due: deque[Due] = deque()
        self._late = LATE_PERIODS * SECOND / min(physics, live)  # ns
        self._shown: int | None = None  # stamp of the last live picture
        self._arrived: float | None = None  # wall time of the last state, s
        self._period = 1 / physics  # s of wall time between two states, a moving average

    def push(self, stamp: int, children: Sequence[str], poses: Floats, now: float) -> None:
        """Adds a state as History.push does; now: the wall time of its arrival, in s."""
        states = self.history.push(stamp, children, poses)
        if states is None:
            return
        if self._arrived is not None and now - self._arrived < MAX_PERIOD:
            self._period += 0.1 * (now - self._arrived - self._period)
        self._arrived = now
        before, after = states
        live = set(self._live.between(before.stamp, after.stamp))
        film = set() if self._film is None else set(self._film.between(before.stamp, after.stamp))
        stamps = sorted(live | film)
        for i, due in enumerate(stamps):
            at = now + self._period * i / len(stamps)
            self._due.append(Due(Moment(due, before, after), at, due in live, due in film))

    def end_film(self) -> None:
        """Schedules no more moments for the film."""
        self._film = None
        for due in self._due:
            due.film = False

    def wait(self, now: float) -> float | None:
        """Wall time in s until the next moment is due; None if none is scheduled."""
        return max(self._due[0].at - now, 0.0) if self._due else None

    def pop(self, now: float) -> Due | None:
        """Removes and returns the next moment that is due at the wall time `now` in s, or None.

        Live pictures that are late are dropped and counted, except one every LATE_PERIODS, so that a slow film does not
        stop the live pictures. Pictures of the film are never dropped.
        """
        while self._due and self._due[0].at <= now:
            due = self._due.popleft()
            stamp = due.moment.stamp
            overdue = self._shown is None or not 0 <= stamp - self._shown < self._late
            if due.live and not overdue and self.history.latest.stamp - stamp > self._late:
                due.live = False
                self.dropped += 1
            if due.live:
                self._shown = stamp
            if due.live or due.film:
                return due
        return None
