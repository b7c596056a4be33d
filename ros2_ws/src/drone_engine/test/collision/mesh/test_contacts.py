"""Contacts of meshes for the solver: normals, depths, and the features that may have contacts."""

import itertools

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.collision import Shape, manifolds
from drone_engine.collision.mesh.topology import EDGE, OPEN, POINTED, find_topology
from reference.shapes import flat_sheet

SIGNS = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
CUBE = Shape.of(SIGNS, [face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))])


def rotation(q: Floats) -> Floats:
    """The matrix of a unit quaternion x y z w."""
    x, y, z, w = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def pushed_cubes(seed: int, depth: float) -> tuple[Floats, Floats, Floats]:
    """Poses of two cubes in random orientations that overlap by `depth` m, and the direction in which b leaves a."""
    rng = np.random.default_rng(seed)
    q, p, way = rng.normal(size=4), rng.normal(size=4), rng.normal(size=3)
    q, p, way = q / np.linalg.norm(q), p / np.linalg.norm(p), way / np.linalg.norm(way)
    a, b = rotation(q).T, rotation(p).T
    axes = [*a, *b, *(np.cross(u, v) / np.linalg.norm(np.cross(u, v)) for u in a for v in b)]
    reach = np.array([0.5 * (np.abs(a @ axis) + np.abs(b @ axis)).sum() for axis in axes])
    distance = (reach / np.abs([way @ axis for axis in axes])).min()  # at which they touch
    axis = axes[int(np.argmin(reach / np.abs([way @ axis for axis in axes])))]
    normal = axis * np.sign(axis @ way)
    return np.r_[np.zeros(3), q], np.r_[distance * way - depth * normal, p], normal


def test_overlapping_cubes_have_contacts_that_lead_out() -> None:
    right = 0
    for seed in range(100):
        a, b, normal = pushed_cubes(seed, 0.002)
        found = manifolds(CUBE, a, CUBE, b)
        deepest = max(found, key=lambda manifold: manifold.depth.max())
        assert deepest.depth.max() > 0.0
        assert deepest.normal[0] @ normal > 0.0
        right += bool(deepest.normal[0] @ normal > np.cos(np.radians(5.0)) and deepest.depth.max() < 0.0021)
    assert right >= 97


def test_deeply_overlapping_cubes_have_contacts() -> None:
    for seed in range(50):
        a, b, _ = pushed_cubes(seed, 0.2)
        assert max(manifold.depth.max() for manifold in manifolds(CUBE, a, CUBE, b)) > 0.0


def test_a_flat_sheet_has_edges_and_pointed_corners_at_its_border_only() -> None:
    vertices, faces = flat_sheet(4)
    topology = find_topology(vertices[faces])
    bits = [(topology.owned[:, None] & (first << np.arange(3)) != 0).sum() for first in (POINTED, EDGE)]
    assert bits == [4, 16]
    assert (topology.owned & OPEN).all()


def test_a_cube_has_eight_pointed_corners_and_twelve_edges() -> None:
    owned = CUBE.topology.owned
    bits = [(owned[:, None] & (first << np.arange(3)) != 0).sum() for first in (POINTED, EDGE)]
    assert bits == [8, 12]
    assert not (owned & OPEN).any()
