"""Narrow phase of a step for meshes: the pairs at levels OCTREE and TRIANGLE, their contacts grouped for the solver."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box import obb
from drone_engine.collision.manifold import POINTS, Manifolds
from drone_engine.collision.mesh import octree, traversal
from drone_engine.collision.mesh.contacts import (
    DEEP_SEARCH_DEPTH,
    SEARCH_DEPTH,
    floor_contacts,
    leaf_contacts,
    triangle_contacts,
)
from drone_engine.collision.mesh.reduction import MOST, reduce
from drone_engine.collision.mesh.shape import Shape
from drone_engine.collision.placement import PlacedBodies
from drone_engine.collision_level import TRIANGLE
from drone_engine.geometry import mesh
from drone_engine.kernel import kernel
from drone_engine.model import Model

NO_CORNERS = octree.EMPTY.link, octree.EMPTY.corners, *np.empty((2, 0), np.int64)  # of a scene without meshes


class Raw(NamedTuple):
    """Contacts of one pair, and room to work in."""

    near: NDArray[np.int32]  # (m, 2) triangles or leaves
    normal: Floats  # (k, 3) unit, from a to b
    point: Floats  # (k, 2, 3) m, on a and on b
    separation: Floats  # (k,) m
    feature: Integers  # (k,)
    free: Booleans  # (k,)
    spread: Floats  # (k,)
    placed: Floats  # (2, 10, 3)
    spot: Floats  # (2, 3)
    turn: Floats  # (2, 3, 3)
    size: Floats  # (2, 3)
    work: obb.BoxScratch


def _raw(near: int, contacts: int) -> Raw:
    return Raw(np.empty((near, 2), np.int32), np.empty((contacts, 3)), np.empty((contacts, 2, 3)), np.empty(contacts),
               np.empty(contacts, np.int64), np.empty(contacts, np.bool_), np.empty(contacts), np.empty((2, 10, 3)),
               np.empty((2, 3)), np.empty((2, 3, 3)), np.empty((2, 3)), obb.scratch())


@kernel
def _overlap(separation, count):
    """Whether any of the contacts found is an overlap; so many that there is no room for them surely are."""
    for i in range(min(count, separation.shape[0])):
        if separation[i] < 0.0:
            return True
    return count > separation.shape[0]


@kernel
def _contacts(poses, position, axes, a, b, fine, margin, inside, tree, normals, owned, roots, spare, raw, rows, at):
    """Writes all contacts of bodies a and b to raw, of their triangles or (fine: False) leaves; returns how many of
    these come near, and how many contacts there are. rows: room for manifolds, number `at` of which is free."""
    near = traversal.traverse(tree, roots[a], poses[a], tree, roots[b], poses[b],
                              traversal.NEAR_TRIANGLES if fine else traversal.NEAR_LEAVES,
                              inside if fine else margin, spare, raw.near, 0)
    if near > raw.near.shape[0]:
        return near, 0
    if fine:
        return near, triangle_contacts(position, axes, a, b, raw.near, near, tree.corners, normals, owned, margin,
                                       inside, raw.placed, raw.normal, raw.point, raw.separation, raw.feature)
    points, normal, point, separation, feature = rows
    return near, leaf_contacts(position, axes, a, b, raw.near, near, tree.box, margin, raw.spot, raw.turn, raw.size,
                               raw.work, at, points, normal, point, separation, feature, raw.normal, raw.point,
                               raw.separation, raw.feature)


@kernel
def find_contacts(poses, position, axes, pair_a, pair_b, floor_height, level, everything, margins, tree, normals,
                  owned, roots, spare, raw, pair, points, normal, point, separation, feature, met, found):
    """Appends the manifolds of the pairs after the first `found`; returns how many there are, and how many pairs and
    contacts the raw buffers would have to hold if one of them was too small (0, 0 if not)."""
    rows = points, normal, point, separation, feature
    for k in range(pair_a.shape[0]):
        a, b = pair_a[k], pair_b[k]
        margin = margins[k]
        first = found
        if not np.isnan(floor_height[k]):
            body = b if roots[a] < 0 else a
            root = tree.link[roots[body]]
            count = floor_contacts(position, axes, body, floor_height[k], root[2], root[3], tree.corners, owned,
                                   margin, raw.normal, raw.point, raw.separation, raw.feature)
            if body == a:
                raw.normal[:count] *= -1.0
        else:
            fine = level[k] == TRIANGLE
            near, count = _contacts(poses, position, axes, a, b, fine, margin, max(margin, SEARCH_DEPTH), tree, normals,
                                    owned, roots, spare, raw, rows, found)
            if fine and 0 < near <= raw.near.shape[0] and not _overlap(raw.separation, count) and traversal.traverse(
                    tree, roots[a], poses[a], tree, roots[b], poses[b], traversal.ANY_TRIANGLES, 0.0, spare, raw.near,
                    0):
                # Surfaces that cut each other without a contact that shallow are in deeper than most ever are.
                near, count = _contacts(poses, position, axes, a, b, fine, margin, DEEP_SEARCH_DEPTH, tree, normals,
                                        owned, roots, spare, raw, rows, found)
            if near > raw.near.shape[0]:
                return found, near, 0
        if count > raw.separation.shape[0]:
            return found, 0, count
        most, most_points = (MOST, POINTS) if everything[k] else (1, 1)
        found += reduce(count, raw.normal, raw.point, raw.separation, raw.feature, most, most_points, raw.free,
                        raw.spread, normal[found:], point[found:], separation[found:], feature[found:], points[found:])
        for i in range(first, found):
            pair[i, 0], pair[i, 1], met[i] = a, b, level[k]
    return found, 0, 0


def read(model: Model, bodies: Integers) -> "Meshes":
    """The meshes of these bodies of a model, (k,), in the frames of their boxes' centres. Raises mesh.MeshError."""
    shapes: dict[tuple[Path, bytes], Shape] = {}
    which = np.full(model.bodies.count, -1)
    floors = [plane.body for plane in model.planes]
    for body in bodies:
        if body not in floors and model.bodies.solid[body]:
            path, centre = model.paths[body], model.bodies.center_b[body]
            if (path, centre.tobytes()) not in shapes:
                vertices, faces = mesh.surface(path)
                shapes[path, centre.tobytes()] = Shape.of(vertices - centre, faces)
            which[body] = list(shapes).index((path, centre.tobytes()))
    return Meshes(list(shapes.values()), which)


