"""Oriented bounding boxes of octree nodes, and the test of eight of them at once against another box.

A small patch of a surface is nearly flat: a box along its normal is far thinner than one along the model's axes, so two
surfaces that pass each other closely are separated many levels earlier. These boxes only prune. They are float32, so
that the children of a node fill the lanes of one SIMD vector; SLACK covers the rounding.

A node's row of ROWS numbers, in the model's frame, m: 0-8 unit axes of the oriented box, one after the other; 9-11 its
center; 12-14 its half extents; 15-17 center and 18-20 half extents of the axis-aligned box.
"""

import math

import numpy as np

from drone_engine.collision.triangle.geometry import triangle_normal
from drone_engine.kernel import allocating, kernel
from drone_engine.math.scalar import max2

LANES = 8  # children of a node, and lanes of a vector
ROWS = 21  # numbers per node
SLACK = 2.0**-18  # of the size of a query: 64 roundings of float32; fewer than 40 can add up
MIN_SLACK = 1e-37  # m; keeps the slack above zero in float32
EMPTY_LANE = -1e35  # m; half extents of a lane without a child, so that it overlaps nothing
MAX_AXES_ERROR = 1e-6  # of the products of unit axes: a node with a larger one keeps its axis-aligned box
SAMPLES = 24  # triangles of a node from which its axes are chosen


@allocating
def fit_boxes(box, link, corners, node_box):
    """Writes the row of each node to node_box (k, ROWS), float32.

    box (k, 6), link (k, 4), corners (m, 3, 3): as in Octree.
    """
    axes = np.empty((3, 3))
    for node in range(box.shape[0]):
        first, count = link[node, 2], link[node, 3]
        _choose_axes(corners, first, count, axes)
        if not _write_box(corners, first, count, axes, box[node], node_box[node]):
            for k in range(9):
                node_box[node, k] = 1.0 if k % 4 == 0 else 0.0
            for k in range(6):
                node_box[node, 9 + k] = box[node, k]
        for k in range(6):
            node_box[node, 15 + k] = box[node, k]


@allocating
def group_children(link, node_box, child_group, child_boxes):
    """Writes the rows of each inner node's children side by side to child_boxes (g, ROWS, LANES), and the index of the
    node's group to child_group (k,), -1 for a leaf."""
    child_boxes[:] = 0.0
    child_boxes[:, 12:15] = EMPTY_LANE
    child_boxes[:, 18:21] = EMPTY_LANE
    count = 0
    for node in range(link.shape[0]):
        child_group[node] = -1
        if link[node, 1] > 0:
            child_group[node] = count
            for child in range(link[node, 1]):
                for row in range(ROWS):
                    child_boxes[count, row, child] = node_box[link[node, 0] + child, row]
            count += 1


