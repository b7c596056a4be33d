"""Sleep: bodies that have rested on each other for a while are left out of a step until something comes near.

Bodies in contact, directly or through others, make an island, which falls asleep and wakes as a whole. The manifolds of
sleeping bodies are kept, so that an island continues with the impulses that it fell asleep with.
"""

from typing import Any

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.events import (
    NO_PAIRS,
    ContactPoints,
    TouchingPairs,
    all_touches,
    contact_points,
    touching_pairs,
)
from drone_engine.collision.manifold import PARTS, SWEPT
from drone_engine.collision.pipeline import Detection
from drone_engine.context import Context
from drone_engine.kernel import kernel
from drone_engine.math.rigid_motion import max_point_speed
from drone_engine.program.stage import Stage

SLEEP_SPEED = 0.005  # m/s: a body rests while no point of it is faster
TIME_TO_SLEEP = 0.5  # s for which all bodies of an island have to rest
# Fields of Manifolds that are kept of sleeping bodies: for the warm start when they wake, and for the debug view.
WARM_START = ("pair", "level", "points", "normal_w", "point_w", "feature", "impulse", "friction_impulse")
DEBUG_VIEW = ("anchor_w", "separation")


@kernel
def disturbed(contacts, sleeping):
    """Whether something awake has come near a sleeping body: 1 if so, else 0. sleeping: (n,) bool."""
    for i in range(contacts.end[-1]):
        if sleeping[contacts.pair[i, 0]] or sleeping[contacts.pair[i, 1]]:
            return 1
    return 0


@kernel
def fall_asleep(awake, still, velocity, angular_velocity, radius, dt, drone_body, landed, contacts, movable, island,
                rest_time, supported):
    """Finds the islands that may fall asleep: all bodies have rested for TIME_TO_SLEEP, and a contact carries one of
    them. What merely stands still for a moment may be about to fall. Returns the number of their bodies.

    awake: list of bodies, their number first; still: (n,) s for which each has rested, in and out; velocity,
    angular_velocity: (n, 3), world; radius: (n,) m, of the bounding spheres; dt: s, of the step; drone_body, landed:
    (d,) drones, which rest only once they have landed; contacts: ContactArrays after the solver; movable: (n,). Out,
    unless the return value is 0 at once: island, (n,) the first body of each body's island; rest_time, (n,) at that
    first body, s for which the island has rested, 0 without support; supported: (n,) scratch.
    """
    _update_still(awake, still, velocity, angular_velocity, radius, dt, drone_body, landed)
    candidates = False
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        candidates = candidates or still[i] >= TIME_TO_SLEEP
        island[i], rest_time[i] = i, still[i]
    if not candidates:
        return 0
    _join_islands(contacts, movable, island)
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        first = _first(island, i)
        island[i] = first
        rest_time[first] = min(rest_time[first], still[i])
        supported[i] = False
    for i in range(contacts.end[-1]):
        for p in range(contacts.points[i]):
            if contacts.total[i, p] > 0.0:
                for body in contacts.pair[i]:
                    supported[island[body]] = supported[island[body]] or movable[body]
    sleepers = 0
    for k in range(1, 1 + awake[0]):
        first = island[awake[k]]
        if not supported[first]:
            rest_time[first] = 0.0
        sleepers += rest_time[first] >= TIME_TO_SLEEP
    return sleepers


@kernel
def _update_still(awake, still, velocity, angular_velocity, radius, dt, drone_body, landed):
    """Adds dt to the rest times of bodies below SLEEP_SPEED, and resets the others; parameters as of fall_asleep."""
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        rests = max_point_speed(i, velocity, angular_velocity, radius[i]) < SLEEP_SPEED
        still[i] = still[i] + dt if rests else 0.0
    for d in range(drone_body.shape[0]):
        if not landed[d]:
            still[drone_body[d]] = 0.0


@kernel
def _join_islands(contacts, movable, island):
    """Union-find over the manifolds of two movable bodies, with path halving. island: (n,) parent of each body, in and
    out; roots are the lowest bodies."""
    for i in range(contacts.end[-1]):
        a, b = contacts.pair[i, 0], contacts.pair[i, 1]
        if movable[a] and movable[b]:
            while island[a] != a:
                island[a] = island[island[a]]
                a = island[a]
            while island[b] != b:
                island[b] = island[island[b]]
                b = island[b]
            island[max(a, b)] = min(a, b)


@kernel
def _first(island, i):
    """The first body of the island of body i: the root of union-find."""
    while island[i] != i:
        i = island[i]
    return i