class Meshes:
    """The meshes of bodies, as a forest, with the buffers of the narrow phase."""

    def __init__(self, shapes: Sequence[Shape], which: Integers) -> None:
        """which: (n,) the shape of each body; -1: none."""
        self.tree, roots = octree.join([shape.tree for shape in shapes])
        self.roots: Integers = np.where(which >= 0, roots[which], -1)
        self._normals, self._owned = (np.concatenate(parts) for parts in
                                      zip(*(shape.topology for shape in shapes), strict=True))
        self._spare, self._raw = traversal.scratch(), _raw(1024, 256)

    @property
    def corners(self) -> tuple[NDArray[np.int32], Floats, Integers, Integers]:
        """What is needed to place a body's corners: the trees' links, corners, which are owned, and the roots."""
        return self.tree.link, self.tree.corners, self._owned, self.roots

    def find(self, manifolds: Manifolds, placed: PlacedBodies, pair_a: Integers, pair_b: Integers, floor_height: Floats,
             level: Integers, everything: Integers, margin: Floats) -> Manifolds:
        """Appends the contacts of the pairs; returns the manifolds, which grow where need be."""
        m = manifolds.reserve(MOST * len(pair_a))
        poses = np.concatenate([placed.position, placed.orientation], axis=1)
        while True:
            found, near, contacts = find_contacts(
                poses, placed.position, placed.axes, pair_a, pair_b, floor_height, level, everything, margin, self.tree,
                self._normals, self._owned, self.roots[placed.body], self._spare, self._raw, m.pair, m.points,
                m.normal_w, m.point_w, m.separation, m.feature, m.level, m.count)
            if not near and not contacts:
                break
            self._raw = _raw(max(2 * near, len(self._raw.near)), max(2 * contacts, len(self._raw.separation)))
        m.count = found
        return m
