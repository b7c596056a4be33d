"""Contact events: which pairs began, continued and ceased to touch between two steps; computed only on request."""

from collections.abc import Callable
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.manifold import POINTS, Manifolds, touches
from drone_engine.kernel import kernel

DEPTH_RANGE = 1e-3  # m; points of a touching manifold count as touching down to this much above its deepest one

Vector = tuple[float, float, float]


class Phase(IntEnum):
    """Phase of a contact, numbered as in drone_interfaces/CollisionEvent."""

    BEGIN = 0
    PERSIST = 1
    END = 2


class Event(NamedTuple):
    """A contact event of bodies a < b, by index. Point and depth in m, impulse in N s; world frame."""

    phase: Phase
    a: int
    b: int
    level: int
    point: Vector
    normal: Vector  # unit, from a to b
    depth: float
    impulse: float


class TouchingPairs(NamedTuple):
    """k pairs of bodies that overlap or exchange an impulse, each once, in ascending order of key."""

    key: Integers  # (k,) a << 32 | b
    level: Integers  # (k,) collision level
    normal: Floats  # (k, 3) unit, from a to b, world
    touch: Floats  # (k, 5) deepest point in m, depth in m, impulse of the step in N s


NO_PAIRS = TouchingPairs(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 5)))


class ContactPoints(NamedTuple):
    """k points at which bodies touch, of m manifolds."""

    pair: Integers  # (m, 2) a < b
    normal: Floats  # (m, 3) unit, from a to b, world
    manifold: Integers  # (k,) index of each point's manifold
    arm: Floats  # (k, 2, 3) m from the centers of a and b, world, at the start of the step


class ContactEvents(NamedTuple):
    """k events as arrays: first the pairs that touch, then those that ceased to."""

    phase: Integers  # (k,) as `Phase`
    pairs: TouchingPairs  # (k,) as they touch, or did last


@kernel
def all_touches(count, points, point, separation, total, out):
    """Writes a summary of each of the first `count` manifolds to out (m, 5): deepest point, depth, impulse."""
    for i in range(count):
        touches(i, points, point, separation, total, out[i])


def touching_pairs(pair: Integers, level: Integers, normal: Floats, touch: Floats) -> TouchingPairs:
    """The pairs that touch, each once: its deepest manifold, with the impulses of all its manifolds added up.

    Of m manifolds: pair (m, 2), level (m,), normal (m, 3), touch (m, 5) as `all_touches` writes it.
    """
    rows = np.flatnonzero((touch[:, 3] >= 0.0) | (touch[:, 4] > 0.0))
    key = pair[rows, 0] << 32 | pair[rows, 1]
    order = np.lexsort((-touch[rows, 3], key))  # the deepest manifold of each pair first
    rows, key = rows[order], key[order]
    first = np.flatnonzero(np.diff(key, prepend=-1))
    chosen = touch[rows[first]]
    if len(first):
        chosen[:, 4] = np.add.reduceat(touch[rows, 4], first)
    chosen[:, 3] = np.maximum(chosen[:, 3], 0.0)
    return TouchingPairs(key[first], level[rows[first]], normal[rows[first]], chosen)


def contact_points(pair: Integers, points: Integers, normal: Floats, anchor: Floats, separation: Floats,
                   touch: Floats) -> ContactPoints:
    """The points of touching manifolds that touch: the deepest one of each, and those within DEPTH_RANGE of it.

    Of m manifolds: pair (m, 2), points (m,) counts, normal (m, 3), anchor (m, POINTS, 2, 3), separation (m, POINTS),
    touch (m, 5) as `all_touches` writes it.
    """
    rows = np.flatnonzero((touch[:, 3] >= 0.0) | (touch[:, 4] > 0.0))
    deepest = np.maximum(-touch[rows, 3], 0.0)
    included = np.arange(POINTS) < points[rows, None]
    included[included] = (separation[rows] <= deepest[:, None] + DEPTH_RANGE)[included]
    return ContactPoints(pair[rows], normal[rows], np.nonzero(included)[0], anchor[rows][included])


def concatenated(one: ContactPoints, other: ContactPoints) -> ContactPoints:
    """The points and manifolds of both."""
    manifold = np.concatenate([one.manifold, other.manifold + len(one.pair)])
    return ContactPoints(np.concatenate([one.pair, other.pair]), np.concatenate([one.normal, other.normal]), manifold,
                         np.concatenate([one.arm, other.arm]))


class EventDetector:
    """Compares the contacts of the last step with those of the step before."""

    def __init__(self, manifolds: Manifolds, asleep: Callable[[], TouchingPairs]) -> None:
        """asleep: touching pairs of sleeping bodies; they count as persisting."""
        self._manifolds, self._asleep = manifolds, asleep

    @property
    def current(self) -> ContactEvents:
        """The events of the last step."""
        m = self._manifolds
        count, touch = m.count, np.empty((m.count, 5))
        all_touches(count, m.points, m.point_w, m.separation, m.total, touch)
        now = touching_pairs(m.pair[:count], m.level[:count], m.normal_w[:count], touch)
        last, old = m.last, m.last.end[-1]
        before = touching_pairs(last.pair[:old], last.level[:old], last.normal_w[:old], last.touch[:old])
        asleep = self._asleep()
        sleeping = ~np.isin(asleep.key, now.key)  # pairs that fell asleep in this step are in both
        now = TouchingPairs(*(np.concatenate([one, other[sleeping]]) for one, other in zip(now, asleep, strict=True)))
        persists = np.isin(now.key, np.concatenate([before.key, asleep.key]))
        ended = ~np.isin(before.key, now.key)
        phase = np.concatenate([np.where(persists, Phase.PERSIST, Phase.BEGIN), np.full(ended.sum(), Phase.END)])
        return ContactEvents(phase, TouchingPairs(*(np.concatenate([one, other[ended]])
                                                    for one, other in zip(now, before, strict=True))))


def event_list(events: ContactEvents) -> list[Event]:
    """The events as one tuple each."""
    phase, pairs = [Phase(number) for number in range(3)], events.pairs
    return [Event(phase[p], key >> 32, key & 0xFFFFFFFF, level, (x, y, z), tuple(normal), depth, impulse)
            for p, key, level, normal, (x, y, z, depth, impulse) in zip(
                events.phase.tolist(), pairs.key.tolist(), pairs.level.tolist(), pairs.normal.tolist(),
                pairs.touch.tolist(), strict=True)]
