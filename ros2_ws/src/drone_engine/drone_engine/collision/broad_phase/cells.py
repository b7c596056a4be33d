"""Kernels of the grid: entries of bodies in cells, a hash table of the cells, and the pairs that share a cell.

A grid level is a uniform grid over all space; levels go from fine to coarse. Each body is stored in the finest level
whose cells are large enough for it, with an entry in every cell that its bounds overlap, and has copies of its entries
in the coarser levels. A pair is found in the coarser of its two levels, where at least one body is stored, and there in
the cell that holds the lowest corner of the overlap of their bounds, so each pair is found once (Dittrich and Seeger
2000, Data redundancy and duplicate detection in spatial join processing). Rounding is monotone: a <= b implies the same
of the cells of a and b, and of their positions within a cell in units of 1 / PARTS, so no pair is lost; pairs that
overlap only because of rounding are dropped when the pairs are sorted.

An entry is three int64: the lowest corner of the body within the cell, the highest one, and body << 32 | tag. A corner
has AXIS_BITS bits for each axis, one of which is a guard bit. A tag has, from bit 0: the low 8 bits of the cell's x, y
and z, three bits of grid level, for each axis whether the body begins in this cell, and COPY.
"""

import numpy as np

from drone_engine.kernel import kernel

FARTHEST = 2.0**51  # cells from the origin; the last cell holds all beyond, where float64 cannot resolve cells
PARTS, AXIS_BITS = (1 << 20) - 1, 21  # parts of a cell's edge; bits for each axis of a corner
GUARD_BITS = 1 << 20 | 1 << 41 | 1 << 62  # of a corner, one above each axis
COORDINATE = 255  # mask of a cell coordinate's low bits: overlapping bodies never have cells of one level farther apart
BEGINS_BIT, COPY = 27, 1 << 30  # of a tag: the first of the three bits "begins here"; the bit of a copy
SAME_CELL, BEGINS = (1 << BEGINS_BIT) - 1, 7 << BEGINS_BIT  # masks of a tag
ONE, SHIFT = np.uint64(1), np.uint64(32)  # unsigned like the indices, which saves the test for negative indices
FEW = 24  # at most this many pairs are sorted by insertion, and this many bodies are tested pair by pair


@kernel
def overlap(low, high, i, j):
    """Whether the AABBs of bodies i and j share a point; low, high: (n, 3) m."""
    return (low[i, 0] <= high[j, 0] and low[j, 0] <= high[i, 0]
            and low[i, 1] <= high[j, 1] and low[j, 1] <= high[i, 1]
            and low[i, 2] <= high[j, 2] and low[j, 2] <= high[i, 2])


@kernel
def fits(low, high, i, reach):
    """Whether half of each side of body i's AABB is from 0 to `reach`, m; False for NaN.

    It compares halves, so that no finite bounds overflow.
    """
    return (0.0 <= 0.5 * high[i, 0] - 0.5 * low[i, 0] <= reach and 0.0 <= 0.5 * high[i, 1] - 0.5 * low[i, 1] <= reach
            and 0.0 <= 0.5 * high[i, 2] - 0.5 * low[i, 2] <= reach)


@kernel
def _cell_range(low, high, cells_per_meter):
    """The cells that an interval of one axis overlaps: the first, the last, and where the interval begins in the first
    and ends in the last, in units of 1 / PARTS; four int64."""
    begin, end = low * cells_per_meter, high * cells_per_meter
    first = min(max(np.floor(begin), -FARTHEST), FARTHEST)
    last = min(max(np.floor(end), -FARTHEST), FARTHEST)
    return (np.int64(first), np.int64(last), np.int64(min(max(begin - first, 0.0), 1.0) * PARTS),
            np.int64(min(max(end - last, 0.0), 1.0) * PARTS))


@kernel
def _bucket(x, y, z, level, mask):
    """The bucket of a cell in a table of mask + 1 buckets: blocks of 2 x 2 x 2 cells are adjacent, and blocks are
    spread by multiplicative hashing."""
    h = ((x >> 1) * 0x1E3779B97F4A7C15 + (y >> 1) * 0x42B2AE3D27D4EB4F + (z >> 1) * 0x165667B19E3779F9
         + level * 0x27D4EB2F165667C5)
    return (((h >> 29) ^ (h >> 41)) * 8 + (x & 1) * 4 + (y & 1) * 2 + (z & 1)) & mask


