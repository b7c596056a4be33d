"""Ray casts against bodies at any level: for range sensors and for picking.

Balls and boxes (levels sphere, obb, octree) are solid: a ray that starts inside hits at distance 0. Triangles are a
surface. A ray is brought into a body's frame and rounded there once. Bounds are padded for rounding, so that whatever
a finer level hits is hit by a coarser one, no farther away.
Sources: Ize 2013 (Robust BVH Ray Traversal); Haines et al. 2019 (Precision Improvements for Ray/Sphere Intersection).
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.mesh.octree import EMPTY, Octree
from drone_engine.collision.ray.triangle import error, ray_triangle, shear
from drone_engine.collision_level import OBB, SPHERE, TRIANGLE
from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix

EPS = 2.0**-52
PAD = 16.0 * EPS  # of the distances in play: how much the box of a leaf grows
TINY = 1e-290  # components of a unit direction below this count as 0
POSITION, OFFSET, RADIUS, REACH, CENTRE, HALF, COLUMNS = 9, 12, 15, 16, 17, 20, 23  # of `tabulate`


@kernel
def ray_sphere(ox, oy, oz, dx, dy, dz, radius):
    """Distance from o along the unit direction d to the ball about 0; 0 from inside, inf if missed."""
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
    """1 / d, and a large finite number for 0, so that a slab's distances are never NaN."""
    return 1.0 / d if abs(d) > TINY else math.copysign(1.0 / TINY, d)


@kernel
def ray_box(ox, oy, oz, ix, iy, iz, hx, hy, hz):
    """Distance from o to the box |x| <= hx ... in its own frame; i: reciprocals of the unit direction; 0 from inside,
    inf if missed. The last slab is left 2 roundings late, so that a hit is never lost (Ize 2013)."""
    x0, x1 = (-hx - ox) * ix, (hx - ox) * ix
    y0, y1 = (-hy - oy) * iy, (hy - oy) * iy
    z0, z1 = (-hz - oz) * iz, (hz - oz) * iz
    near = max(min(x0, x1), min(y0, y1), min(z0, z1), 0.0)
    far = min(max(x0, x1), max(y0, y1), max(z0, z1))
    return near if near <= far * (1.0 + 4.0 * EPS) else math.inf


@kernel
def ray_octree(box, link, corners, root, ox, oy, oz, dx, dy, dz, pad, bound, level, best, stack, entry):
    """The nearest triangle (level TRIANGLE, its place in corners) or leaf (its node) that a ray hits closer than
    `best`: (distance, index), index -1 if there is none. In the tree's frame, d a unit vector. Children are visited
    front to back; stack and entry hold as many numbers as the tree has nodes.
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
def tabulate(position, orientation, half, root, box, table):
    """Writes what rays need of each body, a row of 23: rotation matrix; position; from there to the middle of its box,
    in the world; the box's radius; how far it reaches from the position; the box's middle and half extents, in the
    body. The box is that of the body's tree, and `half` about the position where it has none (root -1)."""
    for i in range(position.shape[0]):
        row = table[i]
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        for k in range(9):
            row[k] = m[k]
        for k in range(3):
            row[POSITION + k] = position[i, k]
            row[CENTRE + k] = box[root[i], k] if root[i] >= 0 else 0.0
            row[HALF + k] = box[root[i], 3 + k] if root[i] >= 0 else half[i, k]
        for k in range(3):
            row[OFFSET + k] = (m[3 * k] * row[CENTRE] + m[3 * k + 1] * row[CENTRE + 1]
                               + m[3 * k + 2] * row[CENTRE + 2])
        row[RADIUS] = math.sqrt(row[HALF] ** 2 + row[HALF + 1] ** 2 + row[HALF + 2] ** 2)
        row[REACH] = (abs(row[CENTRE]) + row[HALF] + abs(row[CENTRE + 1]) + row[HALF + 1]
                      + abs(row[CENTRE + 2]) + row[HALF + 2])


@kernel
def into(row, x, y, z):
    """A vector of the world in the body's frame."""
    return (row[0] * x + row[3] * y + row[6] * z, row[1] * x + row[4] * y + row[7] * z,
            row[2] * x + row[5] * y + row[8] * z)


@kernel
def out_of(row, x, y, z):
    """A vector of the body's frame in the world."""
    return (row[0] * x + row[1] * y + row[2] * z, row[3] * x + row[4] * y + row[5] * z,
            row[6] * x + row[7] * y + row[8] * z)


@kernel
def unit(x, y, z):
    """The unit vector along a vector of any length but 0."""
    most = max(abs(x), abs(y), abs(z))
    x, y, z = x / most, y / most, z / most
    norm = math.sqrt(x * x + y * y + z * z)
    return x / norm, y / norm, z / norm


