"""Inputs of bench.collision: pairs of boxes and meshes near touch, and frames of many moving boxes."""

from typing import NamedTuple

import numpy as np
import trimesh
from numpy.random import Generator

from drone_engine.arrays import Floats, Integers


class Boxes(NamedTuple):
    """n boxes: centers (n, 3) m, axes (n, 3, 3), one per row, half extents (n, 3) m."""

    center: Floats
    axes: Floats
    half: Floats


class Mesh(NamedTuple):
    """Vertices (v, 3) in m and faces (f, 3)."""

    vertices: Floats
    faces: Integers


def quaternions(rng: Generator, n: int) -> Floats:
    """Uniformly distributed rotations (n, 4) as x, y, z, w."""
    q = rng.normal(size=(n, 4))
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True))


def matrices(q: Floats) -> Floats:
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4)."""
    x, y, z, w = q.T
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), -1, 0)


def boxes_near_touch(rng: Generator, n: int) -> tuple[Boxes, Boxes]:
    """Pairs of boxes near touch in random orientations; about half of them intersect.

    Half extents are 0.2 to 1 m; b lies in a random direction from a, at 0.9 to 1.1 times the distance of touch.
    """
    half_a, half_b = rng.uniform(0.2, 1.0, (2, n, 3))
    axes_a, axes_b = (np.ascontiguousarray(matrices(quaternions(rng, n))) for _ in range(2))
    direction = rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    edges = np.cross(axes_a[:, :, None], axes_b[:, None]).reshape(n, 9, 3)
    lines = np.concatenate([axes_a, axes_b, edges], axis=1)
    reach = (np.abs(lines @ axes_a.transpose(0, 2, 1)) @ half_a[:, :, None]
             + np.abs(lines @ axes_b.transpose(0, 2, 1)) @ half_b[:, :, None])[:, :, 0]
    touch = (reach / np.abs((lines @ direction[:, :, None])[:, :, 0])).min(axis=1)
    center_a = rng.uniform(-5, 5, (n, 3))
    center_b = center_a + direction * (touch * rng.uniform(0.9, 1.1, n))[:, None]
    return Boxes(center_a, axes_a, half_a), Boxes(center_b, axes_b, half_b)


def sphere(cuts: int) -> Mesh:
    """An icosahedron with each edge divided into `cuts`, on the unit sphere: 20 cuts^2 triangles of similar size."""
    corner = trimesh.creation.icosahedron().triangles
    i, j = (index.ravel() for index in np.meshgrid(np.arange(cuts), np.arange(cuts), indexing="ij"))
    up = np.stack([np.stack([i, j]), np.stack([i + 1, j]), np.stack([i, j + 1])])[:, :, i + j < cuts]
    down = np.stack([np.stack([i + 1, j]), np.stack([i + 1, j + 1]), np.stack([i, j + 1])])[:, :, i + j < cuts - 1]
    steps = np.concatenate([up, down], axis=2) / cuts  # corner, weight, triangle
    origin, first, second = corner[:, 0], corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    points = (origin[:, None, None] + steps[:, 0].T[None, :, :, None] * first[:, None, None]
              + steps[:, 1].T[None, :, :, None] * second[:, None, None]).reshape(-1, 3)
    places, index = np.unique(np.round(points, 9), axis=0, return_inverse=True)
    return Mesh(places / np.linalg.norm(places, axis=1, keepdims=True), index.reshape(-1, 3).astype(np.int64))


def meshes() -> dict[str, Mesh]:
    """Three meshes of about 2,000 triangles each, in m."""
    made = {"annulus": trimesh.creation.annulus(0.6, 1.0, 0.5, sections=250),
            "torus": trimesh.creation.torus(1.0, 0.35, major_sections=32, minor_sections=32)}
    return {"sphere": sphere(10), **{name: Mesh(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64))
                                     for name, mesh in made.items()}}


class Frame(NamedTuple):
    """Bounds low, high (n, 3) in m of n axis-aligned boxes at two times, between which each has moved a little."""

    low: Floats
    high: Floats
    low_next: Floats
    high_next: Floats


def frame(n: int) -> Frame:
    """Boxes with log-uniform sizes over a factor of 10, in a volume that gives about 1.7 pairs per box."""
    rng = np.random.default_rng(3)
    half = 0.1 * 10 ** rng.uniform(0, 1, (n, 1)) * rng.uniform(0.7, 1.3, (n, 3))
    i, j = rng.integers(0, n, (2, 200_000))
    side = np.cbrt(n / 4 * np.prod(2 * (half[i] + half[j]), axis=1).mean())
    center = rng.uniform(0, side, (n, 3))
    moved = center + rng.normal(0, 0.02, (n, 3))
    return Frame(center - half, center + half, moved - half, moved + half)
