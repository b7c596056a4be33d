"""Tight boxes of an octree's nodes, and the test of eight of them at once against another one.

A patch of a surface is flat: a box along its normal is far thinner than one along the model's axes, and two surfaces
that pass each other closely are told apart many levels earlier. The boxes only prune. They are float32, so that the
children of a node fill the lanes of one vector; `SLACK` covers what that rounds.
"""

import math

import numpy as np

from drone_engine.kernel import kernel

LANES = 8
ROWS = 21  # three axes, centre, half extents of the tight box; centre and half extents of the aligned one
SLACK = 2.0**-18  # of the size of a query: 64 roundings of float32; fewer than 40 can add up
TINY = 1e-37  # m; keeps the slack above zero in float32
NOTHING = -1e35  # m; half extents of a lane without a child, which nothing meets
ROUGH = 1e-6  # of unit vectors' products: axes further from orthonormal are not used
SAMPLES = 24  # triangles of a node that its axes are chosen by


@kernel
def fit(box, link, corners, tight):
    """Writes each node's row (k, 21) float32: unit axes, one after the other, centre, half, and `box` again."""
    axes = np.empty((3, 3))
    for node in range(box.shape[0]):
        first, count = link[node, 2], link[node, 3]
        _choose_axes(corners, first, count, axes)
        if not _write(corners, first, count, axes, box[node], tight[node]):
            for k in range(9):
                tight[node, k] = 1.0 if k % 4 == 0 else 0.0
            for k in range(6):
                tight[node, 9 + k] = box[node, k]
        for k in range(6):
            tight[node, 15 + k] = box[node, k]


@kernel
def spread(link, tight, inner, wide):
    """Writes the boxes of a node's children side by side, wide (g, 21, 8), and where: inner (k,), -1 for a leaf."""
    wide[:] = 0.0
    wide[:, 12:15] = NOTHING
    wide[:, 18:21] = NOTHING
    count = 0
    for node in range(link.shape[0]):
        inner[node] = -1
        if link[node, 1] > 0:
            inner[node] = count
            for child in range(link[node, 1]):
                for row in range(ROWS):
                    wide[count, row, child] = tight[link[node, 0] + child, row]
            count += 1


@kernel
def meets(wide, g, q, size):
    """Which tight boxes of wide[g] may touch box q (15,), float32, as bits, and which of these is in deepest.

    All fifteen axes decide (Gottschalk, Lin and Manocha 1996). size: no gap nor overlap can be larger, m.
    """
    u0, u1, u2, v0, v1, v2, n0, n1, n2 = q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7], q[8]
    c0, c1, c2, g0, g1, g2 = q[9], q[10], q[11], q[12], q[13], q[14]
    nothing, scale = np.float32(0.0), np.float32(2.0**26) / size
    slack = np.float32(SLACK) * size
    mask, deepest = np.int32(0), np.int32(-1)
    for k in range(LANES):  # one vector; sums into integers alone, or the compiler leaves it a loop
        a0, a1, a2 = wide[g, 0, k], wide[g, 1, k], wide[g, 2, k]
        b0, b1, b2 = wide[g, 3, k], wide[g, 4, k], wide[g, 5, k]
        m0, m1, m2 = wide[g, 6, k], wide[g, 7, k], wide[g, 8, k]
        d0, d1, d2 = c0 - wide[g, 9, k], c1 - wide[g, 10, k], c2 - wide[g, 11, k]
        h0, h1, h2 = wide[g, 12, k], wide[g, 13, k], wide[g, 14, k]
        r00, r01, r02 = a0 * u0 + a1 * u1 + a2 * u2, a0 * v0 + a1 * v1 + a2 * v2, a0 * n0 + a1 * n1 + a2 * n2
        r10, r11, r12 = b0 * u0 + b1 * u1 + b2 * u2, b0 * v0 + b1 * v1 + b2 * v2, b0 * n0 + b1 * n1 + b2 * n2
        r20, r21, r22 = m0 * u0 + m1 * u1 + m2 * u2, m0 * v0 + m1 * v1 + m2 * v2, m0 * n0 + m1 * n1 + m2 * n2
        p00, p01, p02 = abs(r00), abs(r01), abs(r02)
        p10, p11, p12 = abs(r10), abs(r11), abs(r12)
        p20, p21, p22 = abs(r20), abs(r21), abs(r22)
        t0, t1, t2 = a0 * d0 + a1 * d1 + a2 * d2, b0 * d0 + b1 * d1 + b2 * d2, m0 * d0 + m1 * d1 + m2 * d2
        gap = _larger(abs(t0) - (h0 + p00 * g0 + p01 * g1 + p02 * g2),
                      _larger(abs(t1) - (h1 + p10 * g0 + p11 * g1 + p12 * g2),
                              abs(t2) - (h2 + p20 * g0 + p21 * g1 + p22 * g2)))
        gap = _larger(gap, abs(u0 * d0 + u1 * d1 + u2 * d2) - (g0 + p00 * h0 + p10 * h1 + p20 * h2))
        gap = _larger(gap, abs(v0 * d0 + v1 * d1 + v2 * d2) - (g1 + p01 * h0 + p11 * h1 + p21 * h2))
        gap = _larger(gap, abs(n0 * d0 + n1 * d1 + n2 * d2) - (g2 + p02 * h0 + p12 * h1 + p22 * h2))
        edge = _larger(_larger(abs(t2 * r10 - t1 * r20) - (h1 * p20 + h2 * p10 + g1 * p02 + g2 * p01),
                               abs(t2 * r11 - t1 * r21) - (h1 * p21 + h2 * p11 + g0 * p02 + g2 * p00)),
                       abs(t2 * r12 - t1 * r22) - (h1 * p22 + h2 * p12 + g0 * p01 + g1 * p00))
        edge = _larger(edge, _larger(abs(t0 * r20 - t2 * r00) - (h0 * p20 + h2 * p00 + g1 * p12 + g2 * p11),
                                     abs(t0 * r21 - t2 * r01) - (h0 * p21 + h2 * p01 + g0 * p12 + g2 * p10)))
        edge = _larger(edge, _larger(abs(t0 * r22 - t2 * r02) - (h0 * p22 + h2 * p02 + g0 * p11 + g1 * p10),
                                     abs(t1 * r00 - t0 * r10) - (h0 * p10 + h1 * p00 + g1 * p22 + g2 * p21)))
        edge = _larger(edge, _larger(abs(t1 * r01 - t0 * r11) - (h0 * p11 + h1 * p01 + g0 * p22 + g2 * p20),
                                     abs(t1 * r02 - t0 * r12) - (h0 * p12 + h1 * p02 + g0 * p21 + g1 * p20)))
        gap = _larger(gap, edge - slack)
        far = gap > nothing
        mask |= np.int32(0) if far else np.int32(1) << np.int32(k)
        depth = np.int32(-gap * scale) if gap > -size else np.int32(0)
        deepest = max(deepest, np.int32(-1) if far else depth * np.int32(8) + np.int32(k))
    return mask, deepest & 7


