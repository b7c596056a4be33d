"""Broad phase: uniform grids find the pairs of boxes that may touch.

A box stands in every cell that it overlaps, so that neighbours are never missed, and a pair comes out once. Cells live
in a table of buckets addressed by a hash, so the world has no bounds. Where sizes differ by more than SPREAD there are
several grids, one a level, with cells that suit their boxes. What does not move is put into its table once.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.broad_phase.cells import FEW, fill, fits, meet, meet_others, overlap, put_in_order
from drone_engine.kernel import kernel

SPREAD = 16.0  # sizes of one level differ by no more
LEVELS = 8  # at most; the tags of cells.py have three bits for them
GROWTH = 2.0  # by how much a box may outgrow its level before there are new ones
CROWD = 64  # tests for each body and pair that tell that the cells may no longer suit
DONE, NEW_LEVELS, MORE_ENTRIES, MORE_PAIRS = range(4)
NONE: Integers = np.empty(0, np.int64)

Narrow = NDArray[np.int32]


class GridTables(NamedTuple):
    """The arrays of the broad phase, as `find_pairs` takes them; n bodies."""

    levels: Floats  # (k, 2) largest half side in m, cells per m
    static_top: Integers  # (1,) highest level of the bodies at rest
    static_start: Narrow  # hash table of the bodies at rest: where each bucket begins in static_entry
    static_entry: Integers
    start: Narrow  # the same of moving bodies
    bucket: Narrow  # scratch
    listed: Integers  # scratch
    entry: Integers
    marks: Narrow  # (2, n) scratch
    pair: Integers  # (2, k) scratch
    ordered: Integers  # (2, k) the pairs found, a < b, sorted


@kernel
def bound(i, position, axes, half, radius, velocity, dt, margin, low, high):
    """Writes the world AABB of box i, grown by `margin` and by the way that it moves in dt; axes: (n, 3, 3), rows; it
    reaches at least `radius` (n,) to all sides."""
    for k in range(3):
        reach = max(abs(axes[i, 0, k]) * half[i, 0] + abs(axes[i, 1, k]) * half[i, 1]
                    + abs(axes[i, 2, k]) * half[i, 2], radius[i]) + margin
        way = velocity[i, k] * dt
        low[i, k] = position[i, k] - reach + min(way, 0.0)
        high[i, k] = position[i, k] + reach + max(way, 0.0)


@kernel
def bounds(position, axes, half, radius, velocity, dt, margin, low, high):
    """The same of all boxes."""
    for i in range(position.shape[0]):
        bound(i, position, axes, half, radius, velocity, dt, margin, low, high)


@kernel
def stand(low, high, bodies, count, levels, home):
    """Writes the level that each of the bodies is at home in; returns whether the levels have one for all."""
    for k in range(count):
        i, level = bodies[k], 0
        while not fits(low, high, i, levels[level, 0]):
            level += 1
            if level == levels.shape[0]:
                return False
        home[i] = level
    return True


@kernel
def find_pairs(low, high, bodies, moving, planes, tables):
    """Writes the pairs of boxes that overlap, the first `moving` of `bodies` with each other, with those of the table
    static_* and with `planes`, bodies that are large: all are asked. Returns (DONE, how many, tests made), or what the
    caller has to renew first and how large it must be. levels: (k, 2) largest half side, cells per metre; static_top:
    (1,) its highest level; marks: (2, n), scratch."""
    levels, static_top, static_start, static_entry = (tables.levels, tables.static_top, tables.static_start,
                                                      tables.static_entry)
    start, bucket, listed, entry = tables.start, tables.bucket, tables.listed, tables.entry
    marks, pair, ordered = tables.marks, tables.pair, tables.ordered
    home, count = marks[0], marks[1]
    if not stand(low, high, bodies, moving, levels, home):
        return NEW_LEVELS, 0, 0
    per_metre = levels[:, 1]
    found = tests = 0
    if moving <= FEW:
        if moving * moving > pair.shape[1]:
            return MORE_PAIRS, 2 * moving * moving, 0
        for p in range(moving):
            for q in range(p + 1, moving):
                if overlap(low, high, bodies[p], bodies[q]):
                    pair[0, found] = bodies[p] << 32 | bodies[q]
                    found += 1
        tests = moving * (moving - 1) // 2
    else:
        answer, found, tests = _meet_in_table(low, high, bodies, moving, home, per_metre, start, bucket, listed, entry,
                                              pair)
        if answer != DONE:
            return answer, found, 0
    if found >= 0 and static_entry.shape[0]:
        found, more = meet_others(low, high, bodies, moving, home, per_metre, static_top[0], static_start, static_entry,
                                  pair[0], found)
        tests += more
    if found < 0 or found + planes.shape[0] * moving > pair.shape[1]:
        return MORE_PAIRS, 2 * pair.shape[1] + planes.shape[0] * moving, 0
    for plane in planes:
        for k in range(moving):
            pair[0, found] = plane << 32 | bodies[k]
            found += 1
    return DONE, put_in_order(low, high, pair[0], found, count, pair[1], ordered), tests


@kernel
def _meet_in_table(low, high, bodies, moving, home, per_metre, start, bucket, listed, entry, pair):
    """Pairs of moving bodies among themselves, by way of the cells that they stand in; returns as `find_pairs`, -1
    pairs if there is no room for them."""
    top = 0
    for k in range(moving):
        top = max(top, home[bodies[k]])
    buckets = 64
    while buckets < 2 * moving:
        buckets *= 2
    start = start[: buckets + 1]
    entries = fill(low, high, bodies, moving, home, per_metre, top, start, bucket, listed, entry)
    if entries > bucket.shape[0]:
        return MORE_ENTRIES, entries, 0
    found, tests = meet(start, entry, pair[0])
    return DONE, found, tests


@kernel
def changed(low, high, bodies, boxes):
    """Whether bodies have other bounds than boxes (2, k, 3)."""
    for k in range(bodies.shape[0]):
        for c in range(3):
            if boxes[0, k, c] != low[bodies[k], c] or boxes[1, k, c] != high[bodies[k], c]:
                return True
    return False


class Grid:
    """The broad phase with its buffers."""

    def __init__(self, half: Floats) -> None:
        """half: (n, 3) half extents of the boxes in m, which the sizes of cells follow until bounds tell more."""
        n = max(len(half), 1)
        self._wait = self._patience = 1  # crowded calls until the levels are thought over, and from then to the next
        self._marks = np.empty((2, n), np.int32)
        self._pairs, self.ordered = np.empty((2, 2, 8 * n), np.int64)
        self._start, self._bucket, self._listed, self._entry = _table(n, 8 * n)
        self._static, self._static_boxes, self._static_top = NONE, np.empty((2, 0, 3)), np.zeros(1, np.int64)
        self._static_start, _, _, self._static_entry = _table(1, 0)
        self._take_levels(_levels(-half, half))

    def pairs(self, low: Floats, high: Floats, solid: Booleans, movable: Booleans) -> tuple[Integers, Integers]:
        """Pairs a < b of overlapping boxes, sorted by a, then b. Raises ValueError for bounds that are no box."""
        self.room(len(low))
        movers, still = (np.flatnonzero(solid & which) for which in (movable, ~movable))
        self.settle(low, high, still)
        while True:
            answer, count, tests = find_pairs(low, high, movers, len(movers), NONE, self.tables())
            if answer == DONE:
                break
            self.renew(answer, count, low, high, movers)
        if tests > crowd(len(movers), count):
            self.think_over(low, high, movers)
        return self.ordered[0, :count].copy(), self.ordered[1, :count].copy()

    def room(self, bodies: int) -> None:
        """Makes room for so many."""
        if bodies > self._marks.shape[1]:
            self._marks = np.empty((2, bodies), np.int32)
            self._start, self._bucket, self._listed, self._entry = _table(bodies, 8 * bodies)

    def tables(self) -> GridTables:
        """The last arguments of `find_pairs`."""
        return GridTables(self._levels, self._static_top, self._static_start, self._static_entry, self._start,
                          self._bucket, self._listed, self._entry, self._marks, self._pairs, self.ordered)

    def renew(self, answer: int, count: int, low: Floats, high: Floats, movers: Integers) -> None:
        """Does what `find_pairs` asked for, so that it can be asked again. Raises ValueError for bounds of no box."""
        if answer == NEW_LEVELS:
            both = np.concatenate([movers, self._static])
            self._take_levels(_levels(*_checked(low[both], high[both])))
            self._bin(low, high, self._static)
        elif answer == MORE_ENTRIES:
            self._start, self._bucket, self._listed, self._entry = _table(self._marks.shape[1], 2 * count)
        elif answer == MORE_PAIRS:
            self._pairs, self.ordered = np.empty((2, 2, count), np.int64)

    def sectors(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """Lowest corners (k, 3) and edges (k,) in m of the cells that boxes stand in, each once."""
        reach = (high / 2 - low / 2).max(axis=1)
        level = np.minimum(np.searchsorted(self._levels[:, 0], reach), len(self._levels) - 1)
        per_metre = self._levels[level, 1:2]
        first = np.floor(low * per_metre)
        span = (np.floor(high * per_metre) - first).astype(np.int64) + 1
        cells = span.prod(axis=1)
        which = np.repeat(np.arange(len(level)), cells)
        nth = np.arange(cells.sum()) - np.repeat(np.cumsum(cells) - cells, cells)
        step = np.stack([nth // (span[which, 1] * span[which, 2]), nth // span[which, 2] % span[which, 1],
                         nth % span[which, 2]], axis=1)
        places = np.column_stack([level[which], first[which] + step])
        places = places[np.lexsort(places.T[::-1])]
        places = places[(np.diff(places, axis=0, prepend=np.nan) != 0).any(axis=1)]
        edges = 1.0 / self._levels[places[:, 0].astype(np.int64), 1]
        return places[:, 1:] * edges[:, None], edges

    def settle(self, low: Floats, high: Floats, still: Integers) -> None:
        """Bins bodies that will stay where they are, unless they are there already. Raises ValueError for bounds of no
        box."""
        if not np.array_equal(still, self._static) or changed(low, high, self._static, self._static_boxes):
            self._bin(low, high, still)

    def _bin(self, low: Floats, high: Floats, still: Integers) -> None:
        self._static, self._static_boxes = still, np.array([low[still], high[still]])
        home = self._marks[0]
        if not stand(low, high, still, len(still), self._levels, home):
            self._take_levels(_levels(*_checked(low[still], high[still])))
            stand(low, high, still, len(still), self._levels, home)
        self._static_top[0] = home[still].max(initial=0)
        entries = 8 * len(still)
        while True:
            self._static_start, bucket, listed, self._static_entry = _table(len(still), entries)
            entries = fill(low, high, still, len(still), home, self._levels[:, 1], len(self._levels) - 1,
                           self._static_start, bucket, listed, self._static_entry)
            if entries <= len(bucket):
                break

    def think_over(self, low: Floats, high: Floats, movers: Integers) -> None:
        """Takes levels that suit better, if there are; if not, waits twice as long until it looks again."""
        self._wait -= 1
        if self._wait == 0:
            both = np.concatenate([movers, self._static])
            levels = _levels(low[both], high[both])
            if levels.shape == self._levels.shape and np.allclose(levels, self._levels, rtol=0.5):
                self._patience *= 2
            else:
                self._patience = 1
                self._take_levels(levels)
                self._bin(low, high, self._static)
            self._wait = self._patience

    def _take_levels(self, levels: Floats) -> None:
        self._levels = np.ascontiguousarray(levels)


@kernel
def crowd(bodies, pairs):
    """How many tests tell that the cells may no longer suit."""
    return CROWD * (CROWD + bodies + pairs)


def _checked(low: Floats, high: Floats) -> tuple[Floats, Floats]:
    bad = np.flatnonzero(~(np.isfinite(low) & np.isfinite(high) & (low <= high)).all(axis=1))
    if len(bad):
        raise ValueError(f"bounds of a box need finite numbers, low up to high; got {low[bad[0]]} to {high[bad[0]]}")
    return low, high


def _table(bodies: int, entries: int) -> tuple[Narrow, Narrow, Integers, Integers]:
    """Empty arrays of a table: start of buckets, and for each entry its bucket, what is listed, what is sorted."""
    buckets = 1 << max(6, int(np.ceil(np.log2(2 * max(bodies, 1)))))
    return (np.zeros(buckets + 1, np.int32), np.empty(entries, np.int32), np.empty((entries, 3), np.int64),
            np.empty((entries, 3), np.int64))


def _levels(low: Floats, high: Floats) -> Floats:
    """Largest half side and cells per metre (k, 2) of levels that suit boxes: cells of twice their mean longest side.

    A level has boxes of SPREAD in size, so that its largest do not stand in too many cells; the finest takes the rest.
    """
    rows: list[tuple[float, float]] = []
    reach, far = (high / 2 - low / 2).max(axis=1, initial=0.0), np.maximum(-low, high).max(axis=1, initial=0.0)
    limit = np.inf
    while len(reach) and len(rows) < LEVELS:
        top = float(reach.max())
        inside = (reach >= top / SPREAD) | (len(rows) == LEVELS - 1)
        if top:
            edge = 4.0 * top * max(float(np.mean(reach[inside] / top)), 1.0 / SPREAD)
        else:  # points, so cells that only equal ones share
            edge = 2.0**-40 * float(far.max()) or 1.0
        rows.append((min(GROWTH * top, limit), 1.0 / max(edge, 1e-300)))
        limit = top / SPREAD
        reach, far = reach[~inside], far[~inside]
    return np.array(rows[::-1] or [(1.0, 1.0)])
