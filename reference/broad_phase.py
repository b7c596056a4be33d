"""Broad phase: random bounds of many sizes, and all pairs by brute force."""

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers

Boxes = tuple[Floats, Floats]  # low, high


def brute_force(low: Floats, high: Floats, movable: Booleans) -> Integers:
    """All pairs a < b, (k, 2) in order, whose closed bounds overlap and of which at least one body is movable."""
    meet = ((low[:, None] <= high[None]) & (low[None] <= high[:, None])).all(axis=2)
    return np.argwhere(np.triu(meet & (movable[:, None] | movable[None]), 1))


def random_boxes(seed: int, count: int, sizes: tuple[float, float], crowd: float = 2.0) -> Boxes:
    """Bounds low and high (count, 3); half extents are log-uniform between `sizes` (m).

    crowd: edge of the cube that holds the centers, in units of the largest half extent.
    """
    rng = np.random.default_rng(seed)
    half = np.exp(rng.uniform(np.log(sizes[0]), np.log(sizes[1]), (count, 1))) * rng.uniform(0.5, 1.0, (count, 3))
    center = rng.uniform(-1, 1, (count, 3)) * sizes[1] * crowd
    return center - half, center + half
