"""Contacts: for each pair that touches or nearly does, a normal and up to eight points, kept from step to step."""

from typing import Any

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.kernel import kernel

POINTS = 8  # of a manifold, at most
BOXES, OTHERS, GROUND, MESHES, SWEPT = range(5)  # the parts that manifolds stand in
PARTS = 5
SAME_SIDE = 0.9  # cosine of the angle up to which a contact is still that of the step before


class Manifolds:
    """Contacts between bodies a < b, in parts: those of boxes, then of spheres and floors, of uneven ground and of
    meshes, of which a pair may have several, and of fast bodies; each part in the order of (a, b). Beyond `points[i]`
    points of manifold i hold nothing."""

    def __init__(self, capacity: int) -> None:
        self.end: Integers = np.zeros(PARTS, np.int64)  # where each part ends
        self.pair: Integers = np.empty((capacity, 2), np.int64)  # a, b
        self.level: Integers = np.empty(capacity, np.int64)  # at which the two met
        self.points: Integers = np.empty(capacity, np.int64)  # how many
        self.normal_w: Floats = np.empty((capacity, 3))  # unit, from a to b
        self.point_w: Floats = np.empty((capacity, POINTS, 3))  # m, midway between the surfaces
        self.anchor_w: Floats = np.empty((capacity, POINTS, 2, 3))  # m, from the centres of a and b, as the step starts
        self.separation: Floats = np.empty((capacity, POINTS))  # m, negative where they overlap
        self.feature: Integers = np.empty((capacity, POINTS), np.int64)  # names a point from step to step
        self.impulse: Floats = np.empty((capacity, POINTS))  # N s, along the normal, of the last sub-step
        self.friction: Floats = np.empty((capacity, 2, 4))  # of the first four points, and of the others: N s in the
        # world, N m s about the normal; of the last sub-step
        self.total: Floats = np.empty((capacity, POINTS))  # N s, along the normal, in the whole step
        self.last = Last(capacity)  # what is kept of the step before

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.end[-1])

    @count.setter
    def count(self, count: int) -> None:
        self.end[-1] = count

    @property
    def capacity(self) -> int:
        return len(self.points)

    def forget(self) -> None:
        """There are no contacts, and there were none."""
        self.end[:] = self.last.end[:] = 0

    def with_room(self, more: int) -> "Manifolds":
        """These, or a larger copy that holds so many more."""
        if self.count + more <= self.capacity:
            return self
        larger = Manifolds(2 * (self.count + more))
        larger.last = self.last.with_room(larger.capacity)
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                count = PARTS if name == "end" else self.count
                getattr(larger, name)[:count] = value[:count]
        return larger


class Last:
    """What is kept of a step's manifolds: how those of the next start, and what touched."""

    def __init__(self, capacity: int) -> None:
        self.end: Integers = np.zeros(PARTS, np.int64)
        self.pair: Integers = np.empty((capacity, 2), np.int64)
        self.level: Integers = np.empty(capacity, np.int64)
        self.points: Integers = np.empty(capacity, np.int64)
        self.normal_w: Floats = np.empty((capacity, 3))
        self.point_w: Floats = np.empty((capacity, POINTS, 3))
        self.feature: Integers = np.empty((capacity, POINTS), np.int64)
        self.impulse: Floats = np.empty((capacity, POINTS))
        self.friction: Floats = np.empty((capacity, 2, 4))
        self.touch: Floats = np.empty((capacity, 5))  # as `touches` writes it

    def with_room(self, capacity: int) -> "Last":
        """These, or a larger copy that holds so many."""
        if capacity <= len(self.points):
            return self
        larger = Last(capacity)
        for name, value in vars(self).items():
            count = PARTS if name == "end" else self.end[-1]
            getattr(larger, name)[:count] = value[:count]
        return larger

    def arrays(self) -> tuple[Any, ...]:
        """As `keep` and `carry_over` take them."""
        return (self.end, self.pair, self.level, self.points, self.normal_w, self.point_w, self.feature, self.impulse,
                self.friction, self.touch)


