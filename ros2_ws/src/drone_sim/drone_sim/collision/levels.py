"""Which level a pair of bodies meets at, and how many contacts are asked for; both may change while the scene runs."""

import numpy as np

from drone_sim.arrays import Integers
from drone_sim.kernel import kernel
from drone_sim.model import OCTREE, UNSAID, Meeting


@kernel
def lookup(a, b, default, own, keys, words):
    """The word that decides for bodies a < b among n: the pair's own, else the finer of the bodies', else the default.

    own: (n,) or UNSAID; keys: (k,) a * n + b, ascending, of the pairs with a word of their own, words: (k,).
    """
    if keys.shape[0]:
        key = a * own.shape[0] + b
        i = np.searchsorted(keys, key)
        if i < keys.shape[0] and keys[i] == key and words[i] != UNSAID:
            return words[i]
    finer = max(own[a], own[b])
    return finer if finer != UNSAID else default


class Levels:
    """The words of the scene, and those that were said since."""

    def __init__(self, meeting: Meeting) -> None:
        self._meeting = meeting
        self.clear()

    def clear(self) -> None:
        """Back to what the scene says."""
        self.default, self.all_contacts = self._meeting.level, self._meeting.all_contacts
        self.own: Integers = self._meeting.own_level.copy()
        self._pairs = dict(self._meeting.pairs)
        self._sort()

    def set(self, level: int, a: int | None = None, b: int | None = None) -> None:
        """Sets the level of a pair of bodies, of all pairs of body a, or of all that say nothing of their own."""
        if a is None:
            self.default = level
        elif b is None:
            self.own[a] = level
        else:
            pair = min(a, b), max(a, b)
            self._pairs[pair] = level, self._pairs.get(pair, (UNSAID, UNSAID))[1]
            self._sort()

    def _sort(self) -> None:
        n = len(self.own)
        pairs = sorted(self._pairs.items())
        self._keys = np.array([a * n + b for (a, b), _ in pairs], np.int64)
        self._pair_words = np.array([words for _, words in pairs], np.int64).reshape(-1, 2)

    @property
    def of_level(self) -> tuple[int, Integers, Integers, Integers]:
        """What `lookup` needs to tell a pair's level."""
        return self.default, self.own, self._keys, self._pair_words[:, 0]

    @property
    def of_contacts(self) -> tuple[int, Integers, Integers, Integers]:
        """What `lookup` needs to tell whether a pair asks for all contacts (1) or the deepest point (0)."""
        return self.all_contacts, self._meeting.own_contacts, self._keys, self._pair_words[:, 1]

    def at(self, a: int, b: int) -> int:
        """The level that bodies a and b meet at, or NOT_AT_ALL."""
        return int(lookup(min(a, b), max(a, b), *self.of_level))

    def uses(self, level: int) -> bool:
        """Whether any pair may meet at this level."""
        return level in (self.default, *self.own.tolist(), *self._pair_words[:, 0].tolist())

    def meshes(self) -> Integers:
        """The bodies, ascending, of which the triangles may be asked for."""
        named = {body for pair, (level, _) in self._pairs.items() if level >= OCTREE for body in pair}
        if self.default >= OCTREE or (self.own >= OCTREE).any():
            named |= set(range(len(self.own)))  # each may meet one that is finer
        return np.array(sorted(named), np.int64)
