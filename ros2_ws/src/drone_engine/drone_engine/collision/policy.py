"""Collision policy: the level and the number of contacts of each pair of bodies; both may change at run time."""

from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Integers
from drone_engine.collision_level import OCTREE, UNSET
from drone_engine.kernel import kernel
from drone_engine.model import CollisionSettings


class PolicyTables(NamedTuple):
    """Settings of n bodies and k pairs, each a collision level and 1 for all contacts, 0 for the deepest, or UNSET."""

    default: Integers  # (2,) of the scene
    body_overrides: Integers  # (n, 2)
    pair_keys: Integers  # (k,) a * n + b of pairs a < b, ascending
    pair_overrides: Integers  # (k, 2)


@kernel
def look_up(count, pair_a, pair_b, default, body_overrides, pair_keys, pair_overrides, level, all_contacts):
    """Writes the collision level of the first `count` pairs a < b, and 1 for all contacts, 0 for the deepest alone.

    An override for the pair takes precedence, else the finer of the two bodies' overrides applies, else the default.
    `default` to `pair_overrides` as in `PolicyTables`.
    """
    for i in range(count):
        a, b = pair_a[i], pair_b[i]
        at = 0
        if pair_keys.shape[0]:
            key = a * body_overrides.shape[0] + b
            at = np.searchsorted(pair_keys, key)
            overridden = at < pair_keys.shape[0] and pair_keys[at] == key
        else:
            overridden = False
        for column, out in ((0, level), (1, all_contacts)):
            setting = pair_overrides[at, column] if overridden else UNSET
            if setting == UNSET:
                setting = max(body_overrides[a, column], body_overrides[b, column])
            out[i] = setting if setting != UNSET else default[column]


class CollisionPolicy:
    """Collision-level settings: those of the scene, plus run-time overrides."""

    def __init__(self, settings: CollisionSettings) -> None:
        self._settings, self._changed = settings, True
        self.clear()

    def clear(self) -> bool:
        """Drops all run-time overrides; returns whether there were any."""
        settings = self._settings
        changed, self._changed = self._changed, False
        self._default = np.array([settings.level, settings.all_contacts])
        self._body_overrides: Integers = np.stack([settings.body_level, settings.body_contacts], axis=1)
        self._pairs = dict(settings.pairs)
        self._sort_pairs()
        return changed

    def set(self, level: int, a: int | None = None, b: int | None = None) -> None:
        """Sets the level of a pair of bodies, of all pairs of body a, or of all bodies without an override."""
        self._changed = True
        if a is None:
            self._default[0] = level
        elif b is None:
            self._body_overrides[a, 0] = level
        else:
            pair = min(a, b), max(a, b)
            self._pairs[pair] = level, self._pairs.get(pair, (UNSET, UNSET))[1]
            self._sort_pairs()

    def _sort_pairs(self) -> None:
        """Rebuilds the arrays of the pairs' overrides, in ascending order of their keys."""
        pairs = sorted(self._pairs.items())
        self._pair_keys = np.array([a * len(self._body_overrides) + b for (a, b), _ in pairs], np.int64)
        self._pair_overrides = np.array([setting for _, setting in pairs], np.int64).reshape(-1, 2)

    def tables(self) -> PolicyTables:
        """The settings as `look_up` takes them."""
        return PolicyTables(self._default, self._body_overrides, self._pair_keys, self._pair_overrides)

    @property
    def default(self) -> int:
        """The level of all bodies without an override."""
        return int(self._default[0])

    def uses(self, level: int) -> bool:
        """Whether this level may apply to any pair."""
        return level == self.default or level in self._body_overrides[:, 0] or level in self._pair_overrides[:, 0]

    @property
    def uses_meshes(self) -> bool:
        """Whether the mesh of any body may be needed."""
        return len(self.mesh_bodies()) > 0

    def mesh_bodies(self) -> Integers:
        """The bodies whose meshes may be needed, ascending."""
        if self.default >= OCTREE or (self._body_overrides[:, 0] >= OCTREE).any():
            return np.arange(len(self._body_overrides))  # any body may touch one with a finer level
        of_pairs = {body for pair, (level, _) in self._pairs.items() if level >= OCTREE for body in pair}
        return np.array(sorted(of_pairs), np.int64)
