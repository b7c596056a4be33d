"""Which moments to draw, and what the world looked like at each: between the two states that enclose it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from drone_render.view import Array, interpolate
from drone_sim.wire.cdr import SECOND

LEAP = 60 * SECOND  # ns; what is further apart is another run, not a state that got lost
UNIT_WITHIN = 0.02  # that the square of a quaternion's norm is off 1, at most, as in tf2
SLACK = 1_000  # ns; a stamp that was rounded to ns is still on time


@dataclass(frozen=True)
class State:
    """The world after a step: stamp in ns, poses (n, 7) of all objects, each in its parent's frame."""

    stamp: int
    poses: Array


@dataclass(frozen=True)
class Moment:
    """A time to draw, in ns, and the states before and after it."""

    stamp: int
    before: State
    after: State

    def poses(self) -> Array:
        """Poses (n, 7) at the stamp. They follow from the two states alone, bit for bit."""
        fraction = (self.stamp - self.before.stamp) / (self.after.stamp - self.before.stamp)
        return interpolate(self.before.poses, self.after.poses, min(fraction, 1.0))


class Timetable:
    """The stamps k / rate, whole k, rounded to ns. Every stamp is due exactly once."""

    def __init__(self, rate: float) -> None:
        self._rate = Fraction(rate).limit_denominator(1_000_000)

    def due(self, after: int, until: int) -> Iterator[int]:
        """The stamps behind `after` and not behind `until`, in ns."""
        first = (after + SLACK) * self._rate // SECOND + 1
        last = (until + SLACK) * self._rate // SECOND
        for k in range(int(first), int(last) + 1):
            yield round(k * SECOND / self._rate)


class History:
    """Follows the states of the objects `names`; `start` (n, 7) are their poses before any state is known."""

    def __init__(self, names: Sequence[str], start: Array) -> None:
        self._row = {name: i for i, name in enumerate(names)}
        self.latest = State(0, start)
        self._known = False

    def push(self, stamp: int, children: Sequence[str], poses: Array) -> tuple[State, State] | None:
        """Takes the poses of some objects, in ns and (m, 7); names that are not the scene's are left out, and so are
        poses that are none.

        Returns the state before and the new one; None for the very first, and where time went back or leapt
        ahead: there is nothing in between then.
        """
        square = np.einsum("ij,ij->i", poses[:, 3:], poses[:, 3:])
        sound = np.isfinite(poses).all(axis=1) & (np.abs(square - 1) < UNIT_WITHIN)
        known = [i for i, name in enumerate(children) if sound[i] and name in self._row]
        if not known:
            return None
        before = self.latest
        merged = before.poses.copy()
        merged[[self._row[children[i]] for i in known]] = poses[known]
        self.latest = State(stamp, merged)
        if not self._known or not 0 < stamp - before.stamp <= LEAP:
            self._known = True
            return None
        return before, self.latest