@kernel
def aligned_meets(wide, g, q, size):
    """As `meets`, for the aligned boxes and a box q (15,) aligned to another frame: nine numbers, row by row, that turn
    its frame into theirs, then its centre and half extents."""
    m0, m1, m2, m3, m4, m5, m6, m7, m8 = q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7], q[8]
    p0, p1, p2, p3, p4, p5, p6, p7, p8 = abs(m0), abs(m1), abs(m2), abs(m3), abs(m4), abs(m5), abs(m6), abs(m7), abs(m8)
    c0, c1, c2, g0, g1, g2 = q[9], q[10], q[11], q[12], q[13], q[14]
    r0, r1, r2 = p0 * g0 + p1 * g1 + p2 * g2, p3 * g0 + p4 * g1 + p5 * g2, p6 * g0 + p7 * g1 + p8 * g2
    nothing, scale = np.float32(0.0), np.float32(2.0**26) / size
    mask, deepest = np.int32(0), np.int32(-1)
    for k in range(LANES):
        d0, d1, d2 = c0 - wide[g, 15, k], c1 - wide[g, 16, k], c2 - wide[g, 17, k]
        h0, h1, h2 = wide[g, 18, k], wide[g, 19, k], wide[g, 20, k]
        gap = _larger(abs(d0) - (h0 + r0), _larger(abs(d1) - (h1 + r1), abs(d2) - (h2 + r2)))
        gap = _larger(gap, abs(m0 * d0 + m3 * d1 + m6 * d2) - (g0 + p0 * h0 + p3 * h1 + p6 * h2))
        gap = _larger(gap, abs(m1 * d0 + m4 * d1 + m7 * d2) - (g1 + p1 * h0 + p4 * h1 + p7 * h2))
        gap = _larger(gap, abs(m2 * d0 + m5 * d1 + m8 * d2) - (g2 + p2 * h0 + p5 * h1 + p8 * h2))
        far = gap > nothing
        mask |= np.int32(0) if far else np.int32(1) << np.int32(k)
        depth = np.int32(-gap * scale) if gap > -size else np.int32(0)
        deepest = max(deepest, np.int32(-1) if far else depth * np.int32(8) + np.int32(k))
    return mask, deepest & 7


@kernel
def _larger(x, y):
    return x if x > y else y