@kernel
def overlapping_children(child_boxes, g, q, size):
    """The oriented boxes of group g that may overlap box q, as bits, and the index of the one that overlaps deepest.

    Tests all fifteen separating axes (Gottschalk, Lin and Manocha 1996, OBBTree). q: (15,) float32, unit axes, center,
    half extents with slack, in the frame of the group. size: upper bound of any gap or overlap, m, float32.
    """
    u0, u1, u2, v0, v1, v2, n0, n1, n2 = q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7], q[8]
    c0, c1, c2, g0, g1, g2 = q[9], q[10], q[11], q[12], q[13], q[14]
    zero, scale = np.float32(0.0), np.float32(2.0**26) / size
    slack = np.float32(SLACK) * size
    mask, deepest = np.int32(0), np.int32(-1)
    for k in range(LANES):  # becomes one vector; that needs reductions of integers only
        a0, a1, a2 = child_boxes[g, 0, k], child_boxes[g, 1, k], child_boxes[g, 2, k]
        b0, b1, b2 = child_boxes[g, 3, k], child_boxes[g, 4, k], child_boxes[g, 5, k]
        m0, m1, m2 = child_boxes[g, 6, k], child_boxes[g, 7, k], child_boxes[g, 8, k]
        d0, d1, d2 = c0 - child_boxes[g, 9, k], c1 - child_boxes[g, 10, k], c2 - child_boxes[g, 11, k]
        h0, h1, h2 = child_boxes[g, 12, k], child_boxes[g, 13, k], child_boxes[g, 14, k]
        r00, r01, r02 = a0 * u0 + a1 * u1 + a2 * u2, a0 * v0 + a1 * v1 + a2 * v2, a0 * n0 + a1 * n1 + a2 * n2
        r10, r11, r12 = b0 * u0 + b1 * u1 + b2 * u2, b0 * v0 + b1 * v1 + b2 * v2, b0 * n0 + b1 * n1 + b2 * n2
        r20, r21, r22 = m0 * u0 + m1 * u1 + m2 * u2, m0 * v0 + m1 * v1 + m2 * v2, m0 * n0 + m1 * n1 + m2 * n2
        p00, p01, p02 = abs(r00), abs(r01), abs(r02)
        p10, p11, p12 = abs(r10), abs(r11), abs(r12)
        p20, p21, p22 = abs(r20), abs(r21), abs(r22)
        t0, t1, t2 = a0 * d0 + a1 * d1 + a2 * d2, b0 * d0 + b1 * d1 + b2 * d2, m0 * d0 + m1 * d1 + m2 * d2
        gap = max2(abs(t0) - (h0 + p00 * g0 + p01 * g1 + p02 * g2),
                   max2(abs(t1) - (h1 + p10 * g0 + p11 * g1 + p12 * g2),
                        abs(t2) - (h2 + p20 * g0 + p21 * g1 + p22 * g2)))
        gap = max2(gap, abs(u0 * d0 + u1 * d1 + u2 * d2) - (g0 + p00 * h0 + p10 * h1 + p20 * h2))
        gap = max2(gap, abs(v0 * d0 + v1 * d1 + v2 * d2) - (g1 + p01 * h0 + p11 * h1 + p21 * h2))
        gap = max2(gap, abs(n0 * d0 + n1 * d1 + n2 * d2) - (g2 + p02 * h0 + p12 * h1 + p22 * h2))
        edge = max2(max2(abs(t2 * r10 - t1 * r20) - (h1 * p20 + h2 * p10 + g1 * p02 + g2 * p01),
                         abs(t2 * r11 - t1 * r21) - (h1 * p21 + h2 * p11 + g0 * p02 + g2 * p00)),
                    abs(t2 * r12 - t1 * r22) - (h1 * p22 + h2 * p12 + g0 * p01 + g1 * p00))
        edge = max2(edge, max2(abs(t0 * r20 - t2 * r00) - (h0 * p20 + h2 * p00 + g1 * p12 + g2 * p11),
                               abs(t0 * r21 - t2 * r01) - (h0 * p21 + h2 * p01 + g0 * p12 + g2 * p10)))
        edge = max2(edge, max2(abs(t0 * r22 - t2 * r02) - (h0 * p22 + h2 * p02 + g0 * p11 + g1 * p10),
                               abs(t1 * r00 - t0 * r10) - (h0 * p10 + h1 * p00 + g1 * p22 + g2 * p21)))
        edge = max2(edge, max2(abs(t1 * r01 - t0 * r11) - (h0 * p11 + h1 * p01 + g0 * p22 + g2 * p20),
                               abs(t1 * r02 - t0 * r12) - (h0 * p12 + h1 * p02 + g0 * p21 + g1 * p20)))
        gap = max2(gap, edge - slack)
        far = gap > zero
        mask |= np.int32(0) if far else np.int32(1) << np.int32(k)
        depth = np.int32(-gap * scale) if gap > -size else np.int32(0)
        deepest = max(deepest, np.int32(-1) if far else depth * np.int32(8) + np.int32(k))
    return mask, deepest & 7


@kernel
def overlapping_aligned_children(child_boxes, g, q, size):
    """As `overlapping_children`, for the axis-aligned boxes of group g and a box that is axis-aligned in another frame.

    q: (15,) float32, the rotation matrix from that frame into the group's, row by row, then center and half extents.
    """
    m0, m1, m2, m3, m4, m5, m6, m7, m8 = q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7], q[8]
    p0, p1, p2, p3, p4, p5, p6, p7, p8 = abs(m0), abs(m1), abs(m2), abs(m3), abs(m4), abs(m5), abs(m6), abs(m7), abs(m8)
    c0, c1, c2, g0, g1, g2 = q[9], q[10], q[11], q[12], q[13], q[14]
    r0, r1, r2 = p0 * g0 + p1 * g1 + p2 * g2, p3 * g0 + p4 * g1 + p5 * g2, p6 * g0 + p7 * g1 + p8 * g2
    zero, scale = np.float32(0.0), np.float32(2.0**26) / size
    mask, deepest = np.int32(0), np.int32(-1)
    for k in range(LANES):
        d0, d1, d2 = c0 - child_boxes[g, 15, k], c1 - child_boxes[g, 16, k], c2 - child_boxes[g, 17, k]
        h0, h1, h2 = child_boxes[g, 18, k], child_boxes[g, 19, k], child_boxes[g, 20, k]
        gap = max2(abs(d0) - (h0 + r0), max2(abs(d1) - (h1 + r1), abs(d2) - (h2 + r2)))
        gap = max2(gap, abs(m0 * d0 + m3 * d1 + m6 * d2) - (g0 + p0 * h0 + p3 * h1 + p6 * h2))
        gap = max2(gap, abs(m1 * d0 + m4 * d1 + m7 * d2) - (g1 + p1 * h0 + p4 * h1 + p7 * h2))
        gap = max2(gap, abs(m2 * d0 + m5 * d1 + m8 * d2) - (g2 + p2 * h0 + p5 * h1 + p8 * h2))
        far = gap > zero
        mask |= np.int32(0) if far else np.int32(1) << np.int32(k)
        depth = np.int32(-gap * scale) if gap > -size else np.int32(0)
        deepest = max(deepest, np.int32(-1) if far else depth * np.int32(8) + np.int32(k))
    return mask, deepest & 7


