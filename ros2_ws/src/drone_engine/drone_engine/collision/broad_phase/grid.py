"""Broad phase: hierarchical uniform grids find the pairs of AABBs that overlap.

A box has an entry in every cell that it overlaps, so that no neighbor is missed, and each pair is found once. The cells
are kept in a hash table, so the world has no bounds. Where sizes differ by more than SPREAD there are several grid
levels, each with cells that suit its boxes. Static boxes are put into a table of their own once.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.broad_phase.cells import (
    FEW,
    fill_table,
    find_pairs_with,
    find_pairs_within,
    fits,
    overlap,
    sort_pairs,
)
from drone_engine.kernel import kernel

SPREAD = 16.0  # largest ratio of sizes within one grid level
LEVELS = 8  # at most; a tag has three bits for the grid level
GROWTH = 2.0  # factor by which a box may outgrow its grid level before the levels are chosen again
TESTS_PER_PAIR = 64  # tests per body and pair above which the cells may no longer suit the boxes
DONE, NEW_LEVELS, MORE_ENTRIES, MORE_PAIRS = range(4)  # results of `find_pairs`
NONE: Integers = np.empty(0, np.int64)

Narrow = NDArray[np.int32]


class GridTables(NamedTuple):
    """The arrays of a grid of n bodies; see cells.py for entries."""

    levels: Floats  # (levels, 2) largest half side in m and cells per meter of each grid level, finest first
    static_top: Integers  # (1,) the highest grid level that a static body is stored in
    static_start: Narrow  # (buckets + 1,) where the static entries of each bucket begin
    static_entry: Integers  # (m, 3) entries of static bodies
    start: Narrow  # (buckets + 1,) of the moving bodies; rebuilt in each call, as the three below
    bucket: Narrow  # (m,) scratch: the bucket of each unsorted entry
    unsorted: Integers  # (m, 3) scratch: entries in the order in which they were made
    entry: Integers  # (m, 3) entries by bucket
    marks: Narrow  # (2, n) scratch: the grid level of each body, and counts
    pair: Integers  # (2, p) scratch: unsorted pairs a << 32 | b, and room to sort them
    ordered: Integers  # (2, p) the pairs a < b, sorted by a, then b


@kernel
def set_bounds(i, position, axes, half, least_reach, velocity, dt, margin, low, high):
    """Writes the world AABB of box i over the coming dt to row i of low and high (n, 3), grown by `margin`; m, s.

    It covers the motion at constant velocity, and reaches at least least_reach[i] from the position on each axis.
    position, half, velocity: (n, 3); axes: (n, 3, 3), one a row; least_reach: (n,), for spheres.
    """
    for k in range(3):
        reach = max(abs(axes[i, 0, k]) * half[i, 0] + abs(axes[i, 1, k]) * half[i, 1]
                    + abs(axes[i, 2, k]) * half[i, 2], least_reach[i]) + margin
        motion = velocity[i, k] * dt
        low[i, k] = position[i, k] - reach + min(motion, 0.0)
        high[i, k] = position[i, k] + reach + max(motion, 0.0)


@kernel
def set_all_bounds(position, axes, half, least_reach, velocity, dt, margin, low, high):
    """Writes the world AABBs of all n boxes; parameters as in `set_bounds`."""
    for i in range(position.shape[0]):
        set_bounds(i, position, axes, half, least_reach, velocity, dt, margin, low, high)


@kernel
def assign_levels(low, high, bodies, count, levels, stored_level):
    """Writes the grid level that each of the first `count` of `bodies` is stored in to stored_level (n,).

    Returns False if a body is too large for all levels, or has bounds that are not finite.
    """
    for k in range(count):
        i, level = bodies[k], 0
        while not fits(low, high, i, levels[level, 0]):
            level += 1
            if level == levels.shape[0]:
                return False
        stored_level[i] = level
    return True


@kernel
def find_pairs(low, high, bodies, count, planes, tables):
    """Writes the overlapping pairs of the first `count` of `bodies`, with each other, with the static bodies and with
    all of `planes`, to tables.ordered.

    low, high: (n, 3) bounds, m; bodies: moving ones; planes: bodies without bounds, paired with each moving body;
    tables: GridTables. Returns (DONE, number of pairs, tests made), or (code, needed, 0), upon which the caller has to
    call `Grid.prepare_retry` with the code and the needed size, and then this again.
    """
    pair, stored_level, counts, cells_per_meter = tables.pair, tables.marks[0], tables.marks[1], tables.levels[:, 1]
    if not assign_levels(low, high, bodies, count, tables.levels, stored_level):
        return NEW_LEVELS, 0, 0
    found = tests = 0
    if count <= FEW:
        if count * count > pair.shape[1]:
            return MORE_PAIRS, 2 * count * count, 0
        for p in range(count):
            for q in range(p + 1, count):
                if overlap(low, high, bodies[p], bodies[q]):
                    pair[0, found] = bodies[p] << 32 | bodies[q]
                    found += 1
        tests = count * (count - 1) // 2
    else:
        answer, found, tests = _find_pairs_in_table(low, high, bodies, count, tables)
        if answer != DONE:
            return answer, found, 0
    if found >= 0 and tables.static_entry.shape[0]:
        found, more = find_pairs_with(low, high, bodies, count, stored_level, cells_per_meter, tables.static_top[0],
                                      tables.static_start, tables.static_entry, pair[0], found)
        tests += more
    if found < 0 or found + planes.shape[0] * count > pair.shape[1]:
        return MORE_PAIRS, 2 * pair.shape[1] + planes.shape[0] * count, 0
    for plane in planes:
        for k in range(count):
            pair[0, found] = plane << 32 | bodies[k]
            found += 1
    return DONE, sort_pairs(low, high, pair[0], found, counts, pair[1], tables.ordered), tests


@kernel
def _find_pairs_in_table(low, high, bodies, count, tables):
    """Writes the overlapping pairs among the first `count` of `bodies` to tables.pair[0]; returns the same as
    `find_pairs`, with -1 pairs if there is no room for them."""
    stored_level = tables.marks[0]
    top = 0
    for k in range(count):
        top = max(top, stored_level[bodies[k]])
    buckets = 64
    while buckets < 2 * count:
        buckets *= 2
    start = tables.start[: buckets + 1]
    entries = fill_table(low, high, bodies, count, stored_level, tables.levels[:, 1], top, start, tables.bucket,
                         tables.unsorted, tables.entry)
    if entries > tables.bucket.shape[0]:
        return MORE_ENTRIES, entries, 0
    found, tests = find_pairs_within(start, tables.entry, tables.pair[0])
    return DONE, found, tests


@kernel
def bounds_differ(low, high, bodies, boxes):
    """Whether the bounds of any of `bodies` (k,) differ from boxes (2, k, 3)."""
    for k in range(bodies.shape[0]):
        for c in range(3):
            if boxes[0, k, c] != low[bodies[k], c] or boxes[1, k, c] != high[bodies[k], c]:
                return True
    return False


@kernel
def retune_threshold(bodies, pairs):
    """The number of tests above which `Grid.retune` may pay, for this many moving bodies and pairs."""
    return TESTS_PER_PAIR * (TESTS_PER_PAIR + bodies + pairs)


class Grid:
    """The broad phase with its buffers."""

    def __init__(self, half: Floats) -> None:
        """half: (n, 3) half extents of the boxes in m, from which the first cell sizes are chosen."""
        n = max(len(half), 1)
        self._calls_left = self._interval = 1  # calls of `retune` until the next attempt, and from one to the next
        self._marks = np.empty((2, n), np.int32)
        self._pairs, self.ordered = np.empty((2, 2, 8 * n), np.int64)
        self._start, self._bucket, self._unsorted, self._entry = _empty_table(n, 8 * n)
        self._static, self._static_boxes, self._static_top = NONE, np.empty((2, 0, 3)), np.zeros(1, np.int64)
        self._static_start, _, _, self._static_entry = _empty_table(1, 0)
        self._set_levels(_suitable_levels(-half, half))

    def pairs(self, low: Floats, high: Floats, solid: Booleans, movable: Booleans) -> tuple[Integers, Integers]:
        """The pairs a < b of overlapping solid boxes, one of them movable, sorted by a, then b: two arrays (k,).

        low, high: (n, 3) m; solid, movable: (n,). Raises ValueError for bounds that are not finite or not in order.
        """
        self.reserve(len(low))
        moving, static = (np.flatnonzero(solid & which) for which in (movable, ~movable))
        self.store_static(low, high, static)
        while True:
            answer, count, tests = find_pairs(low, high, moving, len(moving), NONE, self.tables())
            if answer == DONE:
                break
            self.prepare_retry(answer, count, low, high, moving)
        if tests > retune_threshold(len(moving), count):
            self.retune(low, high, moving)
        return self.ordered[0, :count].copy(), self.ordered[1, :count].copy()

    def reserve(self, bodies: int) -> None:
        """Makes room for this many bodies."""
        if bodies > self._marks.shape[1]:
            self._marks = np.empty((2, bodies), np.int32)
            self._start, self._bucket, self._unsorted, self._entry = _empty_table(bodies, 8 * bodies)

    def tables(self) -> GridTables:
        """The arrays as `find_pairs` takes them; others after `prepare_retry`, `retune` and `store_static`."""
        return GridTables(self._levels, self._static_top, self._static_start, self._static_entry, self._start,
                          self._bucket, self._unsorted, self._entry, self._marks, self._pairs, self.ordered)

    def prepare_retry(self, code: int, needed: int, low: Floats, high: Floats, moving: Integers) -> None:
        """Makes the room, or chooses the grid levels, that `find_pairs` asked for. Raises ValueError for bounds that
        are not finite or not in order."""
        if code == NEW_LEVELS:
            both = np.concatenate([moving, self._static])
            self._set_levels(_suitable_levels(*_checked(low[both], high[both])))
            self._fill_static(low, high, self._static)
        elif code == MORE_ENTRIES:
            self._start, self._bucket, self._unsorted, self._entry = _empty_table(self._marks.shape[1], 2 * needed)
        elif code == MORE_PAIRS:
            self._pairs, self.ordered = np.empty((2, 2, needed), np.int64)

    def occupied_cells(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """The cells that boxes (n, 3) overlap, each once: lowest corners (k, 3) and edges (k,) in m."""
        reach = (high / 2 - low / 2).max(axis=1)
        level = np.minimum(np.searchsorted(self._levels[:, 0], reach), len(self._levels) - 1)
        cells_per_meter = self._levels[level, 1:2]
        first = np.floor(low * cells_per_meter)
        span = (np.floor(high * cells_per_meter) - first).astype(np.int64) + 1
        count = span.prod(axis=1)
        box = np.repeat(np.arange(len(level)), count)
        nth = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        step = np.stack([nth // (span[box, 1] * span[box, 2]), nth // span[box, 2] % span[box, 1],
                         nth % span[box, 2]], axis=1)
        cells = np.column_stack([level[box], first[box] + step])
        cells = cells[np.lexsort(cells.T[::-1])]
        cells = cells[(np.diff(cells, axis=0, prepend=np.nan) != 0).any(axis=1)]
        edges = 1.0 / self._levels[cells[:, 0].astype(np.int64), 1]
        return cells[:, 1:] * edges[:, None], edges

    def store_static(self, low: Floats, high: Floats, static: Integers) -> None:
        """Stores these bodies in the static table, unless they are there already with the same bounds. Raises
        ValueError for bounds that are not finite or not in order."""
        if not np.array_equal(static, self._static) or bounds_differ(low, high, self._static, self._static_boxes):
            self._fill_static(low, high, static)

    def _fill_static(self, low: Floats, high: Floats, static: Integers) -> None:
        """Fills the static table, with new grid levels if the bodies do not fit into the present ones."""
        self._static, self._static_boxes = static, np.array([low[static], high[static]])
        stored_level = self._marks[0]
        if not assign_levels(low, high, static, len(static), self._levels, stored_level):
            self._set_levels(_suitable_levels(*_checked(low[static], high[static])))
            assign_levels(low, high, static, len(static), self._levels, stored_level)
        self._static_top[0] = stored_level[static].max(initial=0)
        entries = 8 * len(static)
        while True:
            self._static_start, bucket, unsorted, self._static_entry = _empty_table(len(static), entries)
            entries = fill_table(low, high, static, len(static), stored_level, self._levels[:, 1],
                                 len(self._levels) - 1, self._static_start, bucket, unsorted, self._static_entry)
            if entries <= len(bucket):
                break

    def retune(self, low: Floats, high: Floats, moving: Integers) -> None:
        """Chooses the cell sizes again if that pays; otherwise doubles the interval to the next attempt."""
        self._calls_left -= 1
        if self._calls_left == 0:
            both = np.concatenate([moving, self._static])
            levels = _suitable_levels(low[both], high[both])
            if levels.shape == self._levels.shape and np.allclose(levels, self._levels, rtol=0.5):
                self._interval *= 2
            else:
                self._interval = 1
                self._set_levels(levels)
                self._fill_static(low, high, self._static)
            self._calls_left = self._interval

    def _set_levels(self, levels: Floats) -> None:
        """Sets the grid levels, without moving bodies that are stored already."""
        self._levels = np.ascontiguousarray(levels)


def _checked(low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """The bounds (n, 3), if they are finite and low <= high."""
    bad = np.flatnonzero(~(np.isfinite(low) & np.isfinite(high) & (low <= high)).all(axis=1))
    if len(bad):
        raise ValueError(f"bounds: expected finite numbers, low <= high, got {low[bad[0]]} to {high[bad[0]]}")
    return low, high


def _empty_table(bodies: int, entries: int) -> tuple[Narrow, Narrow, Integers, Integers]:
    """The arrays start, bucket, unsorted and entry of a table."""
    buckets = 1 << max(6, int(np.ceil(np.log2(2 * max(bodies, 1)))))
    return (np.zeros(buckets + 1, np.int32), np.empty(entries, np.int32), np.empty((entries, 3), np.int64),
            np.empty((entries, 3), np.int64))


def _suitable_levels(low: Floats, high: Floats) -> Floats:
    """Largest half side in m and cells per meter (k, 2) of grid levels that suit boxes (n, 3), finest first.

    The cells of a level are twice the mean longest side of its boxes. A level has boxes of sizes up to a ratio of
    SPREAD, so that its largest do not overlap too many cells; the finest takes all that remain.
    """
    rows: list[tuple[float, float]] = []
    reach, far = (high / 2 - low / 2).max(axis=1, initial=0.0), np.maximum(-low, high).max(axis=1, initial=0.0)
    limit = np.inf
    while len(reach) and len(rows) < LEVELS:
        top = float(reach.max())
        inside = (reach >= top / SPREAD) | (len(rows) == LEVELS - 1)
        if top:
            edge = 4.0 * top * max(float(np.mean(reach[inside] / top)), 1.0 / SPREAD)
        else:  # points: cells so small that only equal points share one
            edge = 2.0**-40 * float(far.max()) or 1.0
        rows.append((min(GROWTH * top, limit), 1.0 / max(edge, 1e-300)))
        limit = top / SPREAD
        reach, far = reach[~inside], far[~inside]
    return np.array(rows[::-1] or [(1.0, 1.0)])
