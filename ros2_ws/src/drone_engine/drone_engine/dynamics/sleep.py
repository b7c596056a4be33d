"""Sleep: bodies that have rested on each other for a while are left out until something touches one of them.

Bodies that touch, one through the other, make an island; it falls asleep as a whole, and wakes as a whole. What its
contacts were is kept, so that it wakes up as it fell asleep.
"""

from typing import Any

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.events import ContactPoints, TouchingPairs, all_touches, contact_points, touching_pairs
from drone_engine.collision.manifold import PARTS, SWEPT
from drone_engine.collision.pipeline import Detection
from drone_engine.context import Context
from drone_engine.kernel import kernel
from drone_engine.program.stage import Stage

QUIET = 0.005  # m/s, the fastest point of a body that rests
PATIENCE = 0.5  # s for which it has to
KEPT = ("pair", "level", "points", "normal_w", "point_w", "feature", "impulse", "friction_impulse")  # of a manifold
SHOWN = ("anchor_w", "separation")  # of a manifold: kept for those who look at what sleeps


@kernel
def disturbed(contacts, sleeping):
    """Whether a body that is awake has come near one that sleeps."""
    end, pair = contacts.end, contacts.pair
    for i in range(end[PARTS - 1]):
        if sleeping[pair[i, 0]] or sleeping[pair[i, 1]]:
            return 1
    return 0


@kernel
def fall_asleep(awake, still, velocity, angular_velocity, radius, dt, drone_body, landed, contacts, movable, root,
                patience, borne):
    """Counts for how long bodies have been still; returns whether an island has been for long enough, and writes for
    each body the first of its island, root (n,), and for that the time of its last to come to rest: 0 if no contact
    bears it, borne (n,), as what merely stands still for a moment may be about to fall."""
    end, pair, points, total = contacts.end, contacts.pair, contacts.points, contacts.total
    drone, angular = drone_body, angular_velocity
    tired = False
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        square, turning = 0.0, 0.0
        for c in range(3):
            square += velocity[i, c] * velocity[i, c]
            turning += angular[i, c] * angular[i, c]
        speed = square**0.5 + turning**0.5 * radius[i]
        still[i] = still[i] + dt if speed < QUIET else 0.0
    for d in range(drone.shape[0]):
        if not landed[d]:
            still[drone[d]] = 0.0
    for k in range(1, 1 + awake[0]):
        tired = tired or still[awake[k]] >= PATIENCE
        root[awake[k]] = awake[k]
        patience[awake[k]] = still[awake[k]]
    if not tired:
        return 0
    for i in range(end[PARTS - 1]):
        a, b = pair[i, 0], pair[i, 1]
        if movable[a] and movable[b]:
            while root[a] != a:
                root[a] = root[root[a]]
                a = root[a]
            while root[b] != b:
                root[b] = root[root[b]]
                b = root[b]
            root[max(a, b)] = min(a, b)
    sleepers = 0
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        a = i
        while root[a] != a:
            a = root[a]
        root[i] = a
        patience[a] = min(patience[a], still[i])
        borne[i] = False
    for i in range(end[PARTS - 1]):
        for k in range(points[i]):
            if total[i, k] > 0.0:
                for body in pair[i]:
                    borne[root[body]] = borne[root[body]] or movable[body]
    for k in range(1, 1 + awake[0]):
        if not borne[root[awake[k]]]:
            patience[root[awake[k]]] = 0.0
    for k in range(1, 1 + awake[0]):
        sleepers += patience[root[awake[k]]] >= PATIENCE
    return sleepers


