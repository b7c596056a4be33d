"""Deepest contact of two models at many poses, in a batch, as the contact solver would get it."""

from functools import cache

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.collision import OBB, SPHERE, Shape
from drone_engine.collision.box import obb, sphere
from drone_engine.collision.manifold import Manifolds
from drone_engine.collision.mesh.contacts import Velocities
from drone_engine.collision.mesh.narrow import Meshes
from drone_engine.collision.mesh.shape import axes_at
from drone_engine.collision.placement import PlacedBodies


def deepest_contacts(a: Shape, poses_a: Floats, b: Shape, poses_b: Floats, level: int) -> tuple[Floats, Floats]:
    """Depths (n,) in m, NaN without contact, and unit normals (n, 3) from a to b, for poses (n, 7).

    level: collision level, one of TESTED.
    """
    n = len(poses_a)
    if level == SPHERE:
        hit, normal, _, separation = sphere.contacts(*a.bounding_spheres(poses_a), *b.bounding_spheres(poses_b))
        return np.where(hit, -separation, np.nan), normal
    if level == OBB:
        found = obb.contacts(*a.bounding_boxes(poses_a), *b.bounding_boxes(poses_b))
        depth, normal = np.full(n, np.nan), np.zeros((n, 3))
        normal[found.number] = found.normal
        depth[found.number] = np.maximum.reduceat(-found.separation, found.first[:-1]) if len(found.number) else 0.0
        return depth, normal
    poses = np.stack([poses_a, poses_b], axis=1).reshape(-1, 7)
    placed = PlacedBodies(np.tile(np.arange(2), n), poses[:, :3].copy(), poses[:, 3:].copy(), axes_at(poses),
                    np.zeros((2 * n, 3)))
    one = np.ones(n, np.int64)
    at_rest = Velocities(np.zeros((2 * n, 3)), np.zeros((2 * n, 3)), 0.0)
    m = _meshes(a, b).find(Manifolds(8), placed, at_rest, 2 * np.arange(n), 2 * np.arange(n) + 1, np.full(n, np.nan),
                           level * one, one, np.zeros(n))
    # The first point of a pair's first manifold is its deepest.
    row, first = np.unique(m.pair[:m.count, 0] // 2, return_index=True)
    depth, normal = np.full(n, np.nan), np.zeros((n, 3))
    depth[row], normal[row] = -m.separation[first, 0], m.normal_w[first]
    return depth, normal


@cache
def _meshes(a: Shape, b: Shape) -> Meshes:
    return Meshes([a, b], np.arange(2))
