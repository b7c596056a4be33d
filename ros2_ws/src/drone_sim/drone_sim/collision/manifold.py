"""The contacts of a step: for each pair that touches or nearly does, a normal and up to eight points."""

import numpy as np

from drone_sim.arrays import Floats, Integers
from drone_sim.kernel import kernel

POINTS = 8  # of a manifold, at most


class Manifolds:
    """Contacts between bodies a < b, in the order of (a, b). Points beyond `points[i]` of manifold i hold nothing."""

    def __init__(self, capacity: int) -> None:
        self.count = 0
        self.pair: Integers = np.empty((capacity, 2), np.int64)  # a, b
        self.points: Integers = np.empty(capacity, np.int64)  # how many
        self.normal_w: Floats = np.empty((capacity, 3))  # unit, from a to b
        self.point_w: Floats = np.empty((capacity, POINTS, 3))  # m, midway between the surfaces
        self.separation: Floats = np.empty((capacity, POINTS))  # m, negative where they overlap
        self.feature: Integers = np.empty((capacity, POINTS), np.int64)  # names a point from step to step
        self.impulse: Floats = np.empty((capacity, POINTS, 3))  # N s: along the normal and two tangents, per sub-step
        self.total: Floats = np.empty((capacity, POINTS))  # N s: along the normal, in the whole step

    @property
    def capacity(self) -> int:
        return len(self.points)


@kernel
def carry_over(count, pair, points, feature, impulse, old_count, old_pair, old_points, old_feature, old_impulse):
    """Starts each point with the impulses that the point of the same pair and feature ended the last step with."""
    old = 0
    for i in range(count):
        a, b = pair[i, 0], pair[i, 1]
        while old < old_count and (old_pair[old, 0] < a or (old_pair[old, 0] == a and old_pair[old, 1] < b)):
            old += 1
        known = old < old_count and old_pair[old, 0] == a and old_pair[old, 1] == b
        for k in range(points[i]):
            impulse[i, k, 0] = impulse[i, k, 1] = impulse[i, k, 2] = 0.0
            if known:
                for m in range(old_points[old]):
                    if old_feature[old, m] == feature[i, k]:
                        for c in range(3):
                            impulse[i, k, c] = old_impulse[old, m, c]
                        break