class Sleep:
    """The stages that wake and send to sleep, and the contacts of those who sleep."""

    def __init__(self, context: Context, detection: Detection) -> None:
        n = context.model.bodies.count
        self._context, self._detection = context, detection
        self._radius: Floats = np.linalg.norm(context.model.bodies.half, axis=1)
        self._root, self._patience, self._borne = np.zeros(n, np.int64), np.zeros(n), np.zeros(n, np.bool_)
        self.forget()
        detection.on_waking = self._hand_over
        self.waking = Stage("waking", disturbed, context.scope, handle=self._wake_disturbed,
                            writes=("awake", "still"))
        self.falling_asleep = Stage("sleep", fall_asleep, context.scope, {
            "radius": self._radius, "root": self._root, "patience": self._patience, "borne": self._borne},
            self._send_to_sleep, writes=("awake", "velocity", "angular_velocity"))

    def forget(self) -> None:
        """Nobody sleeps."""
        self._part: Integers = np.empty(0, np.int64)
        self._kept: dict[str, Any] = {}

    @property
    def touching(self) -> TouchingPairs:
        """Pairs that touch in their sleep."""
        if not len(self._part):
            return touching_pairs(np.empty((0, 2), np.int64), np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 5)))
        return touching_pairs(*(self._kept[name] for name in ("pair", "level", "normal_w", "touch")))

    @property
    def contacts(self) -> ContactPoints | None:
        """Where they touch; None if nobody sleeps."""
        if not len(self._part):
            return None
        return contact_points(*(self._kept[name] for name in ("pair", "points", "normal_w", *SHOWN, "touch")))

    def wake(self, bodies: Integers) -> None:
        """Wakes these bodies and their islands."""
        woken = np.zeros(self._context.model.bodies.count, np.bool_)
        woken[bodies] = True
        movable = self._context.model.bodies.movable
        if len(self._part):
            pair = self._kept["pair"]
            joins = movable[pair].all(axis=1)
            while True:
                touched = woken[pair].any(axis=1) & joins
                if woken[pair[touched]].all():
                    break
                woken[pair[touched]] = True
        s = self._context.state
        s.still[woken & movable] = 0.0
        self._set_awake(s.is_awake | (woken & movable))

    def _set_awake(self, awake: np.ndarray) -> None:
        which = np.flatnonzero(awake)
        s = self._context.state
        s.awake[:] = 0
        s.awake[0], s.awake[1 : 1 + len(which)] = len(which), which

    def _wake_disturbed(self, code: int) -> Stage:
        m = self._detection.manifolds
        pair = m.pair[: m.count]
        self.wake(np.unique(pair[self._detection.sleeping[pair]]))
        return self._detection.broad_phase

    def _hand_over(self) -> None:
        """Gives the contacts of those who have woken to the last step's, from which this step's start."""
        if not len(self._part):
            return
        m, movable = self._detection.manifolds, self._context.model.bodies.movable
        back = (self._context.state.is_awake | ~movable)[self._kept["pair"]].all(axis=1)
        if not back.any():
            return
        count = int(m.last.end[-1])
        part = np.repeat(np.arange(PARTS), np.diff(m.last.end, prepend=0))
        part = np.concatenate([part, self._part[back]])
        joined = {name: np.concatenate([getattr(m.last, name)[:count], self._kept[name][back]])
                  for name in (*KEPT, "touch")}
        order = np.lexsort((joined["pair"][:, 1], joined["pair"][:, 0], part))
        m.last.reserve(2 * len(order))
        for name, array in joined.items():
            getattr(m.last, name)[: len(order)] = array[order]
        m.last.end[:] = np.searchsorted(part[order], np.arange(PARTS), side="right")
        self._part = self._part[~back]
        self._kept = {name: array[~back] for name, array in self._kept.items()}

    def _send_to_sleep(self, code: int) -> None:
        s, m = self._context.state, self._detection.manifolds
        awake = s.is_awake
        asleep = awake & (self._patience[self._root] >= PATIENCE)
        s.velocity_w[asleep] = s.angular_velocity_w[asleep] = 0.0
        self._set_awake(awake & ~asleep)
        rows = np.flatnonzero(asleep[m.pair[: m.end[SWEPT - 1]]].any(axis=1))
        part = np.searchsorted(m.end, rows, side="right")
        touch = np.empty((m.count, 5))
        all_touches(m.count, m.points, m.point_w, m.separation, m.total, touch)
        kept = {name: getattr(m, name)[rows] for name in (*KEPT, *SHOWN)} | {"touch": touch[rows]}
        self._part = np.concatenate([self._part, part])
        self._kept = {name: np.concatenate([self._kept[name], array]) if self._kept else array
                      for name, array in kept.items()}