class Sleep:
    """The stages that wake bodies and let them fall asleep, and the manifolds of sleeping bodies."""

    def __init__(self, context: Context, detection: Detection) -> None:
        n = context.model.bodies.count
        self._context, self._detection = context, detection
        self._island: Integers = np.zeros(n, np.int64)
        self._rest_time: Floats = np.zeros(n)
        self.forget()
        detection.on_waking = self._restore_manifolds
        self.waking = Stage("waking", disturbed, context.scope, handle=self._wake_disturbed,
                            writes=("awake", "still"))
        self.falling_asleep = Stage("sleep", fall_asleep, context.scope, {
            "radius": np.linalg.norm(context.model.bodies.half, axis=1), "island": self._island,
            "rest_time": self._rest_time, "supported": np.zeros(n, np.bool_)}, self._fall_asleep,
            writes=("awake", "velocity", "angular_velocity"))

    def forget(self) -> None:
        """Removes the manifolds of sleeping bodies."""
        self._part: Integers = np.empty(0, np.int64)  # of Manifolds, that each is stored in
        self._kept: dict[str, Any] = {}  # fields of Manifolds, and `touch` of PreviousArrays

    @property
    def touching(self) -> TouchingPairs:
        """Pairs of which both are asleep or do not move, and that touch."""
        if not len(self._part):
            return NO_PAIRS
        return touching_pairs(*(self._kept[name] for name in ("pair", "level", "normal_w", "touch")))

    @property
    def contacts(self) -> ContactPoints | None:
        """The points where those pairs touch; None if nothing sleeps."""
        if not len(self._part):
            return None
        return contact_points(*(self._kept[name] for name in ("pair", "points", "normal_w", *DEBUG_VIEW, "touch")))

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
        state = self._context.state
        state.still[woken & movable] = 0.0
        self._set_awake(state.is_awake | (woken & movable))

    def _set_awake(self, awake: Booleans) -> None:
        """Sets which bodies are awake, (n,)."""
        which, state = np.flatnonzero(awake), self._context.state
        state.awake[:] = 0
        state.awake[0], state.awake[1 : 1 + len(which)] = len(which), which

    def _wake_disturbed(self, code: int) -> Stage:
        """Wakes the bodies that something awake has come near. Their contacts have to be found, so detection is
        repeated."""
        manifolds = self._detection.manifolds
        pair = manifolds.pair[: manifolds.count]
        self.wake(np.unique(pair[self._detection.sleeping[pair]]))
        return self._detection.broad_phase

    def _restore_manifolds(self) -> None:
        """Moves the manifolds of bodies that have woken to those of the step before, for the warm start."""
        if not len(self._part):
            return
        previous, movable = self._detection.manifolds.last, self._context.model.bodies.movable
        woken = (self._context.state.is_awake | ~movable)[self._kept["pair"]].all(axis=1)
        if not woken.any():
            return
        part = np.repeat(np.arange(PARTS), np.diff(previous.end, prepend=0))
        part = np.concatenate([part, self._part[woken]])
        joined = {name: np.concatenate([getattr(previous, name)[: previous.count], self._kept[name][woken]])
                  for name in (*WARM_START, "touch")}
        order = np.lexsort((joined["pair"][:, 1], joined["pair"][:, 0], part))
        previous.reserve(2 * len(order))
        for name, array in joined.items():
            getattr(previous, name)[: len(order)] = array[order]
        previous.end[:] = np.searchsorted(part[order], np.arange(PARTS), side="right")
        self._part = self._part[~woken]
        self._kept = {name: array[~woken] for name, array in self._kept.items()}

    def _fall_asleep(self, code: int) -> None:
        """Lets the islands that fall_asleep has found fall asleep, and keeps their manifolds."""
        state, manifolds = self._context.state, self._detection.manifolds
        awake = state.is_awake
        asleep = awake & (self._rest_time[self._island] >= TIME_TO_SLEEP)
        state.velocity_w[asleep] = state.angular_velocity_w[asleep] = 0.0
        self._set_awake(awake & ~asleep)
        rows = np.flatnonzero(asleep[manifolds.pair[: manifolds.end[SWEPT - 1]]].any(axis=1))
        part = np.searchsorted(manifolds.end, rows, side="right")
        touch = np.empty((manifolds.count, 5))
        all_touches(manifolds.count, manifolds.points, manifolds.point_w, manifolds.separation, manifolds.total, touch)
        kept = {name: getattr(manifolds, name)[rows] for name in (*WARM_START, *DEBUG_VIEW)} | {"touch": touch[rows]}
        self._part = np.concatenate([self._part, part])
        self._kept = {name: np.concatenate([self._kept[name], array]) if self._kept else array
                      for name, array in kept.items()}
