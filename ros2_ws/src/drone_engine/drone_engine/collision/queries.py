"""Collision queries of two meshes at given poses, without a scene.

    drone, ring = Shape.load("drone.obj"), Shape.load("ring.obj")
    hits = intersects(drone, poses, ring, pose, OBB)            # many poses at once
    found = contacts(drone, poses[0], ring, pose)               # all contacts of triangles

A pose is x y z and a unit quaternion x y z w, (7,) or (n, 7). Levels: SPHERE, OBB, OCTREE, TRIANGLE; each refines the
one before, and a hit at a level is a hit at all levels before it. `docs/collision.md` states which answers are exact.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box import obb, sphere
from drone_engine.collision.manifold import POINTS, Manifolds
from drone_engine.collision.mesh import traversal
from drone_engine.collision.mesh.contacts import Velocities
from drone_engine.collision.mesh.narrow import Meshes
from drone_engine.collision.mesh.shape import Shape, axes_at
from drone_engine.collision.placement import PlacedBodies
from drone_engine.collision_level import OBB, OCTREE, SPHERE, TESTED, TRIANGLE


class Contacts(NamedTuple):
    """k contacts of shapes a and b, world frame."""

    point: Floats  # (k, 3) m
    normal: Floats  # (k, 3) unit, from a to b
    depth: Floats  # (k,) m, how far b has to move along the normal to separate
    parts: Integers  # (k, 2) triangle of a and of b, as given, or leaf; -1: the whole shape


def intersects(a: Shape, poses_a: ArrayLike, b: Shape, poses_b: ArrayLike, level: int = TRIANGLE) -> Booleans:
    """Whether shapes a and b touch: (n,) for n poses of each, or of one of them; a single answer for one pose of each.

    Surfaces touch, not solids: a shape wholly inside a hollow mesh does not touch it. Raises ValueError for poses of
    other shapes or that are not finite, and for an unknown level.
    """
    single = np.ndim(poses_a) == np.ndim(poses_b) == 1
    first, second = _poses(poses_a, poses_b)
    hits = _intersects(a, first, b, second, level)
    return hits[0] if single else hits


def contacts(a: Shape, pose_a: ArrayLike, b: Shape, pose_b: ArrayLike, level: int = TRIANGLE) -> Contacts:
    """All contacts of shapes a and b, none if they do not touch.

    One at level SPHERE, up to eight at OBB, up to eight for each pair of leaves at OCTREE, and one for each pair of
    triangles at TRIANGLE. Errors as for `intersects`.
    """
    first, second = _poses(pose_a, pose_b)
    if len(first) != 1:
        raise ValueError(f"poses: expected one each, got {len(first)}")
    if level == SPHERE:
        hit, normal, point, separation = sphere.contacts(*a.bounding_spheres(first), *b.bounding_spheres(second))
        return Contacts(point[hit], normal[hit], -separation[hit], np.full((hit.sum(), 2), -1))
    if level == OBB:
        return _box_contacts(np.full((1, 2), -1), *a.bounding_boxes(first), *b.bounding_boxes(second))
    if level == OCTREE:
        leaves = traversal.pairs(a.tree, first, b.tree, second, leaves=True)[1].astype(np.int64)
        return _box_contacts(leaves, *a.leaf_boxes(first, leaves[:, 0]), *b.leaf_boxes(second, leaves[:, 1]))
    if level == TRIANGLE:
        _, pairs, point, normal, depth = traversal.contacts(a.tree, first, b.tree, second)
        return Contacts(point, normal, depth, np.stack([a.tree.face[pairs[:, 0]], b.tree.face[pairs[:, 1]]], axis=1))
    raise _no_level(level)


def _box_contacts(parts: Integers, *boxes: Floats) -> Contacts:
    """The contacts of k pairs of boxes with these `parts` (k, 2); boxes: as `obb.contacts` takes them."""
    found = obb.contacts(*boxes)
    points = np.diff(found.first)
    return Contacts(found.point, np.repeat(found.normal, points, axis=0), -found.separation,
                    np.repeat(parts[found.number], points, axis=0))


def manifolds(a: Shape, pose_a: ArrayLike, b: Shape, pose_b: ArrayLike, level: int = TRIANGLE,
              margin: float = 0.0) -> list[Contacts]:
    """The contacts as a solver gets them: at most `margin` m apart (depths may be negative), in groups of nearly equal
    normals, at most six groups of at most eight points.

    At levels SPHERE and OBB there is one group, the result of `contacts`. Errors as for `intersects`.
    """
    if level in (SPHERE, OBB):
        found = contacts(a, pose_a, b, pose_b, level)
        return [found] if len(found.depth) else []
    if level not in (OCTREE, TRIANGLE):
        raise _no_level(level)
    poses = np.concatenate(_poses(pose_a, pose_b))
    bodies = PlacedBodies(np.arange(2), poses[:, :3].copy(), poses[:, 3:].copy(), axes_at(poses), np.zeros((2, 3)))
    one = np.ones(1, np.int64)
    at_rest = Velocities(np.zeros((2, 3)), np.zeros((2, 3)), 0.0)
    m = Meshes([a, b], np.arange(2)).find(Manifolds(8), bodies, at_rest, 0 * one, one, np.full(1, np.nan), level * one,
                                          one, np.full(1, margin))
    nowhere = np.full((POINTS, 2), -1)
    return [Contacts(m.point_w[i, :k], np.tile(m.normal_w[i], (k, 1)), -m.separation[i, :k], nowhere[:k])
            for i, k in enumerate(m.points[: m.count])]


def _intersects(a: Shape, poses_a: Floats, b: Shape, poses_b: Floats, level: int) -> Booleans:
    """Whether the shapes touch at each of n poses (n, 7) of both."""
    if level == SPHERE:
        return sphere.intersects(*a.bounding_spheres(poses_a), *b.bounding_spheres(poses_b))
    if level == OBB:
        return obb.intersects(*a.bounding_boxes(poses_a), *b.bounding_boxes(poses_b))
    if level in (OCTREE, TRIANGLE):
        return traversal.intersects(a.tree, poses_a, b.tree, poses_b, boxes=level == OCTREE)
    raise _no_level(level)


def _no_level(level: int) -> ValueError:
    """The error for an unknown level."""
    return ValueError(f"level: expected {', '.join(f'{i} ({name})' for i, name in enumerate(TESTED))}, got {level}")


def _poses(poses_a: ArrayLike, poses_b: ArrayLike) -> tuple[Floats, Floats]:
    """Both as contiguous arrays (n, 7) of equal length; raises ValueError for invalid poses."""
    arrays = []
    for name, poses in (("poses_a", poses_a), ("poses_b", poses_b)):
        array = np.atleast_2d(np.asarray(poses, np.float64))
        if array.ndim != 2 or array.shape[1] != 7:
            raise ValueError(f"{name}: expected a pose (7,) or poses (n, 7), got shape {array.shape}")
        traversal.check_poses(name, array)
        arrays.append(array)
    n = max(len(array) for array in arrays)
    for name, array in zip(("poses_a", "poses_b"), arrays, strict=True):
        if len(array) not in (1, n):
            raise ValueError(f"{name}: expected 1 or {n} poses, got {len(array)}")
    first, second = (np.ascontiguousarray(np.broadcast_to(array, (n, 7))) for array in arrays)
    return first, second
