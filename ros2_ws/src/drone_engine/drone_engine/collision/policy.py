"""Which level a pair of bodies meets at, and how many contacts are asked for; both may change while the scene runs."""

import numpy as np

from drone_engine.arrays import Integers
from drone_engine.collision_level import OCTREE, UNSET
from drone_engine.kernel import kernel
from drone_engine.model import Meeting


@kernel
def lookup(pairs, pair_a, pair_b, default, own, keys, words, level, everything):
    """Writes the level of the first `pairs` pairs a < b, and 1 where it asks for all contacts, 0 for the deepest point
    alone: the pair's own word, else the finer of the bodies', else the default.

    default: (2,), own: (n, 2), words: (k, 2), each a level and contacts or UNSET; keys: (k,) a * n + b, ascending, of
    the pairs with words of their own.
    """
    for i in range(pairs):
        a, b = pair_a[i], pair_b[i]
        at = 0
        if keys.shape[0]:
            key = a * own.shape[0] + b
            at = np.searchsorted(keys, key)
            named = at < keys.shape[0] and keys[at] == key
        else:
            named = False
        for word, out in ((0, level), (1, everything)):
            said = words[at, word] if named else UNSET
            if said == UNSET:
                said = max(own[a, word], own[b, word])
            out[i] = said if said != UNSET else default[word]


class Levels:
    """The words of the scene, and those that were said since."""

    def __init__(self, meeting: Meeting) -> None:
        self._meeting, self._changed = meeting, True
        self.clear()

    def clear(self) -> bool:
        """Back to what the scene says; returns whether that changes anything."""
        meeting = self._meeting
        changed, self._changed = self._changed, False
        self._default = np.array([meeting.level, meeting.all_contacts])
        self._own: Integers = np.stack([meeting.own_level, meeting.own_contacts], axis=1)
        self._pairs = dict(meeting.pairs)
        self._sort()
        return changed

    def set(self, level: int, a: int | None = None, b: int | None = None) -> None:
        """Sets the level of a pair of bodies, of all pairs of body a, or of all that say nothing of their own."""
        self._changed = True
        if a is None:
            self._default[0] = level
        elif b is None:
            self._own[a, 0] = level
        else:
            pair = min(a, b), max(a, b)
            self._pairs[pair] = level, self._pairs.get(pair, (UNSET, UNSET))[1]
            self._sort()

    def _sort(self) -> None:
        pairs = sorted(self._pairs.items())
        self._keys = np.array([a * len(self._own) + b for (a, b), _ in pairs], np.int64)
        self._words = np.array([words for _, words in pairs], np.int64).reshape(-1, 2)

    def tables(self) -> tuple[Integers, Integers, Integers, Integers]:
        """The words as `lookup` takes them."""
        return self._default, self._own, self._keys, self._words

    @property
    def default(self) -> int:
        """The level of all that say nothing of their own."""
        return int(self._default[0])

    def uses(self, level: int) -> bool:
        """Whether any pair may meet at this level."""
        return level == self.default or level in self._own[:, 0] or level in self._words[:, 0]

    @property
    def uses_meshes(self) -> bool:
        """Whether the triangles of any body may be asked for."""
        return len(self.meshes()) > 0

    def meshes(self) -> Integers:
        """The bodies, ascending, of which the triangles may be asked for."""
        if self.default >= OCTREE or (self._own[:, 0] >= OCTREE).any():
            return np.arange(len(self._own))  # each may meet one that is finer
        named = {body for pair, (level, _) in self._pairs.items() if level >= OCTREE for body in pair}
        return np.array(sorted(named), np.int64)
