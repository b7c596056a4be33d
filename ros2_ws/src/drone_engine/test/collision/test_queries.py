"""Collision queries of two meshes at given poses."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine.arrays import Floats
from drone_engine.assets import ASSETS
from drone_engine.collision import OBB, OCTREE, SPHERE, TRIANGLE, Shape, contacts, intersects, manifolds

LEVELS = (SPHERE, OBB, OCTREE, TRIANGLE)
MODELS = ASSETS / "models"
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE = Shape.of([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)],
                [face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))])


def pose(x: float, y: float, z: float, turn: tuple[float, float, float, float] = (0, 0, 0, 1)) -> Floats:
    return np.array([x, y, z, *turn], float)


@pytest.fixture(scope="module")
def ring() -> Shape:
    return Shape.load(MODELS / "ring.obj")


@pytest.fixture(scope="module")
def drone() -> Shape:
    return Shape.load(MODELS / "drone.obj")


def test_a_drone_flies_through_a_ring_at_the_fine_levels_alone(drone: Shape, ring: Shape) -> None:
    way = np.array([pose(x, 0, 1.2) for x in np.linspace(-2, 2, 41)])
    hit = {level: intersects(drone, way, ring, pose(0, 0, 0), level).any() for level in LEVELS}
    assert hit == {SPHERE: True, OBB: True, OCTREE: False, TRIANGLE: False}
    assert intersects(drone, pose(0, 0.9, 1.2), ring, pose(0, 0, 0)) == np.True_


@pytest.mark.parametrize("level", LEVELS)
def test_a_cube_on_a_cube(level: int) -> None:
    below, above = pose(0, 0, 0), pose(0.25, 0.1, 0.99)
    found = contacts(CUBE, below, CUBE, above, level)
    assert len(found.depth) > 0
    np.testing.assert_allclose(np.linalg.norm(found.normal, axis=1), 1.0)
    if level in (OBB, OCTREE):
        np.testing.assert_allclose(found.normal, np.tile([0, 0, 1], (len(found.depth), 1)), atol=1e-12)
        np.testing.assert_allclose(found.depth, 0.01, atol=1e-12)
    if level == TRIANGLE:
        assert set(np.unique(found.parts)) <= set(range(12))
    assert len(contacts(CUBE, below, CUBE, pose(3, 0, 0), level).depth) == 0
    assert manifolds(CUBE, below, CUBE, pose(3, 0, 0), level) == []


@pytest.mark.parametrize("level", [OBB, OCTREE, TRIANGLE])
def test_manifolds_of_a_cube_on_a_cube(level: int) -> None:
    found = manifolds(CUBE, pose(0, 0, 0), CUBE, pose(0.25, 0.1, 0.995), level)
    assert len(found) == 1
    np.testing.assert_allclose(found[0].normal, np.tile([0, 0, 1], (len(found[0].depth), 1)), atol=1e-12)
    np.testing.assert_allclose(found[0].depth, 0.005, atol=1e-12)
    x, y = found[0].point[:, 0], found[0].point[:, 1]
    np.testing.assert_allclose([x.min(), x.max(), y.min(), y.max()], [-0.25, 0.5, -0.4, 0.5], atol=1e-8)


def test_a_drone_deep_in_a_crate_is_pushed_out(drone: Shape) -> None:
    crate = Shape.load(MODELS / "crate.obj")
    rng = np.random.default_rng(5)
    poses = rng.normal(size=(400, 7))
    poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1, keepdims=True)
    poses[:, :3] *= 0.35
    hits = np.flatnonzero(intersects(drone, poses, crate, pose(0, 0, 0)))
    pushed = [max((found.depth.max() for found in manifolds(drone, poses[k], crate, pose(0, 0, 0))), default=0.0) > 0.0
              for k in hits]
    assert np.mean(pushed) > 0.99


def test_swapping_reverses_the_normals(drone: Shape, ring: Shape) -> None:
    there, here = pose(0.02, 0.9, 1.2), pose(0, 0, 0)
    for level in LEVELS:
        one, two = contacts(drone, there, ring, here, level), contacts(ring, here, drone, there, level)
        assert len(one.depth) == len(two.depth) > 0
        order, other = (np.lexsort(np.round(found.point, 9).T) for found in (one, two))
        np.testing.assert_allclose(one.normal[order].sum(0), -two.normal[other].sum(0), atol=1e-6)


numbers = st.floats(-1.0, 1.0)


@settings(max_examples=100, deadline=None)
@given(st.lists(numbers, min_size=7, max_size=7), st.lists(numbers, min_size=7, max_size=7), st.sampled_from([0, 1e6]))
def test_levels_are_nested_and_symmetric(one: list[float], two: list[float], far: float) -> None:
    poses = np.array([one, two]) + 1e-3
    poses[:, :3] += far
    poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1, keepdims=True)
    hits = [bool(intersects(CUBE, poses[0], CUBE, poses[1], level)) for level in LEVELS]
    assert hits == sorted(hits, reverse=True)
    assert hits == [bool(intersects(CUBE, poses[1], CUBE, poses[0], level)) for level in LEVELS]


def test_one_pose_applies_to_all() -> None:
    many = np.array([pose(x, 0, 0) for x in (0.0, 0.9, 1.1)])
    for level in (OBB, TRIANGLE):
        assert intersects(CUBE, many, CUBE, pose(0, 0, 0), level).tolist() == [True, True, False]
    assert intersects(CUBE, many, CUBE, many[::-1], OBB).tolist() == [False, True, False]


@pytest.mark.parametrize(("poses", "level", "error"), [
    (np.zeros(6), OBB, r"poses_a: expected a pose \(7,\) or poses \(n, 7\), got shape \(1, 6\)"),
    (np.zeros((3, 7)), OBB, r"poses_a: expected positions up to .* and unit quaternions, got .* in row 0"),
    (pose(np.nan, 0, 0), SPHERE, r"poses_a: expected positions up to"),
    (pose(0, 0, 0), 7, r"level: expected 0 \(sphere\), 1 \(obb\), 2 \(octree\), 3 \(triangle\), got 7"),
])
def test_invalid_arguments_are_rejected(poses: Floats, level: int, error: str) -> None:
    with pytest.raises(ValueError, match=error):
        intersects(CUBE, poses, CUBE, pose(0, 0, 0), level)