@kernel
def cast_rays(origin, direction, limit, table, level, root, box, link, corners, stack, entry, distance, body, index,
              normal, point):
    """Writes the nearest hit closer than `limit` of each ray with any of the bodies: distance, body, index (see
    ray_octree), normal, point. What was written before stays where a ray hits nothing."""
    for i in range(origin.shape[0]):
        dx, dy, dz = unit(direction[i, 0], direction[i, 1], direction[i, 2])
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
                ox, oy, oz = into(row, gx, gy, gz)
                ux, uy, uz = into(row, dx, dy, dz)
                if level[b] == OBB:
                    t = ray_box(ox - row[CENTRE], oy - row[CENTRE + 1], oz - row[CENTRE + 2], reciprocal(ux),
                                reciprocal(uy), reciprocal(uz), row[HALF] + 2.0 * pad, row[HALF + 1] + 2.0 * pad,
                                row[HALF + 2] + 2.0 * pad)
                else:
                    t, found = ray_octree(box, link, corners, root[b], ox, oy, oz, ux, uy, uz, pad, error(far),
                                          level[b], best, stack, entry)
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
    """The unit normal, in the world, of a body's surface at a point of it, which is given from the body's position in
    the world; of a triangle either side's, 0 for one without area."""
    if level == SPHERE:
        return unit(x - row[OFFSET], y - row[OFFSET + 1], z - row[OFFSET + 2])
    if level == TRIANGLE:
        a, b, c = corners[index, 0], corners[index, 1], corners[index, 2]
        ux, uy, uz = unit(b[0] - a[0], b[1] - a[1], b[2] - a[2])
        vx, vy, vz = unit(c[0] - a[0], c[1] - a[1], c[2] - a[2])
        x, y, z = unit(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
        return out_of(row, x, y, z) if x == x else (0.0, 0.0, 0.0)
    x, y, z = into(row, x, y, z)
    if level == OBB:
        x, y, z = x - row[CENTRE], y - row[CENTRE + 1], z - row[CENTRE + 2]
        inside_x, inside_y, inside_z = row[HALF] - abs(x), row[HALF + 1] - abs(y), row[HALF + 2] - abs(z)
    else:
        x, y, z = x - box[index, 0], y - box[index, 1], z - box[index, 2]
        inside_x, inside_y, inside_z = box[index, 3] - abs(x), box[index, 4] - abs(y), box[index, 5] - abs(z)
    if inside_x <= inside_y and inside_x <= inside_z:
        return out_of(row, math.copysign(1.0, x), 0.0, 0.0)
    if inside_y <= inside_z:
        return out_of(row, 0.0, math.copysign(1.0, y), 0.0)
    return out_of(row, 0.0, 0.0, math.copysign(1.0, z))


class Hits(NamedTuple):
    """The nearest hit of each of n rays. m, the world's frame; inf, -1 and NaN where there is none within the range."""

    distance: Floats  # (n,)
    body: Integers  # (n,)
    face: Integers  # (n,) the triangle, as in the faces given; the node at level octree; -1 at levels sphere and obb
    normal: Floats  # (n, 3) unit, of the surface, on the side that the ray comes from
    point: Floats  # (n, 3)


def cast(origins: Floats, directions: Floats, poses: Floats, half: Floats, levels: Sequence[int] | Integers | int,
         forest: Octree | None = None, roots: Sequence[int] | Integers | int = -1, max_range: float = math.inf) -> Hits:
    """Casts n rays at b bodies, or at one.

    origins: (n, 3) or (3,) m. directions: of any length but 0. poses: (b, 7) or (7,). half: (b, 3) or (3,) half extents
    of the boxes, about the positions; bodies with a tree use its box. roots: nodes of the forest; -1: no tree.
    Raises ValueError.
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
        raise ValueError("rays: expected finite origins, directions and poses")
    if not direction.any(axis=1).all():
        raise ValueError(f"directions: expected a length other than 0, ray {int(direction.any(axis=1).argmin())} has 0")
    if ((level > OBB) & (root < 0)).any() or (root >= nodes).any():
        raise ValueError(f"roots: expected nodes of a forest of {nodes} at levels octree and triangle, got {root}")
    box, link, corners, *_ = EMPTY if forest is None else forest
    table = np.empty((bodies, COLUMNS))
    tabulate(np.ascontiguousarray(pose[:, :3]), np.ascontiguousarray(pose[:, 3:]), extent, root, box, table)
    hits = Hits(np.full(count, np.inf), np.full(count, -1), np.full(count, -1), *np.full((2, count, 3), np.nan))
    # A hit counts if it is closer than the next number, so that one at the very end of the range does.
    cast_rays(origin, direction, np.nextafter(max_range, np.inf), table, level, root, box, link, corners,
              np.empty(nodes, np.int64), np.empty(nodes), *hits)
    on_triangle = (hits.body >= 0) & (level[hits.body] == TRIANGLE)
    if forest is not None:
        hits.face[on_triangle] = forest.face[hits.face[on_triangle]]
    return hits
