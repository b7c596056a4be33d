"""Narrow phase for meshes: the pairs at levels octree and triangle, their contacts reduced to manifolds."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.manifold import POINTS, Manifolds
from drone_engine.collision.mesh import octree
from drone_engine.collision.mesh.contact_reduction import MAX_MANIFOLDS, reduce_contacts
from drone_engine.collision.mesh.contacts import (
    DEEP_SEARCH_DEPTH,
    SEARCH_DEPTH,
    MeshArrays,
    leaf_contacts,
    pair_scratch,
    plane_contacts,
    triangle_contacts,
)
from drone_engine.collision.mesh.shape import Shape
from drone_engine.collision.mesh.topology import MeshCorners
from drone_engine.collision.mesh.traversal import ANY_TRIANGLES, NEAR_LEAVES, NEAR_TRIANGLES, traverse
from drone_engine.collision.placement import PlacedBodies
from drone_engine.collision_level import TRIANGLE
from drone_engine.geometry import mesh
from drone_engine.kernel import allocating, kernel
from drone_engine.model import Model

NO_CORNERS = MeshCorners(octree.EMPTY.link, octree.EMPTY.corners, *np.empty((2, 0), np.int64))  # without meshes


@kernel
def _any_overlap(separation, count):
    """Whether any of `count` contacts is a penetration; contacts that do not fit count as one."""
    for i in range(min(count, separation.shape[0])):
        if separation[i] < 0.0:
            return True
    return count > separation.shape[0]


@allocating
def _pair_contacts(poses, position, axes, a, b, fine, margin, inside, meshes, work, manifolds, at):
    """Writes all contacts of bodies a and b to work.found, of their triangles or (fine: False) of their leaves; returns
    the number of near pairs of these and the number of contacts. manifolds, at: as for `leaf_contacts`."""
    near = traverse(meshes.tree, meshes.roots[a], poses[a], meshes.tree, meshes.roots[b], poses[b],
                    NEAR_TRIANGLES if fine else NEAR_LEAVES, inside if fine else margin, work.traversal, work.near, 0)
    if near > work.near.shape[0]:
        return near, 0
    if fine:
        return near, triangle_contacts(position, axes, a, b, near, meshes, margin, inside, work)
    return near, leaf_contacts(position, axes, a, b, near, meshes, margin, work, manifolds, at)


@allocating
def find_mesh_contacts(poses, position, axes, pair_a, pair_b, floor_height, level, all_contacts, margins, meshes, work,
                       manifolds, found):
    """Appends the manifolds of the pairs after the first `found` of `manifolds` (ContactArrays).

    poses: (n, 7); position: (n, 3) m; axes: (n, 3, 3), one a row; world frame. pair_a, pair_b: (k,) bodies;
    floor_height: (k,) m, of pairs with a plane, else NaN; level: (k,) OCTREE or TRIANGLE; all_contacts: (k,) 0: only
    the deepest point; margins: (k,) m. meshes: MeshArrays; work: PairScratch. Returns the number of manifolds and, if a
    buffer of `work` is too small for a pair, the numbers of near pairs and of contacts that it needs, else 0, 0.
    """
    buffer = work.found
    for k in range(pair_a.shape[0]):
        a, b = pair_a[k], pair_b[k]
        margin = margins[k]
        first = found
        if not np.isnan(floor_height[k]):
            body = b if meshes.roots[a] < 0 else a
            count = plane_contacts(position, axes, body, floor_height[k], meshes, margin, work)
            if body == a:
                buffer.normal[:count] *= -1.0
        else:
            fine = level[k] == TRIANGLE
            near, count = _pair_contacts(poses, position, axes, a, b, fine, margin, max(margin, SEARCH_DEPTH), meshes,
                                         work, manifolds, found)
            if fine and 0 < near <= work.near.shape[0] and not _any_overlap(buffer.separation, count) and traverse(
                    meshes.tree, meshes.roots[a], poses[a], meshes.tree, meshes.roots[b], poses[b], ANY_TRIANGLES, 0.0,
                    work.traversal, work.near, 0):
                # Surfaces that intersect without a contact within the search depth are in deeper penetration.
                near, count = _pair_contacts(poses, position, axes, a, b, fine, margin, DEEP_SEARCH_DEPTH, meshes,
                                             work, manifolds, found)
            if near > work.near.shape[0]:
                return found, near, 0
        if count > buffer.separation.shape[0]:
            return found, 0, count
        max_manifolds, max_points = (MAX_MANIFOLDS, POINTS) if all_contacts[k] else (1, 1)
        found += reduce_contacts(count, buffer, max_manifolds, max_points, work.unassigned, work.spread, manifolds,
                                 found)
        for i in range(first, found):
            manifolds.pair[i, 0], manifolds.pair[i, 1], manifolds.level[i] = a, b, level[k]
    return found, 0, 0


def load_meshes(model: Model, bodies: Integers) -> "Meshes":
    """The meshes of bodies (k,) of a model, in the frames of their boxes' centers; planes and bodies that are not solid
    get none. Raises mesh.MeshError for a file that cannot be read."""
    shapes: dict[tuple[Path, bytes], Shape] = {}
    which = np.full(model.bodies.count, -1)
    planes = [plane.body for plane in model.planes]
    for body in bodies:
        if body not in planes and model.bodies.solid[body]:
            path, center = model.paths[body], model.bodies.center_b[body]
            if (path, center.tobytes()) not in shapes:
                vertices, faces = mesh.surface(path)
                shapes[path, center.tobytes()] = Shape.of(vertices - center, faces)
            which[body] = list(shapes).index((path, center.tobytes()))
    return Meshes(list(shapes.values()), which)


class Meshes:
    """The meshes of bodies, as a forest of octrees, with the buffers of the narrow phase."""

    def __init__(self, shapes: Sequence[Shape], which: Integers) -> None:
        """which: (n,) index of each body's shape, -1: none."""
        self.tree, roots = octree.join([shape.tree for shape in shapes])
        self.roots: Integers = np.where(which >= 0, roots[which], -1)
        self._normals, self._owned = (np.concatenate(parts) for parts in
                                      zip(*(shape.topology for shape in shapes), strict=True))
        self._work = pair_scratch(1024, 256)

    @property
    def corners(self) -> MeshCorners:
        """The corners of the bodies' meshes."""
        return MeshCorners(self.tree.link, self.tree.corners, self._owned, self.roots)

    def find(self, manifolds: Manifolds, placed: PlacedBodies, pair_a: Integers, pair_b: Integers, floor_height: Floats,
             level: Integers, all_contacts: Integers, margin: Floats) -> Manifolds:
        """Appends the contacts of the pairs and returns the manifolds, which grow if needed.

        pair_a, pair_b: (k,) rows of `placed`; floor_height, level, all_contacts, margin: (k,) as for
        `find_mesh_contacts`.
        """
        m = manifolds.reserve(MAX_MANIFOLDS * len(pair_a))
        meshes = MeshArrays(self.tree, self._normals, self._owned, self.roots[placed.body])
        poses = np.concatenate([placed.position, placed.orientation], axis=1)
        while True:
            found, near, contacts = find_mesh_contacts(
                poses, placed.position, placed.axes, pair_a, pair_b, floor_height, level, all_contacts, margin, meshes,
                self._work, m.arrays, m.count)
            if not near and not contacts:
                break
            self._work = pair_scratch(max(2 * near, len(self._work.near)), max(2 * contacts, len(self._work.spread)))
        m.count = found
        return m
