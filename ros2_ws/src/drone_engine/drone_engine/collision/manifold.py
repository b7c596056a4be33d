"""Contact manifolds: for each pair in contact or close to it a normal and up to eight points, kept from step to
step."""

from typing import NamedTuple, Self

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.kernel import kernel

POINTS = 8  # of a manifold, at most
# The parts that manifolds are stored in, one after the other: of boxes; of spheres and planes; of terrain; of meshes,
# of which a pair may have several; of bodies with continuous collision detection.
BOXES, OTHERS, GROUND, MESHES, SWEPT = range(5)
PARTS = 5
SAME_SIDE = 0.9  # cosine of the angle between two normals up to which a manifold continues that of the step before


class ContactArrays(NamedTuple):
    """The manifolds of a step, as kernels take them: m of them between bodies a < b, in the world frame."""

    end: Integers  # (PARTS,) where each part ends; the last one is m
    pair: Integers  # (m, 2) a, b
    level: Integers  # (m,) the collision level that found it
    points: Integers  # (m,) number of points
    normal: Floats  # (m, 3) unit, from a to b
    point: Floats  # (m, POINTS, 3) m, midway between the surfaces
    anchor: Floats  # (m, POINTS, 2, 3) m, from the centers of a and b, at the beginning of the step
    separation: Floats  # (m, POINTS) m, negative where the bodies overlap
    feature: Integers  # (m, POINTS) identifies a point from step to step
    impulse: Floats  # (m, POINTS) N s, along the normal, of the last sub-step
    friction_impulse: Floats  # (m, 2, 4) of the first four points, and of the others: N s in the world, N m s about the
    # normal; of the last sub-step
    total: Floats  # (m, POINTS) N s, along the normal, of the whole step


class PreviousArrays(NamedTuple):
    """What is kept of the manifolds of the step before, as kernels take them: for warm starts and for events."""

    end: Integers
    pair: Integers
    level: Integers
    points: Integers
    normal: Floats
    point: Floats
    feature: Integers
    impulse: Floats
    friction_impulse: Floats
    touch: Floats  # (m, 5) as `touches` writes it


class _Growing:
    """Named arrays with one row for each manifold, which grow in place, and `end`."""

    end: Integers

    @property
    def count(self) -> int:
        """Number of manifolds."""
        return int(self.end[-1])

    @count.setter
    def count(self, count: int) -> None:
        self.end[-1] = count

    @property
    def capacity(self) -> int:
        """Number of manifolds that there is room for."""
        return len(self.pair)  # type: ignore[attr-defined]

    def _grow(self, capacity: int) -> None:
        """Replaces the arrays by larger ones with the same contents."""
        for name, array in vars(self).items():
            if isinstance(array, np.ndarray) and name != "end":
                larger = np.empty((capacity, *array.shape[1:]), array.dtype)
                larger[: self.count] = array[: self.count]
                setattr(self, name, larger)


class Manifolds(_Growing):
    """The manifolds of a step, in parts, each part sorted by (a, b). Beyond `points[i]` the points of manifold i are
    undefined. Fields as in ContactArrays."""

    def __init__(self, capacity: int) -> None:
        self.end: Integers = np.zeros(PARTS, np.int64)
        self.pair: Integers = np.empty((capacity, 2), np.int64)
        self.level: Integers = np.empty(capacity, np.int64)
        self.points: Integers = np.empty(capacity, np.int64)
        self.normal_w: Floats = np.empty((capacity, 3))
        self.point_w: Floats = np.empty((capacity, POINTS, 3))
        self.anchor_w: Floats = np.empty((capacity, POINTS, 2, 3))
        self.separation: Floats = np.empty((capacity, POINTS))
        self.feature: Integers = np.empty((capacity, POINTS), np.int64)
        self.impulse: Floats = np.empty((capacity, POINTS))
        self.friction_impulse: Floats = np.empty((capacity, 2, 4))
        self.total: Floats = np.empty((capacity, POINTS))
        self.last = Previous(capacity)

    @property
    def arrays(self) -> ContactArrays:
        """As kernels take them; the arrays are replaced when they grow."""
        return ContactArrays(self.end, self.pair, self.level, self.points, self.normal_w, self.point_w, self.anchor_w,
                             self.separation, self.feature, self.impulse, self.friction_impulse, self.total)

    def forget(self) -> None:
        """Removes all manifolds, also those of the step before."""
        self.end[:] = self.last.end[:] = 0

    def reserve(self, more: int) -> Self:
        """Makes room for so many more; contents stay. Returns self."""
        if self.count + more > self.capacity:
            self._grow(2 * (self.count + more))
            self.last.reserve(self.capacity)
        return self


