"""Broad phase: a uniform grid finds the pairs of boxes that may touch.

A box stands in every cell that it overlaps, so that neighbours are never missed; a pair comes out once, from the
cell that holds the lowest corner of what the two boxes share. Cells live in a table of buckets addressed by a
hash of their coordinates, so the world has no bounds. Boxes over more than LARGE cells are tested against all.
"""

import math

import numpy as np

from drone_sim.arrays import Booleans, Floats, Integers
from drone_sim.kernel import kernel

LARGE = 64


@kernel
def bounds(position, axes, half, velocity, dt, margin, low, high):
    """World AABBs of boxes, grown by `margin` and by the way that each moves in dt; axes: (n, 3, 3), rows."""
    for i in range(position.shape[0]):
        for k in range(3):
            reach = (abs(axes[i, 0, k]) * half[i, 0] + abs(axes[i, 1, k]) * half[i, 1]
                     + abs(axes[i, 2, k]) * half[i, 2] + margin)
            way = velocity[i, k] * dt
            low[i, k] = position[i, k] - reach + min(way, 0.0)
            high[i, k] = position[i, k] + reach + max(way, 0.0)


@kernel
def overlap(low, high, i, j):
    """Whether two AABBs share a point."""
    return (low[i, 0] <= high[j, 0] and low[j, 0] <= high[i, 0]
            and low[i, 1] <= high[j, 1] and low[j, 1] <= high[i, 1]
            and low[i, 2] <= high[j, 2] and low[j, 2] <= high[i, 2])


@kernel
def _cell(x, y, z, size):
    """The cell that a point lies in."""
    return math.floor(x / size), math.floor(y / size), math.floor(z / size)


@kernel
def bucket(x, y, z, mask):
    """Where a cell stands in the table (Teschner et al. 2003, Optimized Spatial Hashing, 3)."""
    return ((x * 73856093) ^ (y * 19349663) ^ (z * 83492791)) & mask


@kernel
def find_pairs(low, high, solid, movable, size, heads, entries, pair_a, pair_b):
    """Writes pairs a < b of solid boxes that overlap, one of them movable; returns (pairs, entries) that there are.

    More than the buffers hold is counted and not written: the caller grows them and calls again.
    heads: (power of two,) the newest entry of each bucket. entries: (m, 5), one a box and cell: the next older
    entry of the bucket, the box, the cell.
    """
    n = low.shape[0]
    mask = heads.shape[0] - 1
    heads[:] = -1
    entry_count = 0
    pair_count = 0
    large = np.zeros(n, np.bool_)
    for i in range(n):
        if not solid[i]:
            continue
        x0, y0, z0 = _cell(low[i, 0], low[i, 1], low[i, 2], size)
        x1, y1, z1 = _cell(high[i, 0], high[i, 1], high[i, 2], size)
        if (x1 - x0 + 1.0) * (y1 - y0 + 1.0) * (z1 - z0 + 1.0) > LARGE:
            large[i] = True
            continue
        for x in range(x0, x1 + 1):
            for y in range(y0, y1 + 1):
                for z in range(z0, z1 + 1):
                    here = bucket(x, y, z, mask)
                    e = heads[here]
                    while e >= 0:
                        j = entries[e, 1]
                        if (entries[e, 2] == x and entries[e, 3] == y and entries[e, 4] == z
                                and (movable[i] or movable[j]) and overlap(low, high, i, j)
                                and (x, y, z) == _cell(max(low[i, 0], low[j, 0]), max(low[i, 1], low[j, 1]),
                                                       max(low[i, 2], low[j, 2]), size)):
                            if pair_count < pair_a.shape[0]:
                                pair_a[pair_count], pair_b[pair_count] = j, i
                            pair_count += 1
                        e = entries[e, 0]
                    if entry_count < entries.shape[0]:
                        entries[entry_count, 0] = heads[here]
                        entries[entry_count, 1] = i
                        entries[entry_count, 2], entries[entry_count, 3], entries[entry_count, 4] = x, y, z
                        heads[here] = entry_count
                    entry_count += 1
    for i in range(n):
        if not large[i]:
            continue
        for j in range(n):
            if not solid[j] or i == j or (large[j] and j < i) or not (movable[i] or movable[j]):
                continue
            if overlap(low, high, i, j):
                if pair_count < pair_a.shape[0]:
                    pair_a[pair_count], pair_b[pair_count] = min(i, j), max(i, j)
                pair_count += 1
    return pair_count, entry_count


class Grid:
    """The broad phase with its buffers."""

    def __init__(self, half: Floats) -> None:
        """half: (n, 3) half extents of the boxes in m; cells are twice their mean size."""
        n = max(len(half), 1)
        self.size = float(4.0 * np.median(half)) if len(half) else 1.0
        self._heads = np.empty(1 << max(4, int(np.ceil(np.log2(4 * n)))), np.int64)
        self._entries = np.empty((16 * n, 5), np.int64)
        self._pairs = np.empty((2, 4 * n), np.int64)

    def pairs(self, low: Floats, high: Floats, solid: Booleans, movable: Booleans) -> tuple[Integers, Integers]:
        """Pairs a < b of overlapping boxes, sorted by a, then b."""
        while True:
            pairs, entries = find_pairs(low, high, solid, movable, self.size, self._heads, self._entries, *self._pairs)
            if entries > len(self._entries):
                self._entries = np.empty((2 * entries, 5), np.int64)
            elif pairs > self._pairs.shape[1]:
                self._pairs = np.empty((2, 2 * pairs), np.int64)
            else:
                break
        a, b = self._pairs[:, :pairs]
        order = np.lexsort((b, a))
        return a[order], b[order]
