"""The stage that finds what stands on uneven ground: its contacts become few manifolds, in the compiled loop."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box import plane
from drone_engine.collision.manifold import GROUND, MESHES, OTHERS, POINTS, SAME_SIDE, SWEPT, write_anchors
from drone_engine.collision.mesh.reduction import pick
from drone_engine.collision.terrain.contacts import meet_box, meet_corner, meet_mesh
from drone_engine.collision.terrain.height_field import Terrain, lies_under
from drone_engine.collision_level import OBB, SPHERE
from drone_engine.kernel import kernel

MORE_CONTACTS, MORE_MANIFOLDS = 1, 2
MOST = 6  # manifolds of a pair
SAME = 1e-4  # m; points this close are one
DEPTH_WORTH = 30.0  # how many m of distance from other points one m of depth is worth: hulls rest on what touches
TOUCHING = 1e-4  # m; points farther off tell less and less of the normal that is a group's


@kernel
def group(count, normal, point, separation, feature, most, free, spread, points, out_normal, out_point, out_separation,
          out_feature, made):
    """Appends up to `most` manifolds of the first `count` contacts after the first `made`, each of what has nearly the
    same normal, which becomes the mean of what touches; returns how many manifolds there are. Contacts keep their
    order, so that at rest nothing changes from step to step. free, spread: (k,) scratch."""
    free[:count] = True
    for _ in range(most):
        seed = 0
        while seed < count and not free[seed]:
            seed += 1
        if seed == count:
            break
        x = y = z = 0.0
        members = 0
        for i in range(count):
            spread[i] = -1e300
            if free[i] and (normal[i, 0] * normal[seed, 0] + normal[i, 1] * normal[seed, 1]
                            + normal[i, 2] * normal[seed, 2]) >= SAME_SIDE:
                free[i], spread[i] = False, 1e300
                members += 1
                worth = TOUCHING / (TOUCHING + max(separation[i], 0.0))
                x, y, z = (x + worth * worth * normal[i, 0], y + worth * worth * normal[i, 1],
                           z + worth * worth * normal[i, 2])
        length = math.sqrt(x * x + y * y + z * z)
        x, y, z = x / length, y / length, z / length
        out_normal[made, 0], out_normal[made, 1], out_normal[made, 2] = x, y, z
        if members <= POINTS:
            points[made] = _copy(count, point, separation, feature, spread, out_point[made], out_separation[made],
                                 out_feature[made])
        else:
            start = -1
            for i in range(count):
                if spread[i] > 0.0 and (start < 0 or separation[i] < separation[start]):
                    start = i
            points[made] = pick(count, point, separation, feature, POINTS, start, spread, DEPTH_WORTH, out_point[made],
                                out_separation[made], out_feature[made])
        made += 1
    return made


@kernel
def _copy(count, point, separation, feature, spread, out_point, out_separation, out_feature):
    """Writes the contacts of one group, of those at one place the first."""
    made = 0
    for i in range(count):
        if spread[i] < 0.0:
            continue
        known = False
        for k in range(made):
            square = 0.0
            for c in range(3):
                square += (0.5 * (point[i, 0, c] + point[i, 1, c]) - out_point[k, c]) ** 2
            known = known or square < SAME * SAME
        if not known:
            for c in range(3):
                out_point[made, c] = 0.5 * (point[i, 0, c] + point[i, 1, c])
            out_separation[made], out_feature[made] = separation[i], feature[i]
            made += 1
    return made


@kernel
def stand(counts, position, body_bounds, grid_tables, pairs, ground, contacts):
    """Appends the manifolds of the terrain and the bodies on it. Where the terrain below a body is one horizontal
    plane, contacts are those of a plane. ground: GroundArrays. Returns 0, MORE_CONTACTS or MORE_MANIFOLDS."""
    axes, half, low, high = body_bounds.axes, body_bounds.half, body_bounds.low, body_bounds.high
    ordered, level, margins = grid_tables.ordered, pairs.level, pairs.margin
    land = ground.terrain
    frame, start, entry, face = land.frame, land.start, land.entry, land.face
    flat, top, ridge_start, ridge_entry = land.flat, land.top, land.ridge_start, land.ridge_entry
    raw_normal, raw_point, raw_separation = ground.raw_normal, ground.raw_point, ground.raw_separation
    raw_feature = ground.raw_feature
    pair, points, normal, point, met = contacts.pair, contacts.points, contacts.normal, contacts.point, contacts.level
    separation, feature, end = contacts.separation, contacts.feature, contacts.end
    found = end[OTHERS]
    for k in range(counts.pairs[0]):
        a, b = ordered[0, k], ordered[1, k]
        if (a != ground.body and b != ground.body) or level[k] < SPHERE:
            continue
        if found + MOST > points.shape[0]:
            return MORE_MANIFOLDS
        body, up = (b, 1.0) if a == ground.body else (a, -1.0)
        height, most = lies_under(frame, flat, top, low[body, 0], low[body, 1], high[body, 0], high[body, 1])
        if low[body, 2] > most:
            continue
        margin, first = margins[k], found
        if not np.isnan(height) and level[k] <= OBB:
            p, s, f = point[found], separation[found], feature[found]
            if level[k] == SPHERE:
                points[found] = plane.contact_sphere(position, half, body, height, margin, p, s, f)
            else:
                points[found] = plane.contact(position, axes, half, body, height, margin, p, s, f)
            normal[found, 0], normal[found, 1], normal[found, 2] = 0.0, 0.0, 1.0
            found += points[found] > 0
        else:
            if level[k] == SPHERE:
                ball = math.sqrt(half[body, 0] ** 2 + half[body, 1] ** 2 + half[body, 2] ** 2)
                count = meet_corner(frame, start, entry, face, position[body, 0], position[body, 1], position[body, 2],
                                    ball, 0, margin, raw_normal, raw_point, raw_separation, raw_feature, 0)
            elif level[k] == OBB:
                count = meet_box(frame, start, entry, face, ridge_start, ridge_entry, land.ridge, land.ridge_cell,
                                 position, axes, half, body, low, high, margin, raw_normal, raw_point, raw_separation,
                                 raw_feature, 0)
            else:
                root = ground.link[ground.roots[body]]
                count = meet_mesh(frame, start, entry, face, position, axes, body, ground.corners, ground.owned,
                                  root[2], root[3], margin, raw_normal, raw_point, raw_separation, raw_feature, 0)
            if count > raw_separation.shape[0]:
                return MORE_CONTACTS
            found = group(count, raw_normal, raw_point, raw_separation, raw_feature, MOST, ground.free, ground.spread,
                          points, normal, point, separation, feature, found)
        if not pairs.all_contacts[k] and found > first:
            found = _keep_deepest(first, found, points, normal, point, separation, feature)
        for i in range(first, found):
            pair[i, 0], pair[i, 1], met[i] = a, b, level[k]
            for c in range(3):
                normal[i, c] *= up
    write_anchors(end[OTHERS], found, pair, points, point, position, contacts.anchor)
    end[GROUND] = end[MESHES] = end[SWEPT] = found
    return 0


@kernel
def _keep_deepest(first, found, points, normal, point, separation, feature):
    """Leaves the deepest point of manifolds `first` on alone; returns how many there are then."""
    best, at = first, 0
    for i in range(first, found):
        for k in range(points[i]):
            if separation[i, k] < separation[best, at]:
                best, at = i, k
    points[first] = 1
    separation[first, 0], feature[first, 0] = separation[best, at], feature[best, at]
    for c in range(3):
        normal[first, c], point[first, 0, c] = normal[best, c], point[best, at, c]
    return first + 1


class GroundArrays(NamedTuple):
    """The terrain of a scene, and the room that its contacts need."""

    body: int
    terrain: Terrain
    link: NDArray[np.int32]  # of the octrees of meshes, whose corners may touch the terrain
    corners: Floats
    owned: Integers
    roots: Integers  # (n,) of each body's octree
    raw_normal: Floats  # (k, 3) contacts before they are grouped into manifolds
    raw_point: Floats  # (k, 2, 3)
    raw_separation: Floats  # (k,)
    raw_feature: Integers  # (k,)
    free: Booleans  # (k,) scratch
    spread: Floats  # (k,) scratch


class Footing:
    """The ground of a scene, with the room that its contacts need."""

    def __init__(self, terrain: Terrain, body: int) -> None:
        self.terrain, self.body = terrain, body
        self._make_room(256)

    def _make_room(self, contacts: int) -> None:
        self._raw: tuple[Any, ...] = (np.empty((contacts, 3)), np.empty((contacts, 2, 3)), np.empty(contacts),
                                      np.empty(contacts, np.int64), np.empty(contacts, np.bool_), np.empty(contacts))

    def grow(self) -> None:
        """Makes twice as much room."""
        self._make_room(2 * len(self._raw[0]))

    def arrays(self, meshes: tuple[Any, Floats, Integers, Integers]) -> GroundArrays:
        """As `stand` takes them; meshes: link, corners, owned and roots."""
        return GroundArrays(self.body, self.terrain, *meshes, *self._raw)
