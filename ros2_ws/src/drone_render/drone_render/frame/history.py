"""The states of the simulation, and the moments between them at which pictures are due."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from drone_engine.arrays import Floats
from drone_render.frame.poses import interpolate

SECOND = 1_000_000_000  # ns
MAX_GAP = 60 * SECOND  # ns; states further apart belong to different runs
NORM_TOLERANCE = 0.02  # of the square of a quaternion's norm; the same as in tf2
STAMP_TOLERANCE = 1_000  # ns; a stamp that was rounded to ns is still on time


@dataclass(frozen=True)
class State:
    """The objects after a step: stamp in ns; poses (n, 7), each in its parent's frame."""

    stamp: int
    poses: Floats


@dataclass(frozen=True)
class Moment:
    """The stamp of a picture, in ns, and the states before and after it."""

    stamp: int
    before: State
    after: State

    def poses(self) -> Floats:
        """Poses (n, 7) at the stamp, interpolated. They depend on the two states and the stamp only, bit for bit."""
        fraction = (self.stamp - self.before.stamp) / (self.after.stamp - self.before.stamp)
        return interpolate(self.before.poses, self.after.poses, min(fraction, 1.0))


class FrameTimes:
    """The stamps of pictures at a rate in Hz: k / rate for integer k, rounded to ns."""

    def __init__(self, rate: float) -> None:
        self._rate = Fraction(rate).limit_denominator(1_000_000)

    def between(self, after: int, until: int) -> Iterator[int]:
        """The stamps in (after, until], in ns. Consecutive intervals yield every stamp exactly once."""
        first = (after + STAMP_TOLERANCE) * self._rate // SECOND + 1
        last = (until + STAMP_TOLERANCE) * self._rate // SECOND
        for k in range(int(first), int(last) + 1):
            yield round(k * SECOND / self._rate)


class History:
    """Keeps the latest state of the objects `names`; `start` (n, 7): their poses before the first state."""

    def __init__(self, names: Sequence[str], start: Floats) -> None:
        self._row = {name: i for i, name in enumerate(names)}
        self.latest = State(0, start)
        self._has_state = False

    def push(self, stamp: int, children: Sequence[str], poses: Floats) -> tuple[State, State] | None:
        """Adds a state: stamp in ns, and poses (m, 7) of the m objects `children`; other objects keep their poses.

        Ignores names that are not in the scene, and poses with non-finite numbers or without a unit quaternion.
        Returns the previous state and the new one; None for the first one, and if time went back or jumped by more than
        MAX_GAP, as there is nothing to interpolate then.
        """
        square = np.einsum("ij,ij->i", poses[:, 3:], poses[:, 3:])
        valid = np.isfinite(poses).all(axis=1) & (np.abs(square - 1) < NORM_TOLERANCE)
        known = [i for i, name in enumerate(children) if valid[i] and name in self._row]
        if not known:
            return None
        before = self.latest
        merged = before.poses.copy()
        merged[[self._row[children[i]] for i in known]] = poses[known]
        self.latest = State(stamp, merged)
        if not self._has_state or not 0 < stamp - before.stamp <= MAX_GAP:
            self._has_state = True
            return None
        return before, self.latest