@kernel
def _entry(x, y, z, level, along_x, along_y, along_z):
    """Lowest corner, highest corner and tag (see above) of a body's entry in cell (x, y, z) of a level.

    along_x, along_y, along_z: the body's `_cell_range` on each axis.
    """
    low = ((along_x[2] if x == along_x[0] else 0) | (along_y[2] if y == along_y[0] else 0) << AXIS_BITS
           | (along_z[2] if z == along_z[0] else 0) << 2 * AXIS_BITS)
    high = ((along_x[3] if x == along_x[1] else PARTS) | (along_y[3] if y == along_y[1] else PARTS) << AXIS_BITS
            | (along_z[3] if z == along_z[1] else PARTS) << 2 * AXIS_BITS)
    tag = ((x & COORDINATE) | (y & COORDINATE) << 8 | (z & COORDINATE) << 16 | level << 24
           | (x == along_x[0]) << BEGINS_BIT | (y == along_y[0]) << (BEGINS_BIT + 1)
           | (z == along_z[0]) << (BEGINS_BIT + 2))
    return low, high, tag


@kernel
def _append_entries(low, high, i, level, cells_per_meter, copy, start, bucket, unsorted, count):
    """Appends an entry for each cell of a level that body i overlaps; returns the new count of entries.

    Counts the entries of each bucket in start[1:]. copy: COPY or 0. Entries beyond the buffers are only counted.
    """
    mask = start.shape[0] - 2
    along_x = _cell_range(low[i, 0], high[i, 0], cells_per_meter)
    along_y = _cell_range(low[i, 1], high[i, 1], cells_per_meter)
    along_z = _cell_range(low[i, 2], high[i, 2], cells_per_meter)
    for x in range(along_x[0], along_x[1] + 1):
        for y in range(along_y[0], along_y[1] + 1):
            for z in range(along_z[0], along_z[1] + 1):
                if count < bucket.shape[0]:
                    h, at = np.uint64(_bucket(x, y, z, level, mask) + 1), np.uint64(count)
                    start[h] += 1
                    bucket[at] = h
                    a, b, tag = _entry(x, y, z, level, along_x, along_y, along_z)
                    unsorted[at, 0], unsorted[at, 1], unsorted[at, 2] = a, b, i << 32 | tag | copy
                count += 1
    return count


@kernel
def _exclusive_sum(count, n):
    """Replaces each of the first n counts by the sum of those before it."""
    before = 0
    for i in range(n):
        here = count[i]
        count[i] = before
        before += here


@kernel
def fill_table(low, high, bodies, count, stored_level, cells_per_meter, top, start, bucket, unsorted, entry):
    """Sorts the entries of the first `count` of `bodies` by bucket, copies last in each; returns how many there are.

    If that is more than the buffers hold, the table is invalid. low, high: (n, 3) bounds in m. stored_level: (n,) grid
    level of each body. cells_per_meter: (levels,). top: the highest level that gets copies. Out: start (buckets + 1,),
    where the entries of each bucket begin, and entry (m, 3). Scratch: bucket (m,), counted from 1, and unsorted (m, 3).
    """
    start[:] = 0
    total = 0
    for k in range(count):
        i = bodies[k]
        total = _append_entries(low, high, i, stored_level[i], cells_per_meter[stored_level[i]], 0, start, bucket,
                                unsorted, total)
    for k in range(count):
        i = bodies[k]
        for level in range(stored_level[i] + 1, top + 1):
            total = _append_entries(low, high, i, level, cells_per_meter[level], COPY, start, bucket, unsorted, total)
    if total > bucket.shape[0]:
        return total
    _exclusive_sum(start[1:], start.shape[0] - 1)
    for e in range(np.uint64(total)):  # moves start[h] from the begin of the bucket to its end
        h = np.uint64(bucket[e])
        p = np.uint64(start[h])
        start[h] += 1
        entry[p, 0], entry[p, 1], entry[p, 2] = unsorted[e, 0], unsorted[e, 1], unsorted[e, 2]
    return total


@kernel
def _append_pairs(body_and_tag, low, high, first, end, entry, pair, found):
    """Appends body << 32 | other body for each of entries first to end that overlaps the given entry; returns the new
    count of pairs. `pair` needs room for all entries.

    The three axes are compared at once: a guard bit stays set where a difference is not negative. No branch depends on
    the result, as half of the branches would be predicted wrongly.
    """
    body = body_and_tag >> 32 << 32
    high |= GUARD_BITS
    at = np.uint64(found)
    for q in range(np.uint64(first), np.uint64(end)):
        other = entry[q, 2]
        pair[at] = body | other >> 32
        apart = (((high - entry[q, 0]) & ((entry[q, 1] | GUARD_BITS) - low) & GUARD_BITS) ^ GUARD_BITS
                 | (body_and_tag ^ other) & SAME_CELL | ((body_and_tag | other) & BEGINS) ^ BEGINS)
        at += np.uint64(apart == 0)
    return np.int64(at)


