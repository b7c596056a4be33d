"""Narrow phase for meshes: the pairs at levels octree and triangle, their contacts reduced to manifolds."""

import math
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
    Velocities,
    leaf_contacts,
    mesh_radius,
    pair_scratch,
    plane_contacts,
    set_pair,
    triangle_contacts,
)
from drone_engine.collision.mesh.features import MeshFeatures
from drone_engine.collision.mesh.overlap import overlap_contacts
from drone_engine.collision.mesh.shape import Shape
from drone_engine.collision.mesh.topology import MeshCorners, Topology
from drone_engine.collision.mesh.transforms import axes_rotation
from drone_engine.collision.mesh.traversal import ANY_TRIANGLES, NEAR_LEAVES, NEAR_TRIANGLES, TRIANGLES, traverse
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
def _pair_contacts(placed, poses, velocities, a, b, fine, margin, inside, meshes, work, manifolds, at):
    """Writes all contacts of bodies a and b to work.found, of their triangles or (fine: False) of their leaves; returns
    the number of near pairs of these and the number of contacts. manifolds, at: as for `leaf_contacts`."""
    query, distance = (NEAR_TRIANGLES, max(margin, inside)) if fine else (NEAR_LEAVES, margin)
    near = _traverse(poses, a, b, query, distance, meshes, work)
    if near > work.near.shape[0]:
        return near, 0
    if fine:
        set_pair(placed, velocities, a, b, margin, inside, meshes, work.pair)
        return near, triangle_contacts(placed.position, placed.axes, a, b, near, meshes, work)
    return near, leaf_contacts(placed.position, placed.axes, a, b, near, meshes, margin, work, manifolds, at)


@allocating
def _traverse(poses, a, b, query, margin, meshes, work):
    """The number of results of a query for bodies a and b, which are written to work.near."""
    tree, roots = meshes.tree, meshes.roots
    return traverse(tree, roots[a], poses[a], tree, roots[b], poses[b], query, margin, work.traversal, work.near, 0)


@allocating
def _mesh_contacts(placed, poses, velocities, a, b, fine, margin, meshes, work, manifolds, at):
    """As `_pair_contacts`, also for surfaces in deep penetration."""
    if fine and not velocities.at_impact:
        margin += _rotation_reach(velocities, a, b, meshes)
    near, count = _pair_contacts(placed, poses, velocities, a, b, fine, margin, SEARCH_DEPTH, meshes, work, manifolds,
                                 at)
    if not fine or not 0 < near <= work.near.shape[0] or _any_overlap(work.found.separation, count):
        return near, count
    if not _traverse(poses, a, b, ANY_TRIANGLES, 0.0, meshes, work):
        return near, count
    near, count = _pair_contacts(placed, poses, velocities, a, b, fine, margin, DEEP_SEARCH_DEPTH, meshes, work,
                                 manifolds, at)
    if near > work.near.shape[0] or _any_overlap(work.found.separation, count):
        return near, count
    near = min(_traverse(poses, a, b, TRIANGLES, 0.0, meshes, work), work.near.shape[0])
    return near, overlap_contacts(near, work.near, axes_rotation(placed.axes, a), axes_rotation(placed.axes, b),
                                  meshes.tree, meshes.features, work.pair.motion, work.overlap, work.found)


@kernel
def _rotation_reach(velocities, a, b, meshes):
    """How far rotation may bring the meshes of bodies a and b together within the time of `velocities`, m."""
    total = 0.0
    for side in range(2):
        i = a if side == 0 else b
        w = velocities.angular[i]
        turn = velocities.dt * math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
        total += min(turn, 1.0) * mesh_radius(i, meshes)
    return total


@allocating
def find_mesh_contacts(placed, poses, velocities, pair_a, pair_b, floor_height, level, all_contacts, margins, meshes,
                       work, manifolds, found):
    """Appends the manifolds of the pairs after the first `found` of `manifolds` (ContactArrays).

    placed: PlacedBodies of n bodies, with poses (n, 7) and Velocities. pair_a, pair_b: (k,) bodies; floor_height: (k,)
    m, of pairs with a plane, else NaN; level: (k,) OCTREE or TRIANGLE; all_contacts: (k,) 0: only the deepest point;
    margins: (k,) m. meshes: MeshArrays; work: PairScratch. Returns the number of manifolds and, if a buffer of `work`
    is too small for a pair, the numbers of near pairs and of contacts that it needs, else 0, 0.
    """
    buffer = work.found
    for k in range(pair_a.shape[0]):
        a, b = pair_a[k], pair_b[k]
        first = found
        if not np.isnan(floor_height[k]):
            body = b if meshes.roots[a] < 0 else a
            count = plane_contacts(placed.position, placed.axes, body, floor_height[k], meshes, margins[k], work)
            if body == a:
                buffer.normal[:count] *= -1.0
        else:
            near, count = _mesh_contacts(placed, poses, velocities, a, b, level[k] == TRIANGLE, margins[k], meshes,
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


def _join_features(topologies: Sequence[Topology]) -> MeshFeatures:
    """The topology of a forest of meshes from that of each."""
    rows = np.cumsum([0, *(len(topology.ring) for topology in topologies)])
    ring_range = [topology.ring_range + np.int32(row) for topology, row in zip(topologies, rows, strict=False)]
    normals, owned, _, ring = (np.concatenate(parts) for parts in zip(*topologies, strict=True))
    return MeshFeatures(normals, owned, np.concatenate(ring_range), ring)


class Meshes:
    """The meshes of bodies, as a forest of octrees, with the buffers of the narrow phase."""

    def __init__(self, shapes: Sequence[Shape], which: Integers) -> None:
        """which: (n,) index of each body's shape, -1: none."""
        self.tree, roots = octree.join([shape.tree for shape in shapes])
        self.roots: Integers = np.where(which >= 0, roots[which], -1)
        self._features = _join_features([shape.topology for shape in shapes])
        self._work = pair_scratch(1024, 256)

    @property
    def corners(self) -> MeshCorners:
        """The corners of the bodies' meshes."""
        return MeshCorners(self.tree.link, self.tree.corners, self._features.owned, self.roots)

    def find(self, manifolds: Manifolds, placed: PlacedBodies, velocities: Velocities, pair_a: Integers,
             pair_b: Integers, floor_height: Floats, level: Integers, all_contacts: Integers,
             margin: Floats) -> Manifolds:
        """Appends the contacts of the pairs and returns the manifolds, which grow if needed.

        velocities: of the bodies placed; pair_a, pair_b: (k,) rows of `placed`; floor_height, level, all_contacts,
        margin: (k,) as for `find_mesh_contacts`.
        """
        m = manifolds.reserve(MAX_MANIFOLDS * len(pair_a))
        meshes = MeshArrays(self.tree, self._features, self.roots[placed.body])
        poses = np.concatenate([placed.position, placed.orientation], axis=1)
        while True:
            found, near, contacts = find_mesh_contacts(
                placed, poses, velocities, pair_a, pair_b, floor_height, level, all_contacts, margin, meshes,
                self._work, m.arrays, m.count)
            if not near and not contacts:
                break
            self._work = pair_scratch(max(2 * near, len(self._work.near)), max(2 * contacts, len(self._work.spread)))
        m.count = found
        return m
