"""The stage that finds the contacts of bodies with terrain and reduces them to manifolds."""

import math
from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.box import plane
from drone_engine.collision.manifold import GROUND, MESHES, OTHERS, POINTS, SAME_SIDE, SWEPT, write_anchors
from drone_engine.collision.mesh.contact_buffer import ContactBuffer, contact_buffer
from drone_engine.collision.mesh.contact_reduction import SAME_POINT_DISTANCE, select_points
from drone_engine.collision.mesh.topology import MeshCorners
from drone_engine.collision.terrain.contacts import box_contacts, mesh_contacts, point_contacts
from drone_engine.collision.terrain.height_field import HeightField, rectangle_heights
from drone_engine.collision_level import OBB, SPHERE
from drone_engine.kernel import kernel

MORE_CONTACTS, MORE_MANIFOLDS = 1, 2  # return codes of `terrain_contacts`
MAX_MANIFOLDS = 6  # of a pair
DEPTH_WEIGHT = 30.0  # distance from the other points, m, that counts as much as 1 m of depth: hulls rest on the points
# that touch
TOUCHING_DISTANCE = 1e-4  # m; farther points have less and less weight in the normal of their group


class TerrainArrays(NamedTuple):
    """The terrain of a scene, and the buffers of its contacts, as `terrain_contacts` takes them."""

    body: int
    field: HeightField
    meshes: MeshCorners
    found: ContactBuffer  # contacts of one body before they are grouped into manifolds
    unassigned: Booleans  # (k,) scratch
    spread: Floats  # (k,) scratch


@kernel
def _group_contacts(count, found, unassigned, spread, out, made):
    """Appends at most MAX_MANIFOLDS manifolds of the first `count` contacts of the ContactBuffer `found` to the first
    `made` of `out` (ContactArrays); returns the new number.

    Contacts with nearly the same normal form a group; its normal is their mean, mostly of those that touch. Contacts
    keep their order, so that manifolds of bodies at rest do not change from step to step. unassigned, spread: (k,)
    scratch.
    """
    normal, separation = found.normal, found.separation
    unassigned[:count] = True
    for _ in range(MAX_MANIFOLDS):
        seed = 0
        while seed < count and not unassigned[seed]:
            seed += 1
        if seed == count:
            break
        x = y = z = 0.0
        members = 0
        for i in range(count):
            spread[i] = -1e300
            if unassigned[i] and (normal[i, 0] * normal[seed, 0] + normal[i, 1] * normal[seed, 1]
                                  + normal[i, 2] * normal[seed, 2]) >= SAME_SIDE:
                unassigned[i], spread[i] = False, 1e300
                members += 1
                weight = TOUCHING_DISTANCE / (TOUCHING_DISTANCE + max(separation[i], 0.0))
                x, y, z = (x + weight * weight * normal[i, 0], y + weight * weight * normal[i, 1],
                           z + weight * weight * normal[i, 2])
        length = math.sqrt(x * x + y * y + z * z)
        x, y, z = x / length, y / length, z / length
        out.normal[made, 0], out.normal[made, 1], out.normal[made, 2] = x, y, z
        if members <= POINTS:
            out.points[made] = _copy_points(count, found, spread, out, made)
        else:
            start = -1
            for i in range(count):
                if spread[i] > 0.0 and (start < 0 or separation[i] < separation[start]):
                    start = i
            out.points[made] = select_points(count, found, POINTS, start, spread, DEPTH_WEIGHT, out, made)
        made += 1
    return made


@kernel
def _copy_points(count, found, spread, out, row):
    """Writes the contacts of one group, those with spread >= 0, to manifold `row` of `out`, of those closer than
    SAME_POINT_DISTANCE the first; returns their number."""
    point, separation, feature = found.point, found.separation, found.feature
    out_point = out.point[row]
    made = 0
    for i in range(count):
        if spread[i] < 0.0:
            continue
        known = False
        for k in range(made):
            square = 0.0
            for c in range(3):
                square += (0.5 * (point[i, 0, c] + point[i, 1, c]) - out_point[k, c]) ** 2
            known = known or square < SAME_POINT_DISTANCE * SAME_POINT_DISTANCE
        if not known:
            for c in range(3):
                out_point[made, c] = 0.5 * (point[i, 0, c] + point[i, 1, c])
            out.separation[row, made], out.feature[row, made] = separation[i], feature[i]
            made += 1
    return made