@kernel
def _choose_axes(corners, first, count, axes):
    """Writes unit axes, one a row, for triangles `first` to first + count: the third is the mean of their normals, the
    first is the direction of an edge, out of some of them, for which the rectangle around the triangles is smallest."""
    step = (count + SAMPLES - 1) // SAMPLES
    rx, ry, rz = 0.0, 0.0, 0.0
    largest = 0.0
    for i in range(first, first + count, step):
        nx, ny, nz = triangle_normal(corners, i)
        square = nx * nx + ny * ny + nz * nz
        if square > largest:
            largest, rx, ry, rz = square, nx, ny, nz
    sx, sy, sz = 0.0, 0.0, 0.0
    for i in range(first, first + count, step):  # normals of opposite sides of a thin sheet add up
        nx, ny, nz = triangle_normal(corners, i)
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
            low_u, high_u = _interval_along(corners, first, count, step, ux, uy, uz)
            low_v, high_v = _interval_along(corners, first, count, step, vx, vy, vz)
            area = (high_u - low_u) * (high_v - low_v)
            if area < least:
                least = area
                axes[0, 0], axes[0, 1], axes[0, 2] = ux, uy, uz
                axes[1, 0], axes[1, 1], axes[1, 2] = vx, vy, vz


@kernel
def _interval_along(corners, first, count, step, x, y, z):
    """The smallest and largest coordinate of every step-th triangle along (x, y, z), from the first corner of the first
    one, m."""
    low, high = np.inf, -np.inf
    for i in range(first, first + count, step):
        for k in range(3):
            along = ((corners[i, k, 0] - corners[first, 0, 0]) * x + (corners[i, k, 1] - corners[first, 0, 1]) * y
                     + (corners[i, k, 2] - corners[first, 0, 2]) * z)
            low, high = min(low, along), max(high, along)
    return low, high


@kernel
def _write_box(corners, first, count, axes, box, out):
    """Writes the box of triangles `first` to first + count along the axes to out[:15]; returns whether it is valid and
    has a smaller surface than the axis-aligned one, box (6,)."""
    for i in range(3):
        for k in range(3):
            out[3 * i + k] = axes[i, k]
    error = 0.0
    for i in range(3):
        for j in range(3):
            dot = np.float64(0.0)
            for k in range(3):
                dot += np.float64(out[3 * i + k]) * np.float64(out[3 * j + k])
            error = max(error, abs(dot - (1.0 if i == j else 0.0)))
    half = (0.0, 0.0, 0.0)
    cx, cy, cz = corners[first, 0, 0], corners[first, 0, 1], corners[first, 0, 2]
    for i in range(3):
        x, y, z = np.float64(out[3 * i]), np.float64(out[3 * i + 1]), np.float64(out[3 * i + 2])
        low, high = _interval_along(corners, first, count, 1, x, y, z)
        middle = 0.5 * (low + high)
        cx, cy, cz = cx + middle * x, cy + middle * y, cz + middle * z
        half = (half[1], half[2], 0.5 * (high - low))
    out[9], out[10], out[11] = cx, cy, cz
    out[12], out[13], out[14] = half
    # NaN, from triangles without an area, compares as false.
    return error < MAX_AXES_ERROR and half[0] * half[1] + half[1] * half[2] + half[2] * half[0] < (
        box[3] * box[4] + box[4] * box[5] + box[5] * box[3])
