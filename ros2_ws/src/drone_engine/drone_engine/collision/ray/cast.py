"""Ray casts against bodies at any collision level: for range sensors and for picking.

Spheres and boxes (levels sphere, obb, octree) are solid: a ray that starts inside hits at distance 0. Triangles are a
surface. A ray is transformed into the frame of a body and rounded there once. Bounds are padded for rounding, so that
a hit at a finer level is a hit at every coarser level, no farther away.
Sources: Ize 2013 (Robust BVH Ray Traversal); Haines et al. 2019 (Precision Improvements for Ray/Sphere Intersection).
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.mesh.octree import EMPTY, Octree
from drone_engine.collision.ray.triangle import edge_function_error, ray_triangle, shear
from drone_engine.collision_level import OBB, SPHERE, TRIANGLE
from drone_engine.kernel import allocating, kernel
from drone_engine.math.rotation import matrix

EPS = 2.0**-52
PAD = 16.0 * EPS  # of the distances involved: how much the box of a leaf is padded
TINY = 1e-290  # components of a unit direction below this count as 0
POSITION, OFFSET, RADIUS, REACH, CENTER, HALF, COLUMNS = 9, 12, 15, 16, 17, 20, 23  # of `prepare_bodies`


@kernel
def ray_sphere(ox, oy, oz, dx, dy, dz, radius):
    """Distance from o along the unit direction d to a sphere about 0: 0 from inside, inf for a miss."""
    if ox * ox + oy * oy + oz * oz <= radius * radius:
        return 0.0
    along = ox * dx + oy * dy + oz * dz
    x, y, z = ox - along * dx, oy - along * dy, oz - along * dz
    square = radius * radius - (x * x + y * y + z * z)
    if along > 0.0 or not square >= 0.0:
        return math.inf
    return max(-along - math.sqrt(square), 0.0)


@kernel
def reciprocal(d):
    """1 / d, or a large finite number for 0, so that the distances of a slab are never NaN."""
    return 1.0 / d if abs(d) > TINY else math.copysign(1.0 / TINY, d)


@kernel
def ray_box(ox, oy, oz, ix, iy, iz, hx, hy, hz):
    """Distance from o to the box |x| <= hx, |y| <= hy, |z| <= hz in its own frame: 0 from inside, inf for a miss.

    (ix, iy, iz): reciprocals of the unit direction. The far distance is increased by 2 roundings, so that no hit is
    lost (Ize 2013).
    """
    x0, x1 = (-hx - ox) * ix, (hx - ox) * ix
    y0, y1 = (-hy - oy) * iy, (hy - oy) * iy
    z0, z1 = (-hz - oz) * iz, (hz - oz) * iz
    near = max(min(x0, x1), min(y0, y1), min(z0, z1), 0.0)
    far = min(max(x0, x1), max(y0, y1), max(z0, z1))
    return near if near <= far * (1.0 + 4.0 * EPS) else math.inf


@allocating
def ray_octree(box, link, corners, root, ox, oy, oz, dx, dy, dz, pad, bound, level, best, stack, entry):
    """The nearest triangle (level TRIANGLE, else leaf) that a ray hits closer than `best`: (distance, index).

    The index is the row in corners (t, 3, 3), or the node; -1 if there is none. box (n, 6), link (n, 4), corners: as in
    Octree. o, d: the ray in the frame of the tree, d a unit vector. pad: padding of the boxes, m; bound: as in
    `ray_triangle`. stack, entry: (n,) scratch. Children are visited from front to back. It takes 16 scalars and arrays,
    as a leaf that runs once per ray and body.
    """
    ix, iy, iz = reciprocal(dx), reciprocal(dy), reciprocal(dz)
    kx, ky, kz, sx, sy, sz = shear(dx, dy, dz)
    hit = -1
    stack[0], entry[0] = root, 0.0
    if link[root, 1] == 0:
        entry[0] = ray_box(ox - box[root, 0], oy - box[root, 1], oz - box[root, 2], ix, iy, iz, box[root, 3] + pad,
                           box[root, 4] + pad, box[root, 5] + pad)
    top = 1
    while top > 0:
        top -= 1
        if not entry[top] < best:
            continue
        node = stack[top]
        if link[node, 1] == 0:
            if level != TRIANGLE:
                best, hit = entry[top], node
                continue
            for i in range(link[node, 2], link[node, 2] + link[node, 3]):
                t = ray_triangle(corners, i, ox, oy, oz, dx, dy, dz, kx, ky, kz, sx, sy, sz, bound)
                if t < best:
                    best, hit = t, i
            continue
        base = top
        for child in range(link[node, 0], link[node, 0] + link[node, 1]):
            grown = pad if link[child, 1] == 0 else 2.0 * pad
            t = ray_box(ox - box[child, 0], oy - box[child, 1], oz - box[child, 2], ix, iy, iz, box[child, 3] + grown,
                        box[child, 4] + grown, box[child, 5] + grown)
            if t < best:
                at = top
                while at > base and entry[at - 1] < t:
                    entry[at], stack[at] = entry[at - 1], stack[at - 1]
                    at -= 1
                entry[at], stack[at] = t, child
                top += 1
    return best, hit


@kernel
def prepare_bodies(position, orientation, half, root, box, table):
    """Writes a row of COLUMNS numbers for each of n bodies to table: rotation matrix, row by row; position; offset from
    there to the center of its box, world; radius of the box; how far the box reaches from the position; center and half
    extents of the box, body frame.

    position (n, 3), orientation (n, 4), half (n, 3). The box is that of the tree with node root[i] of box (k, 6), or
    `half` about the position where root[i] is -1.
    """
    for i in range(position.shape[0]):
        row = table[i]
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        for k in range(9):
            row[k] = m[k]
        for k in range(3):
            row[POSITION + k] = position[i, k]
            row[CENTER + k] = box[root[i], k] if root[i] >= 0 else 0.0
            row[HALF + k] = box[root[i], 3 + k] if root[i] >= 0 else half[i, k]
        for k in range(3):
            row[OFFSET + k] = (m[3 * k] * row[CENTER] + m[3 * k + 1] * row[CENTER + 1]
                               + m[3 * k + 2] * row[CENTER + 2])
        row[RADIUS] = math.sqrt(row[HALF] ** 2 + row[HALF + 1] ** 2 + row[HALF + 2] ** 2)
        row[REACH] = (abs(row[CENTER]) + row[HALF] + abs(row[CENTER + 1]) + row[HALF + 1]
                      + abs(row[CENTER + 2]) + row[HALF + 2])


@kernel
def to_body(row, x, y, z):
    """A vector of the world frame in the frame of the body; row: of `prepare_bodies`."""
    return (row[0] * x + row[3] * y + row[6] * z, row[1] * x + row[4] * y + row[7] * z,
            row[2] * x + row[5] * y + row[8] * z)


@kernel
def to_world(row, x, y, z):
    """A vector of the body frame in the world; row: of `prepare_bodies`."""
    return (row[0] * x + row[1] * y + row[2] * z, row[3] * x + row[4] * y + row[5] * z,
            row[6] * x + row[7] * y + row[8] * z)


@kernel
def normalized(x, y, z):
    """The unit vector along a vector of any length but 0; NaN for 0."""
    most = max(abs(x), abs(y), abs(z))
    x, y, z = x / most, y / most, z / most
    norm = math.sqrt(x * x + y * y + z * z)
    return x / norm, y / norm, z / norm


@allocating
def cast_rays(origin, direction, limit, table, level, root, box, link, corners, stack, entry, hits):
    """Writes the nearest hit closer than `limit`, m, of each ray with any of the bodies to `hits`, as in Hits, with the
    index of `ray_octree` as face. Rows of rays that hit nothing are left unchanged.

    origin, direction: (n, 3); table: of `prepare_bodies`; level, root: (b,) collision level and tree of each body.
    """
    distance, body, index, normal, point = hits
    for i in range(origin.shape[0]):
        dx, dy, dz = normalized(direction[i, 0], direction[i, 1], direction[i, 2])
        best, hit, where = limit, -1, -1
        for b in range(table.shape[0]):
            row = table[b]
            gx, gy = origin[i, 0] - row[POSITION], origin[i, 1] - row[POSITION + 1]
            gz = origin[i, 2] - row[POSITION + 2]
            far = abs(gx) + abs(gy) + abs(gz) + row[REACH]
            pad = PAD * far
            t = ray_sphere(gx - row[OFFSET], gy - row[OFFSET + 1], gz - row[OFFSET + 2], dx, dy, dz,
                           row[RADIUS] + 5.0 * pad)
            if not t < best:
                continue
            found = -1
            if level[b] != SPHERE:
                ox, oy, oz = to_body(row, gx, gy, gz)
                ux, uy, uz = to_body(row, dx, dy, dz)
                if level[b] == OBB:
                    t = ray_box(ox - row[CENTER], oy - row[CENTER + 1], oz - row[CENTER + 2], reciprocal(ux),
                                reciprocal(uy), reciprocal(uz), row[HALF] + 2.0 * pad, row[HALF + 1] + 2.0 * pad,
                                row[HALF + 2] + 2.0 * pad)
                else:
                    t, found = ray_octree(box, link, corners, root[b], ox, oy, oz, ux, uy, uz, pad,
                                          edge_function_error(far), level[b], best, stack, entry)
            if t < best:
                best, hit, where = t, b, found
        if hit >= 0:
            distance[i], body[i], index[i] = best, hit, where
            row = table[hit]
            x, y, z = normal_at(row, level[hit], where, box, corners, origin[i, 0] - row[POSITION] + best * dx,
                                origin[i, 1] - row[POSITION + 1] + best * dy,
                                origin[i, 2] - row[POSITION + 2] + best * dz)
            facing = x * dx + y * dy + z * dz
            if (best == 0.0 and level[hit] != TRIANGLE) or not (x != 0.0 or y != 0.0 or z != 0.0):
                x, y, z = -dx, -dy, -dz
            elif facing > 0.0:
                x, y, z = -x, -y, -z
            normal[i, 0], normal[i, 1], normal[i, 2] = x, y, z
            point[i, 0], point[i, 1], point[i, 2] = (origin[i, 0] + best * dx, origin[i, 1] + best * dy,
                                                     origin[i, 2] + best * dz)


@kernel
def normal_at(row, level, index, box, corners, x, y, z):
    """The unit normal of a body's surface at a point of it, world frame.

    row: of `prepare_bodies`; level, index: what was hit, as in `ray_octree`; (x, y, z): the point from the position of
    the body, world. The normal of a triangle points to either side, and is 0 for one without area.
    """
    if level == SPHERE:
        return normalized(x - row[OFFSET], y - row[OFFSET + 1], z - row[OFFSET + 2])
    if level == TRIANGLE:
        a, b, c = corners[index, 0], corners[index, 1], corners[index, 2]
        ux, uy, uz = normalized(b[0] - a[0], b[1] - a[1], b[2] - a[2])
        vx, vy, vz = normalized(c[0] - a[0], c[1] - a[1], c[2] - a[2])
        x, y, z = normalized(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
        return to_world(row, x, y, z) if x == x else (0.0, 0.0, 0.0)
    x, y, z = to_body(row, x, y, z)
    if level == OBB:
        x, y, z = x - row[CENTER], y - row[CENTER + 1], z - row[CENTER + 2]
        inside_x, inside_y, inside_z = row[HALF] - abs(x), row[HALF + 1] - abs(y), row[HALF + 2] - abs(z)
    else:
        x, y, z = x - box[index, 0], y - box[index, 1], z - box[index, 2]
        inside_x, inside_y, inside_z = box[index, 3] - abs(x), box[index, 4] - abs(y), box[index, 5] - abs(z)
    if inside_x <= inside_y and inside_x <= inside_z:
        return to_world(row, math.copysign(1.0, x), 0.0, 0.0)
    if inside_y <= inside_z:
        return to_world(row, 0.0, math.copysign(1.0, y), 0.0)
    return to_world(row, 0.0, 0.0, math.copysign(1.0, z))


class Hits(NamedTuple):
    """The nearest hit of each of n rays; m, world frame. inf, -1 and NaN where there is none within the range."""

    distance: Floats  # (n,)
    body: Integers  # (n,)
    face: Integers  # (n,) the triangle, as in the given faces; the node at level octree; -1 at levels sphere and obb
    normal: Floats  # (n, 3) unit, of the surface, towards the side that the ray comes from
    point: Floats  # (n, 3)


def cast(origins: Floats, directions: Floats, poses: Floats, half: Floats, levels: Sequence[int] | Integers | int,
         forest: Octree | None = None, roots: Sequence[int] | Integers | int = -1, max_range: float = math.inf) -> Hits:
    """Casts n rays at b bodies, or at one.

    origins: (n, 3) or (3,) m. directions: (n, 3) or (3,), of any length but 0. poses: (b, 7) or (7,), x y z and a unit
    quaternion x y z w. half: (b, 3) or (3,) half extents of the boxes about the positions, m; bodies with a tree use
    the box of the tree. levels: (b,) collision levels, or one. roots: (b,) nodes of the forest, or one; -1: no tree.
    Raises ValueError for other shapes, numbers that are not finite, directions of length 0 and missing trees.
    """
    origin, direction = (np.atleast_2d(np.ascontiguousarray(rays, float)) for rays in (origins, directions))
    pose = np.atleast_2d(np.asarray(poses, float))
    count, bodies = len(origin), len(pose)
    extent = np.ascontiguousarray(np.broadcast_to(np.asarray(half, float), (bodies, 3)))
    level = np.ascontiguousarray(np.broadcast_to(np.asarray(levels, np.int64), bodies))
    root = np.ascontiguousarray(np.broadcast_to(np.asarray(roots, np.int64), bodies))
    nodes = 0 if forest is None else len(forest.box)
    if origin.shape != (count, 3) or direction.shape != (count, 3):
        raise ValueError(f"rays: expected origins and directions (n, 3), got {origin.shape} and {direction.shape}")
    if pose.shape != (bodies, 7):
        raise ValueError(f"poses: expected (b, 7), got {pose.shape}")
    if not (np.isfinite(origin).all() and np.isfinite(direction).all() and np.isfinite(pose).all()):
        raise ValueError("rays: expected finite origins, directions and poses, got numbers that are not finite")
    if not direction.any(axis=1).all():
        raise ValueError(f"directions[{int(direction.any(axis=1).argmin())}]: expected a length other than 0, got 0")
    if ((level > OBB) & (root < 0)).any() or (root >= nodes).any():
        raise ValueError(f"roots: expected nodes of a forest of {nodes} at levels octree and triangle, got {root}")
    box, link, corners, *_ = EMPTY if forest is None else forest
    table = np.empty((bodies, COLUMNS))
    prepare_bodies(np.ascontiguousarray(pose[:, :3]), np.ascontiguousarray(pose[:, 3:]), extent, root, box, table)
    hits = Hits(np.full(count, np.inf), np.full(count, -1), np.full(count, -1), *np.full((2, count, 3), np.nan))
    # The limit is the next larger number, so that a hit exactly at the maximum range counts.
    cast_rays(origin, direction, np.nextafter(max_range, np.inf), table, level, root, box, link, corners,
              np.empty(nodes, np.int64), np.empty(nodes), hits)
    on_triangle = (hits.body >= 0) & (level[hits.body] == TRIANGLE)
    if forest is not None:
        hits.face[on_triangle] = forest.face[hits.face[on_triangle]]
    return hits
