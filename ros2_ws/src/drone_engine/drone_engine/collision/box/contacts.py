"""Narrow phase of a step for what is not a mesh: boxes, spheres and floors, pair by pair."""

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.box import box as obb
from drone_engine.collision.box import plane as floor
from drone_engine.collision.box import sphere
from drone_engine.collision.box.clipping import CUT, cross_edges, cut_faces
from drone_engine.collision.box.sat import BLOCK, TABLE, WIDEST, rank
from drone_engine.collision.box.sat import MARGIN as MARGINS
from drone_engine.collision_level import OBB, SPHERE
from drone_engine.kernel import kernel


def scratch() -> tuple[Floats | Integers, ...]:
    """What `find_boxes` works in."""
    return (np.zeros(TABLE), np.empty(CUT), *np.empty((3, BLOCK), np.int64))


@kernel
def keep_deepest(point, separation, feature, count):
    """Makes the deepest of the points the first."""
    best = 0
    for k in range(1, count):
        if separation[k] < separation[best]:
            best = k
    separation[0], feature[0] = separation[best], feature[best]
    for c in range(3):
        point[0, c] = point[best, c]


@kernel
def find_boxes(count, position, axes, half, pair_a, pair_b, floor_height, level, everything, margins, table, cut, of_a,
               of_b, number, pair, points, normal, point, separation, feature, met, found):
    """Appends the manifolds of those of the first `count` pairs that are boxes at level OBB after the first `found`;
    returns how many there are then. of_a, of_b, number: (BLOCK,) scratch. Pairs are ranked a block at a time."""
    k = 0
    while k < count:
        size = 0
        while k < count and size < BLOCK:
            if level[k] == OBB and np.isnan(floor_height[k]):
                of_a[size], of_b[size], number[size] = pair_a[k], pair_b[k], k
                size += 1
            k += 1
        obb.enter(table, size, position, axes, half, of_a, position, axes, half, of_b)
        rank(table, size)
        first = found
        for m in range(size):
            table[MARGINS + m] = margins[number[m]]
            near = table[WIDEST + m] <= table[MARGINS + m]
            pair[found, 0], pair[found, 1], met[found] = of_a[m], of_b[m], OBB
            of_a[m] = number[m]
            number[m] = found if near else -1
            found += near
        cross_edges(table, size, number, points, normal, point, separation, feature)
        cut_faces(table, size, number, points, normal, point, separation, feature, cut)
        found = first
        for m in range(size):  # some that are near have no point within the margin
            i = number[m]
            if i < 0 or points[i] == 0:
                continue
            if not everything[of_a[m]]:
                keep_deepest(point[i], separation[i], feature[i], points[i])
                points[i] = 1
            if i != found:
                move(i, found, pair, points, normal, point, separation, feature, met)
            found += 1
    return found


@kernel
def move(i, j, pair, points, normal, point, separation, feature, met):
    """Moves manifold i to the place of manifold j."""
    pair[j, 0], pair[j, 1], points[j], met[j] = pair[i, 0], pair[i, 1], points[i], met[i]
    for c in range(3):
        normal[j, c] = normal[i, c]
    for k in range(points[i]):
        separation[j, k], feature[j, k] = separation[i, k], feature[i, k]
        for c in range(3):
            point[j, k, c] = point[i, k, c]


@kernel
def find_others(count, position, axes, half, pair_a, pair_b, floor_height, level, everything, margins, pair, points,
                normal, point, separation, feature, met, found):
    """Appends the manifolds of those of the first `count` pairs that are spheres, or a floor and a sphere or box, after
    the first `found`; returns how many there are then."""
    for k in range(count):
        on_floor = not np.isnan(floor_height[k])
        if level[k] != SPHERE and not (level[k] == OBB and on_floor):
            continue
        a, b = pair_a[k], pair_b[k]
        margin = margins[k]
        n, p, s, f = normal[found], point[found], separation[found], feature[found]
        if on_floor:
            body, up = (b, 1.0) if half[a, 0] == np.inf else (a, -1.0)
            n[0], n[1], n[2] = 0.0, 0.0, up
            if level[k] == SPHERE:
                points[found] = floor.contact_sphere(position, half, body, floor_height[k], margin, p, s, f)
            else:
                points[found] = floor.contact(position, axes, half, body, floor_height[k], margin, p, s, f)
        else:
            points[found] = sphere.contact(position, half, a, b, margin, n, p, s, f)
        if points[found]:
            if not everything[k]:
                keep_deepest(p, s, f, points[found])
                points[found] = 1
            pair[found, 0], pair[found, 1], met[found] = a, b, level[k]
            found += 1
    return found
