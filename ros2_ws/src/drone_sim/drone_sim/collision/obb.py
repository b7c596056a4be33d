"""Oriented boxes: the contact of two, by separating axes and clipping.

Axes come as (n, 3, 3), one a row, unit vectors in the world; half extents as (n, 3). Sources: Gottschalk, Lin and
Manocha 1996 (OBBTree) for the fifteen axes; Sutherland and Hodgman 1974 for the clipping.
"""

import math

from drone_sim.kernel import kernel

FACE_PREFERENCE = 0.02  # of the smallest half extent: how much better an edge axis must be than a face's
PARALLEL = 1e-6  # squared sine below which two edges span no axis of their own


@kernel
def contact(position, axes, half, a, b, margin, normal, point, separation, feature, scratch):
    """The contact of boxes a and b, up to `margin` m apart: writes it and returns its number of points, 0 to 8.

    normal: (3,) unit vector from a to b. point: (8, 3) in the world, midway between the two surfaces.
    separation: (8,) m, negative where they overlap. feature: (8,) names a point from one step to the next.
    scratch: (2, 16, 4).
    """
    dx = position[b, 0] - position[a, 0]
    dy = position[b, 1] - position[a, 1]
    dz = position[b, 2] - position[a, 2]
    best, best_kind, best_i, best_j = -math.inf, 0, 0, 0
    nx, ny, nz = 0.0, 0.0, 0.0
    slack = FACE_PREFERENCE * min(half[a, 0], half[a, 1], half[a, 2], half[b, 0], half[b, 1], half[b, 2])

    for box in range(2):
        body, other = (a, b) if box == 0 else (b, a)
        for i in range(3):
            x, y, z = axes[body, i, 0], axes[body, i, 1], axes[body, i, 2]
            distance = dx * x + dy * y + dz * z
            s = abs(distance) - half[body, i] - _reach(axes, half, other, x, y, z)
            if s > margin:
                return 0
            if s > best + (slack if box == 1 else 0.0):
                sign = 1.0 if distance >= 0.0 else -1.0
                best, best_kind, best_i = s, box, i
                nx, ny, nz = sign * x, sign * y, sign * z

    for i in range(3):
        for j in range(3):
            x = axes[a, i, 1] * axes[b, j, 2] - axes[a, i, 2] * axes[b, j, 1]
            y = axes[a, i, 2] * axes[b, j, 0] - axes[a, i, 0] * axes[b, j, 2]
            z = axes[a, i, 0] * axes[b, j, 1] - axes[a, i, 1] * axes[b, j, 0]
            square = x * x + y * y + z * z
            if square < PARALLEL:
                continue
            scale = 1.0 / math.sqrt(square)
            x, y, z = x * scale, y * scale, z * scale
            distance = dx * x + dy * y + dz * z
            s = abs(distance) - _reach(axes, half, a, x, y, z) - _reach(axes, half, b, x, y, z)
            if s > margin:
                return 0
            if s > best + slack:
                sign = 1.0 if distance >= 0.0 else -1.0
                best, best_kind, best_i, best_j = s, 2, i, j
                nx, ny, nz = sign * x, sign * y, sign * z

    normal[0], normal[1], normal[2] = nx, ny, nz
    if best_kind == 2:
        _edge_point(position, axes, half, a, b, best_i, best_j, nx, ny, nz, point)
        separation[0] = best
        feature[0] = (1 << 20) + 3 * best_i + best_j
        return 1
    if best_kind == 0:
        return _clip(position, axes, half, a, b, best_i, nx, ny, nz, margin, 0, point, separation, feature, scratch)
    return _clip(position, axes, half, b, a, best_i, -nx, -ny, -nz, margin, 1, point, separation, feature, scratch)


@kernel
def _reach(axes, half, i, x, y, z):
    """How far box i reaches from its centre along the unit vector (x, y, z)."""
    return (abs(axes[i, 0, 0] * x + axes[i, 0, 1] * y + axes[i, 0, 2] * z) * half[i, 0]
            + abs(axes[i, 1, 0] * x + axes[i, 1, 1] * y + axes[i, 1, 2] * z) * half[i, 1]
            + abs(axes[i, 2, 0] * x + axes[i, 2, 1] * y + axes[i, 2, 2] * z) * half[i, 2])


@kernel
def _dot(axes, i, k, x, y, z):
    return axes[i, k, 0] * x + axes[i, k, 1] * y + axes[i, k, 2] * z