@kernel
def terrain_contacts(counts, position, body_bounds, grid_tables, pairs, terrain, contacts):
    """Appends the manifolds of the terrain and the bodies on it. Where the ground below a body is one horizontal plane,
    they are those of a plane.

    terrain: TerrainArrays; contacts: ContactArrays. Returns 0, or MORE_CONTACTS or MORE_MANIFOLDS if there is no room.
    """
    axes, half, low, high = body_bounds.axes, body_bounds.half, body_bounds.low, body_bounds.high
    ordered, level, margins = grid_tables.ordered, pairs.level, pairs.margin
    field, buffer = terrain.field, terrain.found
    pair, points, normal, point = contacts.pair, contacts.points, contacts.normal, contacts.point
    separation, feature, end = contacts.separation, contacts.feature, contacts.end
    found = end[OTHERS]
    for k in range(counts.pairs[0]):
        a, b = ordered[0, k], ordered[1, k]
        if (a != terrain.body and b != terrain.body) or level[k] < SPHERE:
            continue
        if found + MAX_MANIFOLDS > points.shape[0]:
            return MORE_MANIFOLDS
        body, up = (b, 1.0) if a == terrain.body else (a, -1.0)
        height, top = rectangle_heights(field, low[body, 0], low[body, 1], high[body, 0], high[body, 1])
        if low[body, 2] > top:
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
                radius = math.sqrt(half[body, 0] ** 2 + half[body, 1] ** 2 + half[body, 2] ** 2)
                count = point_contacts(field, position[body, 0], position[body, 1], position[body, 2], radius, 0,
                                       margin, buffer, 0)
            elif level[k] == OBB:
                count = box_contacts(field, position, axes, half, body, low, high, margin, buffer, 0)
            else:
                count = mesh_contacts(field, position, axes, body, terrain.meshes, margin, buffer, 0)
            if count > buffer.separation.shape[0]:
                return MORE_CONTACTS
            found = _group_contacts(count, buffer, terrain.unassigned, terrain.spread, contacts, found)
        if not pairs.all_contacts[k] and found > first:
            found = _keep_deepest(first, found, contacts)
        for i in range(first, found):
            pair[i, 0], pair[i, 1], contacts.level[i] = a, b, level[k]
            for c in range(3):
                normal[i, c] *= up
    write_anchors(end[OTHERS], found, pair, points, point, position, contacts.anchor)
    end[GROUND] = end[MESHES] = end[SWEPT] = found
    return 0


@kernel
def _keep_deepest(first, found, contacts):
    """Reduces manifolds `first` to `found` of ContactArrays to one with their deepest point; returns the new number of
    manifolds."""
    points, normal, point = contacts.points, contacts.normal, contacts.point
    separation, feature = contacts.separation, contacts.feature
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


class Terrain:
    """The terrain of a scene, with the buffers of its contacts."""

    def __init__(self, field: HeightField, body: int) -> None:
        """body: index of the terrain in the scene."""
        self.field, self.body = field, body
        self._allocate(256)

    def _allocate(self, contacts: int) -> None:
        """Makes room for so many contacts of one body."""
        self._found = contact_buffer(contacts)
        self._unassigned, self._spread = np.empty(contacts, np.bool_), np.empty(contacts)

    def grow(self) -> None:
        """Doubles the room for contacts."""
        self._allocate(2 * len(self._spread))

    def arrays(self, meshes: MeshCorners) -> TerrainArrays:
        """The arguments of `terrain_contacts`; meshes: those that may touch the terrain."""
        return TerrainArrays(self.body, self.field, meshes, self._found, self._unassigned, self._spread)
