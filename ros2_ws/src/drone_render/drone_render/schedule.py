"""When to draw what: live pictures evenly in wall time, films without a gap."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from drone_render.history import History, Moment, Timetable
from drone_render.view import Array
from drone_sim.wire.cdr import SECOND

LATE = 5  # periods; what is older is not worth watching, but a short jam is caught up with
PAUSE = 0.25  # s; a longer wait for a state is no pace but a pause


@dataclass
class Due:
    """A moment to draw from the wall time `at`, in s, on: for those who watch, for the film, or for both."""

    moment: Moment
    at: float
    live: bool
    film: bool


class Schedule:
    """Turns states that arrive into moments to draw. Rates in Hz; film None for no film.

    The stamps between two states are due when the later one arrives, and spread over the time until the next.
    """

    def __init__(
        self, names: Sequence[str], start: Array, physics: float, live: float, film: float | None = None
    ) -> None:  # fmt: skip
        self.history = History(names, start)
        self.dropped = 0
        self._live = Timetable(live)
        self._film = None if film is None else Timetable(film)
        self._due: deque[Due] = deque()
        self._late = LATE * SECOND / min(physics, live)  # ns
        self._shown: int | None = None  # stamp of the last live moment
        self._arrived: float | None = None
        self._pace = 1 / physics  # s of wall time between two states

    def push(self, stamp: int, children: Sequence[str], poses: Array, now: float) -> None:
        """Takes the poses of objects at `stamp` in ns, which arrived at the wall time `now` in s."""
        states = self.history.push(stamp, children, poses)
        if states is None:
            return
        if self._arrived is not None and now - self._arrived < PAUSE:
            self._pace += 0.1 * (now - self._arrived - self._pace)
        self._arrived = now
        before, after = states
        live = set(self._live.due(before.stamp, after.stamp))
        film = set() if self._film is None else set(self._film.due(before.stamp, after.stamp))
        stamps = sorted(live | film)
        for i, due in enumerate(stamps):
            at = now + self._pace * i / len(stamps)
            self._due.append(Due(Moment(due, before, after), at, due in live, due in film))

    def end_film(self) -> None:
        """No more moments for a film."""
        self._film = None
        for due in self._due:
            due.film = False

    def wait(self, now: float) -> float | None:
        """How long until something is due, in s; None if nothing is known to be."""
        return max(self._due[0].at - now, 0.0) if self._due else None

    def pop(self, now: float) -> Due | None:
        """The next moment that is due. Live ones that are too late are dropped and counted, but for one now and then,
        as a film that is behind would let nobody see anything; film is never."""
        while self._due and self._due[0].at <= now:
            due = self._due.popleft()
            stamp = due.moment.stamp
            waited = self._shown is None or not 0 <= stamp - self._shown < self._late
            if due.live and not waited and self.history.latest.stamp - stamp > self._late:
                due.live = False
                self.dropped += 1
            if due.live:
                self._shown = stamp
            if due.live or due.film:
                return due
        return None
