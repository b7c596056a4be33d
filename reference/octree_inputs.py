"""Meshes and poses for tests of octrees: meshes are vertices (v, 3) and faces (f, 3)."""

import numpy as np

from drone_engine.arrays import Floats, Integers

Mesh = tuple[Floats, Integers]


def torus(around: int, across: int, major: float = 1.0, minor: float = 0.35) -> Mesh:
    """A torus about the z axis, of 2 around across triangles."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2.0 * np.pi * u / around, 2.0 * np.pi * v / across
    vertices = np.stack([(major + minor * np.cos(b)) * np.cos(a), (major + minor * np.cos(b)) * np.sin(a),
                         minor * np.sin(b)], -1).reshape(-1, 3)
    i, j, k, m = ((p % around * across + q % across).ravel()
                  for p, q in ((u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)))
    return vertices, np.concatenate([np.stack([i, j, k], -1), np.stack([i, k, m], -1)])


def ball(around: int, radius: float = 1.0) -> Mesh:
    """A sphere of latitudes and longitudes; the triangles at its poles have no area."""
    a, b = np.meshgrid(np.arange(around + 1) * np.pi / around, np.arange(around) * 2.0 * np.pi / around, indexing="ij")
    vertices = radius * np.stack([np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)], -1).reshape(-1, 3)
    u, v = (x.ravel() for x in np.meshgrid(np.arange(around), np.arange(around), indexing="ij"))
    i, j, k, m = (p * around + q % around for p, q in ((u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)))
    return vertices, np.concatenate([np.stack([i, j, k], -1), np.stack([i, k, m], -1)])


def cube() -> Mesh:
    """A cube of side 1 about the origin."""
    vertices = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    return vertices, np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                               [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def soup(count: int, seed: int = 0) -> Mesh:
    """Triangles of all sizes in random places: needles, copies, segments and points."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-4, -0.5, (count, 1, 1))
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(size=(count, 3, 3)) * size
    corners[::9, 2] = corners[::9, 1]
    corners[::13] = corners[::13, :1]
    corners[1::11] = corners[2:3]
    corners[5::10, 1] = corners[5::10, 0] + 1e-9 * rng.normal(size=corners[5::10, 1].shape)
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def poses(count: int, distance: float, seed: int = 1) -> Floats:
    """Random poses (count, 7), at most `distance` m from the origin."""
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=(count, 4))
    shift = rng.normal(size=(count, 3))
    shift *= distance * rng.uniform(0.2, 1.0, (count, 1)) / np.linalg.norm(shift, axis=1, keepdims=True)
    quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
    return np.concatenate([shift, quaternion], axis=1)


def at(*pose: float) -> Floats:
    """One pose (1, 7), given in part: the identity rotation by default."""
    return np.array([[*pose, 0.0, 0.0, 0.0, 1.0][:7]])


SHAPES = {"ball": ball(10), "torus": torus(12, 9), "cube": cube(), "soup": soup(150),
          "one": (np.eye(3), np.array([[0, 1, 2]]))}