@kernel
def touches(i, points, point, separation, total, out):
    """Writes how manifold i touches: its deepest point, the depth there, the impulse of the step; depth and impulse are
    not both 0 or less where it does."""
    best, impulse = 0, 0.0
    for k in range(points[i]):
        impulse += total[i, k]
        if separation[i, k] < separation[i, best]:
            best = k
    out[0], out[1], out[2], out[3], out[4] = (point[i, best, 0], point[i, best, 1], point[i, best, 2],
                                              -separation[i, best], impulse)


@kernel
def keep(end, pair, level, points, normal, point, separation, feature, impulse, friction, total, last_end, last_pair,
         last_level, last_points, last_normal, last_point, last_feature, last_impulse, last_friction,
         last_touch):
    """Copies what is kept of the manifolds, before those of another step are found."""
    for part in range(PARTS):
        last_end[part] = end[part]
    for i in range(end[PARTS - 1]):
        last_pair[i, 0], last_pair[i, 1] = pair[i, 0], pair[i, 1]
        last_points[i], last_level[i] = points[i], level[i]
        for c in range(3):
            last_normal[i, c] = normal[i, c]
        for c in range(4):
            last_friction[i, 0, c], last_friction[i, 1, c] = friction[i, 0, c], friction[i, 1, c]
        for k in range(points[i]):
            last_feature[i, k], last_impulse[i, k] = feature[i, k], impulse[i, k]
            for c in range(3):
                last_point[i, k, c] = point[i, k, c]
        touches(i, points, point, separation, total, last_touch[i])


@kernel
def anchor(first, count, pair, points, point, position, anchors):
    """Writes for the points of manifolds first to count where they are from the centres of the two bodies."""
    for i in range(first, count):
        for k in range(points[i]):
            for side in range(2):
                for c in range(3):
                    anchors[i, k, side, c] = point[i, k, c] - position[pair[i, side], c]


@kernel
def carry_over(end, pair, points, normal, point, feature, impulse, friction, last_end, last_pair, last_level,
               last_points, last_normal, last_point, last_feature, last_impulse, last_friction,
         last_touch):
    """Starts each manifold with the impulses and the friction that the one of the same pair, and of nearly the same
    normal, ended the last step with. Both stand in the order of their pairs."""
    for part in range(PARTS):
        first, last = (end[part - 1], last_end[part - 1]) if part else (0, 0)
        for i in range(first, end[part]):
            a, b = pair[i, 0], pair[i, 1]
            while last < last_end[part] and (last_pair[last, 0] < a
                                             or (last_pair[last, 0] == a and last_pair[last, 1] < b)):
                last += 1
            for k in range(points[i]):
                impulse[i, k] = 0.0
            for c in range(4):
                friction[i, 0, c] = friction[i, 1, c] = 0.0
            known = last if part != SWEPT else last_end[part]
            while known < last_end[part] and last_pair[known, 0] == a and last_pair[known, 1] == b:
                if (normal[i, 0] * last_normal[known, 0] + normal[i, 1] * last_normal[known, 1]
                        + normal[i, 2] * last_normal[known, 2]) > SAME_SIDE:
                    for m in range(last_points[known]):
                        k = _heir(i, known, m, points, point, feature, last_point, last_feature)
                        impulse[i, k] += last_impulse[known, m]
                    for c in range(4):
                        friction[i, 0, c], friction[i, 1, c] = last_friction[known, 0, c], last_friction[known, 1, c]
                known += 1


@kernel
def _heir(i, known, m, points, point, feature, last_point, last_feature):
    """The point of manifold i that goes on from point m of the one before: of the same name, else the nearest, so that
    nothing that carried is lost when faces turn a hair and their corners are others."""
    best, least = 0, 1e300
    for k in range(points[i]):
        if feature[i, k] == last_feature[known, m]:
            return k
        square = 0.0
        for c in range(3):
            square += (point[i, k, c] - last_point[known, m, c]) ** 2
        if square < least:
            best, least = k, square
    return best