class Previous(_Growing):
    """What is kept of the manifolds of the step before. Fields as in PreviousArrays."""

    def __init__(self, capacity: int) -> None:
        self.end: Integers = np.zeros(PARTS, np.int64)
        self.pair: Integers = np.empty((capacity, 2), np.int64)
        self.level: Integers = np.empty(capacity, np.int64)
        self.points: Integers = np.empty(capacity, np.int64)
        self.normal_w: Floats = np.empty((capacity, 3))
        self.point_w: Floats = np.empty((capacity, POINTS, 3))
        self.feature: Integers = np.empty((capacity, POINTS), np.int64)
        self.impulse: Floats = np.empty((capacity, POINTS))
        self.friction_impulse: Floats = np.empty((capacity, 2, 4))
        self.touch: Floats = np.empty((capacity, 5))

    @property
    def arrays(self) -> PreviousArrays:
        """As kernels take them."""
        return PreviousArrays(self.end, self.pair, self.level, self.points, self.normal_w, self.point_w, self.feature,
                              self.impulse, self.friction_impulse, self.touch)

    def reserve(self, capacity: int) -> None:
        """Makes room for so many in total; contents stay."""
        if capacity > self.capacity:
            self._grow(capacity)


@kernel
def touches(i, points, point, separation, total, out):
    """Writes how manifold i touches to out (5,): its deepest point (m, world), the depth there (m), and the impulse of
    the step (N s). The bodies touch if the depth or the impulse is greater than 0."""
    best, impulse = 0, 0.0
    for k in range(points[i]):
        impulse += total[i, k]
        if separation[i, k] < separation[i, best]:
            best = k
    out[0], out[1], out[2], out[3], out[4] = (point[i, best, 0], point[i, best, 1], point[i, best, 2],
                                              -separation[i, best], impulse)


@kernel
def keep(contacts, previous):
    """Copies what is kept of the manifolds to `previous`, before those of the next step are found."""
    for part in range(PARTS):
        previous.end[part] = contacts.end[part]
    for i in range(contacts.end[PARTS - 1]):
        previous.pair[i, 0], previous.pair[i, 1] = contacts.pair[i, 0], contacts.pair[i, 1]
        previous.points[i], previous.level[i] = contacts.points[i], contacts.level[i]
        for c in range(3):
            previous.normal[i, c] = contacts.normal[i, c]
        for half in range(2):
            for c in range(4):
                previous.friction_impulse[i, half, c] = contacts.friction_impulse[i, half, c]
        for k in range(contacts.points[i]):
            previous.feature[i, k], previous.impulse[i, k] = contacts.feature[i, k], contacts.impulse[i, k]
            for c in range(3):
                previous.point[i, k, c] = contacts.point[i, k, c]
        touches(i, contacts.points, contacts.point, contacts.separation, contacts.total, previous.touch[i])


@kernel
def write_anchors(first, count, pair, points, point, position, anchor):
    """Writes the anchors of manifolds [first, count): their points (m, POINTS, 3) relative to the centers of both
    bodies, anchor (m, POINTS, 2, 3), m, world. pair: (m, 2); points: (m,); position: (n, 3)."""
    for i in range(first, count):
        for k in range(points[i]):
            for side in range(2):
                for c in range(3):
                    anchor[i, k, side, c] = point[i, k, c] - position[pair[i, side], c]


@kernel
def warm_start(contacts, previous):
    """Initializes the impulses of each manifold with those at the end of the last step of the manifold of the same pair
    with nearly the same normal, zero if there is none. Both are sorted by pair within each part."""
    pair, normal = contacts.pair, contacts.normal
    for part in range(PARTS):
        first, last = (contacts.end[part - 1], previous.end[part - 1]) if part else (0, 0)
        for i in range(first, contacts.end[part]):
            a, b = pair[i, 0], pair[i, 1]
            while last < previous.end[part] and (previous.pair[last, 0] < a
                                                 or (previous.pair[last, 0] == a and previous.pair[last, 1] < b)):
                last += 1
            for k in range(contacts.points[i]):
                contacts.impulse[i, k] = 0.0
            for c in range(4):
                contacts.friction_impulse[i, 0, c] = contacts.friction_impulse[i, 1, c] = 0.0
            known = last if part != SWEPT else previous.end[part]
            while known < previous.end[part] and previous.pair[known, 0] == a and previous.pair[known, 1] == b:
                if (normal[i, 0] * previous.normal[known, 0] + normal[i, 1] * previous.normal[known, 1]
                        + normal[i, 2] * previous.normal[known, 2]) > SAME_SIDE:
                    for m in range(previous.points[known]):
                        k = _successor(i, known, m, contacts, previous)
                        contacts.impulse[i, k] += previous.impulse[known, m]
                    for half in range(2):
                        for c in range(4):
                            contacts.friction_impulse[i, half, c] = previous.friction_impulse[known, half, c]
                known += 1


@kernel
def _successor(i, known, m, contacts, previous):
    """The point of manifold i that continues point m of the previous manifold `known`: the one with the same feature,
    else the nearest, so that no impulse is lost when faces turn slightly and other corners touch."""
    best, least = 0, 1e300
    for k in range(contacts.points[i]):
        if contacts.feature[i, k] == previous.feature[known, m]:
            return k
        square = 0.0
        for c in range(3):
            square += (contacts.point[i, k, c] - previous.point[known, m, c]) ** 2
        if square < least:
            best, least = k, square
    return best