@kernel
def find_pairs_within(start, entry, pair):
    """Writes the overlapping pairs among a table's bodies as a << 32 | b to pair (p,), in no particular order.

    Returns how many pairs there are, -1 if `pair` is too small, and how many were tested.
    """
    found = tested = np.int64(0)
    for h in range(np.uint64(start.shape[0] - 1)):
        first, end = np.uint64(start[h]), np.uint64(start[h + ONE])
        for p in range(first, end):
            body_and_tag, others = entry[p, 2], np.int64(end - p - ONE)
            if body_and_tag & COPY:
                break
            if found + others > pair.shape[0]:
                return -1, tested
            found = _append_pairs(body_and_tag, entry[p, 0], entry[p, 1], p + ONE, end, entry, pair, found)
            tested += others
    return found, tested


@kernel
def find_pairs_with(low, high, bodies, count, stored_level, cells_per_meter, top, start, entry, pair, found):
    """Appends the overlapping pairs of the first `count` of `bodies` with the bodies of a table; returns the same as
    `find_pairs_within`. top: the highest level with a body stored in it; other parameters as in `fill_table`."""
    mask = start.shape[0] - 2
    tested = 0
    for k in range(count):
        i = bodies[k]
        for level in range(stored_level[i], max(stored_level[i], top) + 1):
            along_x = _cell_range(low[i, 0], high[i, 0], cells_per_meter[level])
            along_y = _cell_range(low[i, 1], high[i, 1], cells_per_meter[level])
            along_z = _cell_range(low[i, 2], high[i, 2], cells_per_meter[level])
            for x in range(along_x[0], along_x[1] + 1):
                for y in range(along_y[0], along_y[1] + 1):
                    for z in range(along_z[0], along_z[1] + 1):
                        h = _bucket(x, y, z, level, mask)
                        first, end = start[h], start[h + 1]
                        if level > stored_level[i]:  # body i is a copy here, and copies do not pair with copies
                            while end > first and entry[end - 1, 2] & COPY:
                                end -= 1
                        if first == end:
                            continue
                        if found + end - first > pair.shape[0]:
                            return -1, tested
                        a, b, tag = _entry(x, y, z, level, along_x, along_y, along_z)
                        found = _append_pairs(i << 32 | tag, a, b, first, end, entry, pair, found)
                        tested += end - first
    return found, tested


@kernel
def sort_pairs(low, high, pair, found, count, spare, ordered):
    """Writes the first `found` of the pairs that overlap exactly to ordered (2, m), as a < b, sorted by a, then b;
    returns how many there are.

    Counting sort by b, then by a: linear in bodies and pairs, however many pairs one body has. pair: a << 32 | b in any
    order, overwritten; count: (n,) and spare: (m,) scratch.
    """
    n, kept = low.shape[0], 0
    for k in range(found):
        i, j = np.uint64(pair[k] >> 32), np.uint64(pair[k] & 0xFFFFFFFF)
        if overlap(low, high, i, j):
            pair[kept] = np.int64(min(i, j) << SHIFT | max(i, j))
            kept += 1
    if kept <= FEW:
        for k in range(kept):
            one, to = pair[k], k
            while to > 0 and spare[to - 1] > one:
                spare[to] = spare[to - 1]
                to -= 1
            spare[to] = one
        for k in range(kept):
            ordered[0, k], ordered[1, k] = spare[k] >> 32, spare[k] & 0xFFFFFFFF
        return kept
    count[:n] = 0
    for k in range(np.uint64(kept)):
        count[np.uint64(pair[k] & 0xFFFFFFFF)] += 1
    _exclusive_sum(count, n)
    for k in range(np.uint64(kept)):
        b = np.uint64(pair[k] & 0xFFFFFFFF)
        spare[np.uint64(count[b])] = pair[k]
        count[b] += 1
    count[:n] = 0
    for k in range(np.uint64(kept)):
        count[np.uint64(spare[k] >> 32)] += 1
    _exclusive_sum(count, n)
    for k in range(np.uint64(kept)):
        a = np.uint64(spare[k] >> 32)
        at = np.uint64(count[a])
        ordered[0, at], ordered[1, at] = a, spare[k] & 0xFFFFFFFF
        count[a] += 1
    return kept
