"""Kernels of the broad phase: bodies into cells, cells into a table, and the pairs that share a cell.

A level is a uniform grid over all space; levels go from fine to coarse. A body is at home in the first level that is
coarse enough for it and a guest in those above; it stands in every cell that it overlaps. Two bodies meet in the
coarser one of their two levels, where at least one is at home, in the cell that holds the lowest corner of what they
share, so that a pair comes out once (Dittrich and Seeger 2000, Data redundancy and duplicate detection in spatial
join processing). Rounding is monotone: a <= b stays true of the cells that a and b lie in, and of their places within a
cell rounded to PARTS, so neither loses a pair; what only rounding lets touch is dropped at the end.
"""

import numpy as np

from drone_engine.kernel import kernel

FARTHEST = 2.0**51  # cells from the origin; beyond stands the last cell, and float64 could not tell cells apart
PARTS, WIDTH = (1 << 20) - 1, 21  # of a cell's edge; bits for one axis
BETWEEN = 1 << 20 | 1 << 41 | 1 << 62
PLACE = 255  # the low bits of a cell's place: bodies that overlap never stand in cells of one level as far apart
LOWEST, GUEST = 27, 1 << 30  # bits of a tag
SAME, BEGINS = (1 << LOWEST) - 1, 7 << LOWEST
ONE, SHIFT = np.uint64(1), np.uint64(32)  # unsigned as indices are, which spares a test for negative ones


@kernel
def overlap(low, high, i, j):
    """Whether two AABBs share a point."""
    return (low[i, 0] <= high[j, 0] and low[j, 0] <= high[i, 0]
            and low[i, 1] <= high[j, 1] and low[j, 1] <= high[i, 1]
            and low[i, 2] <= high[j, 2] and low[j, 2] <= high[i, 2])


@kernel
def fits(low, high, i, reach):
    """Whether half of each side is from 0 to `reach`; halves, so that no finite bounds overflow. Not for NaN."""
    return (0.0 <= 0.5 * high[i, 0] - 0.5 * low[i, 0] <= reach and 0.0 <= 0.5 * high[i, 1] - 0.5 * low[i, 1] <= reach
            and 0.0 <= 0.5 * high[i, 2] - 0.5 * low[i, 2] <= reach)


@kernel
def _side(low, high, per_metre):
    """First and last cell on one axis, how far into the first a body begins and how far into the last it ends."""
    begin, end = low * per_metre, high * per_metre
    first = min(max(np.floor(begin), -FARTHEST), FARTHEST)
    last = min(max(np.floor(end), -FARTHEST), FARTHEST)
    return (np.int64(first), np.int64(last), np.int64(min(max(begin - first, 0.0), 1.0) * PARTS),
            np.int64(min(max(end - last, 0.0), 1.0) * PARTS))


@kernel
def _bucket(x, y, z, level, mask):
    """Where a cell stands in a table: 2 x 2 x 2 neighbours side by side, such blocks by multiplicative hashing."""
    h = ((x >> 1) * 0x1E3779B97F4A7C15 + (y >> 1) * 0x42B2AE3D27D4EB4F + (z >> 1) * 0x165667B19E3779F9
         + level * 0x27D4EB2F165667C5)
    return (((h >> 29) ^ (h >> 41)) * 8 + (x & 1) * 4 + (y & 1) * 2 + (z & 1)) & mask


@kernel
def _entry(x, y, z, level, along_x, along_y, along_z):
    """Lowest and highest corner of a body within a cell, and what must be known of the cell: the low bits of its place,
    its level, and on which axes the body begins in it."""
    low = ((along_x[2] if x == along_x[0] else 0) | (along_y[2] if y == along_y[0] else 0) << WIDTH
           | (along_z[2] if z == along_z[0] else 0) << 2 * WIDTH)
    high = ((along_x[3] if x == along_x[1] else PARTS) | (along_y[3] if y == along_y[1] else PARTS) << WIDTH
            | (along_z[3] if z == along_z[1] else PARTS) << 2 * WIDTH)
    tag = ((x & PLACE) | (y & PLACE) << 8 | (z & PLACE) << 16 | level << 24 | (x == along_x[0]) << LOWEST
           | (y == along_y[0]) << (LOWEST + 1) | (z == along_z[0]) << (LOWEST + 2))
    return low, high, tag


@kernel
def _list(low, high, i, level, per_metre, guest, start, bucket, listed, count):
    """Appends an entry for each cell of a level that a body stands in; returns the new count."""
    mask = start.shape[0] - 2
    along_x = _side(low[i, 0], high[i, 0], per_metre)
    along_y = _side(low[i, 1], high[i, 1], per_metre)
    along_z = _side(low[i, 2], high[i, 2], per_metre)
    for x in range(along_x[0], along_x[1] + 1):
        for y in range(along_y[0], along_y[1] + 1):
            for z in range(along_z[0], along_z[1] + 1):
                if count < bucket.shape[0]:
                    h, at = np.uint64(_bucket(x, y, z, level, mask) + 1), np.uint64(count)
                    start[h] += 1
                    bucket[at] = h
                    a, b, tag = _entry(x, y, z, level, along_x, along_y, along_z)
                    listed[at, 0], listed[at, 1], listed[at, 2] = a, b, i << 32 | tag | guest
                count += 1
    return count