@kernel
def _edge_point(position, axes, half, a, b, i, j, nx, ny, nz, point):
    """Writes the point midway between edge i of a and edge j of b, those that face each other along the normal."""
    ax, ay, az = position[a, 0], position[a, 1], position[a, 2]
    bx, by, bz = position[b, 0], position[b, 1], position[b, 2]
    for k in range(3):
        if k != i:
            s = half[a, k] if _dot(axes, a, k, nx, ny, nz) >= 0.0 else -half[a, k]
            ax, ay, az = ax + s * axes[a, k, 0], ay + s * axes[a, k, 1], az + s * axes[a, k, 2]
        if k != j:
            s = -half[b, k] if _dot(axes, b, k, nx, ny, nz) >= 0.0 else half[b, k]
            bx, by, bz = bx + s * axes[b, k, 0], by + s * axes[b, k, 1], bz + s * axes[b, k, 2]
    # Closest points of two lines (Ericson 2005, Real-Time Collision Detection, 5.1.8); unit directions, not parallel.
    cosine = _dot(axes, a, i, axes[b, j, 0], axes[b, j, 1], axes[b, j, 2])
    wx, wy, wz = ax - bx, ay - by, az - bz
    c, f = _dot(axes, a, i, wx, wy, wz), _dot(axes, b, j, wx, wy, wz)
    divisor = 1.0 - cosine * cosine
    s = min(max((cosine * f - c) / divisor, -half[a, i]), half[a, i])
    t = min(max((f - cosine * c) / divisor, -half[b, j]), half[b, j])
    for k in range(3):
        on_a = (ax, ay, az)[k] + s * axes[a, i, k]
        on_b = (bx, by, bz)[k] + t * axes[b, j, k]
        point[0, k] = 0.5 * (on_a + on_b)


@kernel
def _clip(position, axes, half, r, o, face, nx, ny, nz, margin, swapped, point, separation, feature, scratch):
    """Clips the face of box o that looks most against the normal to the face of box r that looks along it."""
    u, v = (face + 1) % 3, (face + 2) % 3
    incident, most = 0, -1.0
    for k in range(3):
        facing = abs(_dot(axes, o, k, nx, ny, nz))
        if facing > most:
            incident, most = k, facing
    p, q = (incident + 1) % 3, (incident + 2) % 3
    side = -half[o, incident] if _dot(axes, o, incident, nx, ny, nz) >= 0.0 else half[o, incident]
    sign = 1.0 if _dot(axes, r, face, nx, ny, nz) >= 0.0 else -1.0

    # The incident face's corners in the frame of the reference face: u, v along it, w above it.
    for corner in range(4):
        sp = half[o, p] if corner == 0 or corner == 3 else -half[o, p]
        sq = half[o, q] if corner < 2 else -half[o, q]
        x = position[o, 0] - position[r, 0] + side * axes[o, incident, 0] + sp * axes[o, p, 0] + sq * axes[o, q, 0]
        y = position[o, 1] - position[r, 1] + side * axes[o, incident, 1] + sp * axes[o, p, 1] + sq * axes[o, q, 1]
        z = position[o, 2] - position[r, 2] + side * axes[o, incident, 2] + sp * axes[o, p, 2] + sq * axes[o, q, 2]
        scratch[0, corner, 0] = _dot(axes, r, u, x, y, z)
        scratch[0, corner, 1] = _dot(axes, r, v, x, y, z)
        scratch[0, corner, 2] = sign * _dot(axes, r, face, x, y, z) - half[r, face]
        scratch[0, corner, 3] = corner
    count, source = 4, 0
    for plane in range(4):
        along = plane // 2
        limit = half[r, u] if along == 0 else half[r, v]
        direction = 1.0 if plane % 2 == 0 else -1.0
        target, kept = 1 - source, 0
        for i in range(count):
            j = i + 1 if i + 1 < count else 0
            here = direction * scratch[source, i, along] - limit
            there = direction * scratch[source, j, along] - limit
            if here <= 0.0:
                for k in range(4):
                    scratch[target, kept, k] = scratch[source, i, k]
                kept += 1
            if (here < 0.0 and there > 0.0) or (here > 0.0 and there < 0.0):
                t = here / (here - there)
                for k in range(3):
                    start, end = scratch[source, i, k], scratch[source, j, k]
                    scratch[target, kept, k] = start + t * (end - start)
                scratch[target, kept, 3] = 8 * (plane + 1) + int(scratch[source, i, 3]) % 8
                kept += 1
        count, source = kept, target
    found = 0
    for i in range(count):
        s = scratch[source, i, 2]
        if s > margin or found == 8:
            continue
        su, sv, sw = scratch[source, i, 0], scratch[source, i, 1], sign * (half[r, face] + 0.5 * s)
        for k in range(3):
            point[found, k] = position[r, k] + su * axes[r, u, k] + sv * axes[r, v, k] + sw * axes[r, face, k]
        separation[found] = s
        feature[found] = ((swapped * 3 + face) * 3 + incident) * 64 + int(scratch[source, i, 3])
        found += 1
    return found