@kernel
def _choose_axes(corners, first, count, axes):
    """Writes unit axes (rows) for a patch: the mean of its triangles' normals last, and before it, of the directions of
    some edges, the one along which the patch takes the least area."""
    step = (count + SAMPLES - 1) // SAMPLES
    rx, ry, rz = 0.0, 0.0, 0.0
    largest = 0.0
    for i in range(first, first + count, step):
        nx, ny, nz = _normal(corners, i)
        square = nx * nx + ny * ny + nz * nz
        if square > largest:
            largest, rx, ry, rz = square, nx, ny, nz
    sx, sy, sz = 0.0, 0.0, 0.0
    for i in range(first, first + count, step):  # both sides of a sheet count alike
        nx, ny, nz = _normal(corners, i)
        sign = 1.0 if nx * rx + ny * ry + nz * rz >= 0.0 else -1.0
        sx, sy, sz = sx + sign * nx, sy + sign * ny, sz + sign * nz
    length = math.sqrt(sx * sx + sy * sy + sz * sz)
    sx, sy, sz = sx / length, sy / length, sz / length
    axes[2, 0], axes[2, 1], axes[2, 2] = sx, sy, sz
    axes[0, 0] = np.nan
    least = np.inf
    for i in range(first, first + count, step * max(1, count // step // 6)):
        for edge in range(3):
            after = edge + 1 if edge < 2 else 0
            x, y, z = (corners[i, after, 0] - corners[i, edge, 0], corners[i, after, 1] - corners[i, edge, 1],
                       corners[i, after, 2] - corners[i, edge, 2])
            vx, vy, vz = sy * z - sz * y, sz * x - sx * z, sx * y - sy * x
            length = math.sqrt(vx * vx + vy * vy + vz * vz)
            vx, vy, vz = vx / length, vy / length, vz / length
            ux, uy, uz = vy * sz - vz * sy, vz * sx - vx * sz, vx * sy - vy * sx
            low_u, high_u = _extent(corners, first, count, step, ux, uy, uz)
            low_v, high_v = _extent(corners, first, count, step, vx, vy, vz)
            area = (high_u - low_u) * (high_v - low_v)
            if area < least:
                least = area
                axes[0, 0], axes[0, 1], axes[0, 2] = ux, uy, uz
                axes[1, 0], axes[1, 1], axes[1, 2] = vx, vy, vz


@kernel
def _normal(corners, i):
    """The normal of a triangle, as long as twice its area."""
    ux, uy, uz = (corners[i, 1, 0] - corners[i, 0, 0], corners[i, 1, 1] - corners[i, 0, 1],
                  corners[i, 1, 2] - corners[i, 0, 2])
    vx, vy, vz = (corners[i, 2, 0] - corners[i, 0, 0], corners[i, 2, 1] - corners[i, 0, 1],
                  corners[i, 2, 2] - corners[i, 0, 2])
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@kernel
def _extent(corners, first, count, step, x, y, z):
    """How far triangles reach along a direction, from the first one's first corner."""
    low, high = np.inf, -np.inf
    for i in range(first, first + count, step):
        for k in range(3):
            along = ((corners[i, k, 0] - corners[first, 0, 0]) * x + (corners[i, k, 1] - corners[first, 0, 1]) * y
                     + (corners[i, k, 2] - corners[first, 0, 2]) * z)
            low, high = min(low, along), max(high, along)
    return low, high


@kernel
def _write(corners, first, count, axes, box, out):
    """Writes the box along the axes, and whether it is a box at all and smaller than the aligned one."""
    for i in range(3):
        for k in range(3):
            out[3 * i + k] = axes[i, k]
    off = 0.0
    for i in range(3):
        for j in range(3):
            dot = np.float64(0.0)
            for k in range(3):
                dot += np.float64(out[3 * i + k]) * np.float64(out[3 * j + k])
            off = max(off, abs(dot - (1.0 if i == j else 0.0)))
    half = (0.0, 0.0, 0.0)
    cx, cy, cz = corners[first, 0, 0], corners[first, 0, 1], corners[first, 0, 2]
    for i in range(3):
        x, y, z = np.float64(out[3 * i]), np.float64(out[3 * i + 1]), np.float64(out[3 * i + 2])
        low, high = _extent(corners, first, count, 1, x, y, z)
        middle = 0.5 * (low + high)
        cx, cy, cz = cx + middle * x, cy + middle * y, cz + middle * z
        half = (half[1], half[2], 0.5 * (high - low))
    out[9], out[10], out[11] = cx, cy, cz
    out[12], out[13], out[14] = half
    # NaN, from triangles without an area, is not smaller.
    return off < ROUGH and half[0] * half[1] + half[1] * half[2] + half[2] * half[0] < (
        box[3] * box[4] + box[4] * box[5] + box[5] * box[3])