@kernel
def _begins(count, n):
    """Turns how many there are of each of n kinds into where the first of each stands."""
    before = 0
    for i in range(n):
        here = count[i]
        count[i] = before
        before += here


@kernel
def fill(low, high, bodies, count, home, per_metre, top, start, bucket, listed, entry):
    """Sorts the entries of `count` bodies by bucket, in each those at home first; returns how many there are.

    More than the buffers hold are counted, and the table is then void. top: the highest level with guests.
    start: (buckets + 1,) where a bucket begins. bucket: (m,) that of each listed entry, counted from 1.
    listed, entry: (m, 3) low and high corner, body and tag.
    """
    start[:] = 0
    total = 0
    for k in range(count):
        i = bodies[k]
        total = _list(low, high, i, home[i], per_metre[home[i]], 0, start, bucket, listed, total)
    for k in range(count):
        i = bodies[k]
        for level in range(home[i] + 1, top + 1):
            total = _list(low, high, i, level, per_metre[level], GUEST, start, bucket, listed, total)
    if total > bucket.shape[0]:
        return total
    _begins(start[1:], start.shape[0] - 1)
    for e in range(np.uint64(total)):  # moves start[h] from where the bucket begins to where it ends
        h = np.uint64(bucket[e])
        p = np.uint64(start[h])
        start[h] += 1
        entry[p, 0], entry[p, 1], entry[p, 2] = listed[e, 0], listed[e, 1], listed[e, 2]
    return total


@kernel
def _gather(own, low, high, first, end, entry, pair, found):
    """Appends body << 32 | other body for the entries first to end that may overlap a body, whose own entry is given.

    The three axes are compared at once: a bit between them stays set where a difference is not negative. No branch
    depends on the answer: processors guess them, and half of the guesses would be wrong. `pair` needs room for all
    entries.
    """
    body = own >> 32 << 32
    high |= BETWEEN
    at = np.uint64(found)
    for q in range(np.uint64(first), np.uint64(end)):
        other = entry[q, 2]
        pair[at] = body | other >> 32
        apart = (((high - entry[q, 0]) & ((entry[q, 1] | BETWEEN) - low) & BETWEEN) ^ BETWEEN
                 | (own ^ other) & SAME | ((own | other) & BEGINS) ^ BEGINS)
        at += np.uint64(apart == 0)
    return np.int64(at)


@kernel
def meet(start, entry, pair):
    """Pairs of a table's bodies; returns how many, and how many were tried. More than `pair` has room for: -1."""
    found = tried = np.int64(0)
    for h in range(np.uint64(start.shape[0] - 1)):
        first, end = np.uint64(start[h]), np.uint64(start[h + ONE])
        for p in range(first, end):
            own, others = entry[p, 2], np.int64(end - p - ONE)
            if own & GUEST:
                break
            if found + others > pair.shape[0]:
                return -1, tried
            found = _gather(own, entry[p, 0], entry[p, 1], p + ONE, end, entry, pair, found)
            tried += others
    return found, tried


@kernel
def meet_others(low, high, bodies, count, home, per_metre, top, start, entry, pair, found):
    """Appends pairs of bodies with those of a table; returns as `meet`. top: the highest level with one at home."""
    mask = start.shape[0] - 2
    tried = 0
    for k in range(count):
        i = bodies[k]
        for level in range(home[i], max(home[i], top) + 1):
            along_x = _side(low[i, 0], high[i, 0], per_metre[level])
            along_y = _side(low[i, 1], high[i, 1], per_metre[level])
            along_z = _side(low[i, 2], high[i, 2], per_metre[level])
            for x in range(along_x[0], along_x[1] + 1):
                for y in range(along_y[0], along_y[1] + 1):
                    for z in range(along_z[0], along_z[1] + 1):
                        h = _bucket(x, y, z, level, mask)
                        first, end = start[h], start[h + 1]
                        if level > home[i]:  # guests do not meet guests
                            while end > first and entry[end - 1, 2] & GUEST:
                                end -= 1
                        if first == end:
                            continue
                        if found + end - first > pair.shape[0]:
                            return -1, tried
                        a, b, tag = _entry(x, y, z, level, along_x, along_y, along_z)
                        found = _gather(i << 32 | tag, a, b, first, end, entry, pair, found)
                        tried += end - first
    return found, tried


FEW = 24  # pairs up to which they are sorted one by one, bodies up to which each is asked about each other


@kernel
def put_in_order(low, high, pair, found, count, spare, ordered):
    """Writes the pairs that truly overlap to `ordered`, (2, m), as a < b, sorted by a, then b; returns how many.

    Sorts by counting, first b, then a: linear in bodies and pairs, however many pairs one body has.
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
    _begins(count, n)
    for k in range(np.uint64(kept)):
        b = np.uint64(pair[k] & 0xFFFFFFFF)
        spare[np.uint64(count[b])] = pair[k]
        count[b] += 1
    count[:n] = 0
    for k in range(np.uint64(kept)):
        count[np.uint64(spare[k] >> 32)] += 1
    _begins(count, n)
    for k in range(np.uint64(kept)):
        a = np.uint64(spare[k] >> 32)
        at = np.uint64(count[a])
        ordered[0, at], ordered[1, at] = a, spare[k] & 0xFFFFFFFF
        count[a] += 1
    return kept
