"""Begin, persist and end: how the contacts of a step differ from those of the step before; worked out when asked."""

from collections.abc import Callable
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.manifold import POINTS, Manifolds, touches
from drone_engine.kernel import kernel

NEAR = 1e-3  # m; points of a manifold that are told as touching when its deepest does

Vector = tuple[float, float, float]


class Phase(IntEnum):
    """As drone_interfaces/CollisionEvent numbers them."""

    BEGIN = 0
    PERSIST = 1
    END = 2


class Event(NamedTuple):
    """One pair of bodies, by index, a < b. m, N s; the normal points from a to b; world frame."""

    phase: Phase
    a: int
    b: int
    level: int
    point: Vector
    normal: Vector
    depth: float
    impulse: float


class Touching(NamedTuple):
    """k pairs of bodies that overlap or push each other, each once, in order; being near is not touching."""

    key: Integers  # (k,) a << 32 | b
    level: Integers  # (k,)
    normal: Floats  # (k, 3)
    touch: Floats  # (k, 5) deepest point, depth, impulse


class Contacts(NamedTuple):
    """k points at which bodies touch, and m manifolds that they are of."""

    pair: Integers  # (m, 2) a < b
    normal: Floats  # (m, 3) from a to b, world
    manifold: Integers  # (k,)
    arm: Floats  # (k, 2, 3) m from the centres of a and b, world, as the step started


class Meetings(NamedTuple):
    """Events as arrays: those of the pairs that touch, then those of the pairs that no longer do."""

    phase: Integers  # (k,)
    of: Touching  # (k,) as they touch, or did last


@kernel
def all_touches(count, points, point, separation, total, out):
    """Writes how each manifold touches, (m, 5)."""
    for i in range(count):
        touches(i, points, point, separation, total, out[i])


def touching(pair: Integers, level: Integers, normal: Floats, touch: Floats) -> Touching:
    """Those manifolds that touch, one for each pair: the deepest, with the impulses of all."""
    rows = np.flatnonzero((touch[:, 3] >= 0.0) | (touch[:, 4] > 0.0))
    key = pair[rows, 0] << 32 | pair[rows, 1]
    order = np.lexsort((-touch[rows, 3], key))  # of a pair the deepest first
    rows, key = rows[order], key[order]
    first = np.flatnonzero(np.diff(key, prepend=-1))
    chosen = touch[rows[first]]
    if len(first):
        chosen[:, 4] = np.add.reduceat(touch[rows, 4], first)
    chosen[:, 3] = np.maximum(chosen[:, 3], 0.0)
    return Touching(key[first], level[rows[first]], normal[rows[first]], chosen)


def contacts(pair: Integers, points: Integers, normal: Floats, anchor: Floats, separation: Floats,
             touch: Floats) -> Contacts:
    """The points of the manifolds that touch: the deepest one, and what is as deep within NEAR."""
    rows = np.flatnonzero((touch[:, 3] >= 0.0) | (touch[:, 4] > 0.0))
    deepest = np.maximum(-touch[rows, 3], 0.0)
    held = np.arange(POINTS) < points[rows, None]
    held[held] = (separation[rows] <= deepest[:, None] + NEAR)[held]
    return Contacts(pair[rows], normal[rows], np.nonzero(held)[0], anchor[rows][held])


def joined(one: Contacts, other: Contacts) -> Contacts:
    """Those of both."""
    manifold = np.concatenate([one.manifold, other.manifold + len(one.pair)])
    return Contacts(np.concatenate([one.pair, other.pair]), np.concatenate([one.normal, other.normal]), manifold,
                    np.concatenate([one.arm, other.arm]))


class Events:
    """What began, went on and ended to touch in the last step."""

    def __init__(self, manifolds: Callable[[], Manifolds], asleep: Callable[[], Touching]) -> None:
        """asleep: pairs that touch in their sleep, which goes on."""
        self._manifolds, self._asleep = manifolds, asleep

    @property
    def current(self) -> Meetings:
        m = self._manifolds()
        count, touch = m.count, np.empty((m.count, 5))
        all_touches(count, m.points, m.point_w, m.separation, m.total, touch)
        now = touching(m.pair[:count], m.level[:count], m.normal_w[:count], touch)
        last, old = m.last, m.last.end[-1]
        before = touching(last.pair[:old], last.level[:old], last.normal_w[:old], last.touch[:old])
        asleep = self._asleep()
        sleeping = ~np.isin(asleep.key, now.key)  # those that fell asleep in this step are in both
        now = Touching(*(np.concatenate([one, other[sleeping]]) for one, other in zip(now, asleep, strict=True)))
        went_on = np.isin(now.key, np.concatenate([before.key, asleep.key]))
        ended = ~np.isin(before.key, now.key)
        phase = np.concatenate([np.where(went_on, Phase.PERSIST, Phase.BEGIN), np.full(ended.sum(), Phase.END)])
        return Meetings(phase, Touching(*(np.concatenate([one, other[ended]])
                                          for one, other in zip(now, before, strict=True))))


def as_events(meetings: Meetings) -> list[Event]:
    """One tuple for each."""
    phase, of = [Phase(number) for number in range(3)], meetings.of
    return [Event(phase[p], key >> 32, key & 0xFFFFFFFF, level, (x, y, z), tuple(normal), depth, impulse)
            for p, key, level, normal, (x, y, z, depth, impulse) in zip(
                meetings.phase.tolist(), of.key.tolist(), of.level.tolist(), of.normal.tolist(), of.touch.tolist(),
                strict=True)]
