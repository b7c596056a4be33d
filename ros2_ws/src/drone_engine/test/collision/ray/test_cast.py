"""Rays against closed forms, against all triangles in rational arithmetic, and through the seams of closed meshes."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine.collision.mesh import octree
from drone_engine.collision.ray.cast import cast, normalized
from drone_engine.collision.ray.triangle import edge_function_error, ray_triangle, shear
from drone_engine.collision.triangle.contact import distances
from drone_engine.collision_level import OBB, OCTREE, SPHERE, TRIANGLE
from drone_engine.math.poses import rotate_all
from reference import shapes

LEVELS = (SPHERE, OBB, OCTREE, TRIANGLE)
HERE = np.array([0, 0, 0, 0, 0, 0, 1.0])
MESH = shapes.ball(9, 14, bumps=0.1)
TREE = octree.build(*MESH)


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def some_pose(rng: np.random.Generator, spread: float = 1.0) -> np.ndarray:
    return np.concatenate([rng.normal(size=3) * spread, unit(rng.normal(size=4))])


def test_a_sphere() -> None:
    half = np.full(3, 2 / math.sqrt(3))  # radius 2
    hits = cast([[-5, 0, 1], [-5, 0, 2.1], [0, 0, 1], [5, 0, 0]], [[3, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0]],
                    HERE, half, SPHERE)
    np.testing.assert_allclose(hits.distance, [5 - math.sqrt(3), np.inf, 0, np.inf], atol=1e-9)
    np.testing.assert_allclose(hits.normal[0], [-math.sqrt(3) / 2, 0, 0.5], atol=1e-9)
    np.testing.assert_allclose(hits.normal[2], [-1, 0, 0])
    assert hits.body.tolist() == [0, -1, 0, -1]
    assert np.isnan(hits.point[1]).all() and np.isnan(hits.normal[1]).all()


@pytest.mark.parametrize("level", [OBB, OCTREE])
def test_a_box_rotated_by_45_degrees(level: int) -> None:
    pose = np.array([10, 0, 0, 0, 0, math.sin(math.pi / 8), math.cos(math.pi / 8)])
    tree = octree.build(*shapes.block(1, 1, 3))._replace(link=np.array([[0, 0, 0, 12]], np.int32),
                                                       box=np.array([[0, 0, 0, 1, 1, 3.0]]))
    hits = cast(np.array([[0, 0.5, 2.0]]), np.array([[1.0, 0, 0]]), pose, [1, 1, 3], level, tree, 0)
    assert hits.distance[0] == pytest.approx(10 - math.sqrt(2) + 0.5, abs=1e-9)
    np.testing.assert_allclose(hits.normal[0], [-math.sqrt(0.5), math.sqrt(0.5), 0], atol=1e-12)
    np.testing.assert_allclose(hits.point[0], [hits.distance[0], 0.5, 2], atol=1e-9)


@pytest.mark.parametrize("level", LEVELS)
def test_a_slanting_plane_at_every_level(level: int) -> None:
    vertices, faces = shapes.block(0.0, 4.0, 4.0)
    tree = octree.build(vertices, faces[:4])
    hits = cast([[-3.0, 0.5, 0.25]], [[2.0, 0.1, 0.2]], HERE, [0, 4, 4], level, tree, 0)
    way = np.linalg.norm([3, 0.15, 0.3])
    if level == SPHERE:
        assert hits.distance[0] < way
    else:
        assert hits.distance[0] == pytest.approx(way, abs=1e-9)
        np.testing.assert_allclose(hits.normal[0], [-1, 0, 0], atol=1e-12)


def test_a_ray_along_a_face_and_one_beside_it() -> None:
    rays = np.array([[-5, 1, 0.5], [-5, np.nextafter(1, 0), 0.5], [-5, 1 + 1e-12, 0.5]])
    hits = cast(rays, [[1, 0, 0]] * 3, HERE, [1, 1, 1], OBB)
    np.testing.assert_allclose(hits.distance, [4, 4, np.inf])
    hits = cast(rays, [[1, -0.0, 0]] * 3, HERE, [1, 1, 1], OBB)
    np.testing.assert_allclose(hits.distance, [4, 4, np.inf])


def test_the_range_includes_its_end() -> None:
    for reach, expected in ((4.0, 4.0), (3.999, np.inf)):
        hits = cast([-5, 0.5, 0], [7, 0, 0], HERE, 1, TRIANGLE, octree.build(*shapes.block(1, 1, 1)), 0, reach)
        assert hits.distance[0] == expected


def exact_distance(origin: np.ndarray, direction: np.ndarray, triangle: np.ndarray) -> Fraction | None:
    """The exact distance in units of the direction; None for a miss and for a triangle seen edge on."""
    o, d = ([Fraction(x) for x in v.tolist()] for v in (origin, direction))
    a, b, c = ([Fraction(x) - y for x, y in zip(p.tolist(), o, strict=True)] for p in triangle)

    def det(u: list[Fraction], v: list[Fraction], w: list[Fraction]) -> Fraction:
        return (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
                + u[2] * (v[0] * w[1] - v[1] * w[0]))

    sides = [det(d, b, c), det(d, c, a), det(d, a, b)]
    if sum(sides) == 0 or (min(sides) < 0 < max(sides)):
        return None
    t = det(a, b, c) / sum(sides)
    return t if t >= 0 else None


def distance_to(origin: np.ndarray, direction: np.ndarray, triangle: np.ndarray) -> float:
    bound = edge_function_error(float(np.abs(triangle - origin).max()))
    return float(ray_triangle(triangle[None].copy(), 0, *origin, *direction, *shear(*direction), bound))


near = st.builds(lambda x, e: x * (1 + e * 2.0**-52), st.integers(-3, 3).map(float), st.integers(-2, 2))
triple = st.lists(near, min_size=3, max_size=3).map(np.array)


@settings(max_examples=600, deadline=None)
@given(triple, triple.filter(np.any), triple, triple, triple)
def test_a_triangle_is_hit_where_exact_arithmetic_says(o: np.ndarray, d: np.ndarray, a: np.ndarray, b: np.ndarray,
                                                       c: np.ndarray) -> None:
    triangle = np.array([a, b, c])
    got, expected = distance_to(o, d, triangle), exact_distance(o, d, triangle)
    assert (got < math.inf) == (expected is not None)
    if expected is not None and abs(got - float(expected)) > 1e-9:  # along what is seen nearly edge on
        point = np.tile(o + got * d, (1, 3, 1))
        assert distances(point, triangle[None])[0][0] < 1e-9


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_corners_and_edges_hit_from_anywhere_as_exact_arithmetic_says(shift: float) -> None:
    rng = np.random.default_rng(1)
    hit = 0
    for k in range(400):
        triangle = rng.normal(size=(3, 3)) * [1, 1, 1e-8 if k % 3 == 0 else 1] + shift
        o = rng.normal(size=3) * 3 + shift
        at = rng.dirichlet([1, 1, 1]) * (rng.random(3) < 0.6)
        d = (at / at.sum() if at.sum() > 0 else np.array([1, 0, 0])) @ triangle - o
        got, expected = distance_to(o, d, triangle), exact_distance(o, d, triangle)
        assert (got < math.inf) == (expected is not None)
        hit += expected is not None
    assert 100 < hit < 390


def test_every_ray_against_all_triangles() -> None:
    rng = np.random.default_rng(2)
    origins = rng.normal(size=(60, 3)) * 2
    directions = unit(rng.normal(size=(60, 3)) * 0.5 - origins)
    hits = cast(origins, directions, HERE, 1, TRIANGLE, TREE, 0)
    vertices, faces = MESH
    found = 0
    for i in range(60):
        d = np.array(normalized(*directions[i]))
        distances = [exact_distance(origins[i], d, vertices[face]) for face in faces]
        nearest = min((t for t in distances if t is not None), default=None)
        assert hits.distance[i] == pytest.approx(math.inf if nearest is None else float(nearest), abs=1e-9)
        if nearest is not None:
            assert float(distances[hits.face[i]] or 0) == pytest.approx(float(nearest), abs=1e-9)
            a, b, c = vertices[faces[hits.face[i]]]
            assert abs(hits.normal[i] @ unit(np.cross(b - a, c - a))) == pytest.approx(1)
            assert hits.normal[i] @ d < 0
            found += 1
    assert 20 < found < 60


@pytest.mark.parametrize("shift", [0.0, 1e6])
@pytest.mark.parametrize("mesh", [shapes.block(1, 0.5, 2), MESH], ids=["block", "ball"])
def test_no_ray_passes_through_a_seam(mesh: tuple[np.ndarray, np.ndarray], shift: float) -> None:
    """Towards each vertex and points of each edge, straight on and from random sides; the mesh is closed, so what is
    aimed past a point towards the inside must hit."""
    vertices, faces = mesh
    rng = np.random.default_rng(3)
    a, b = vertices[faces[:, 0]], vertices[faces[:, 1]]
    targets = np.concatenate([vertices, (a + b) / 2, a + rng.random((len(a), 1)) * (b - a)])
    targets = np.repeat(targets, 12, axis=0)
    inside = rng.uniform(-0.3, 0.3, targets.shape)
    inside[::3] = 0.0
    away = unit(targets - inside)
    origins = targets + away * rng.integers(1, 5, (len(targets), 1))
    for pose in (HERE, some_pose(rng)):
        moved = pose + np.array([shift, -shift, shift, 0, 0, 0, 0])
        turn = np.broadcast_to(pose[3:], (len(targets), 4))
        world = moved[:3] + rotate_all(turn, origins)
        hits = cast(world, rotate_all(turn, targets - origins), moved, 1, TRIANGLE, octree.build(*mesh), 0)
        assert np.isfinite(hits.distance).all()


def test_triangles_without_area_change_nothing() -> None:
    rng = np.random.default_rng(4)
    vertices, faces = MESH
    flat = np.concatenate([faces, faces[:40][:, [0, 0, 1]], faces[40:80][:, [2, 2, 2]], faces[:30]])
    origins = rng.normal(size=(500, 3)) * 2
    directions = vertices[rng.integers(0, len(vertices), 500)] - origins
    clean = cast(origins, directions, HERE, 1, TRIANGLE, TREE, 0)
    spoilt = cast(origins, directions, HERE, 1, TRIANGLE, octree.build(vertices, flat), 0)
    np.testing.assert_allclose(spoilt.distance, clean.distance, atol=1e-12)
    assert np.isfinite(clean.distance).sum() > 250
    assert np.isfinite(spoilt.normal[np.isfinite(spoilt.distance)]).all()


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_a_finer_level_is_never_hit_earlier(shift: float) -> None:
    rng = np.random.default_rng(5)
    for mesh in (MESH, shapes.block(1, 0.2, 3), shapes.block(0, 1, 1), shapes.block(1e-3, 2e-3, 1e-3)):
        tree, size = octree.build(*mesh), np.abs(mesh[0]).max()
        pose = some_pose(rng) + np.array([shift, shift, 0, 0, 0, 0, 0])
        corners = mesh[0][rng.integers(0, len(mesh[0]), 3000)]
        corners = pose[:3] + rotate_all(np.broadcast_to(pose[3:], (3000, 4)), corners)
        origins = pose[:3] + rng.normal(size=(3000, 3)) * 3 * size
        distance = [cast(origins, corners - origins, pose, 1, level, tree, 0).distance for level in LEVELS]
        for coarse, fine in itertools.pairwise(distance):
            assert (coarse <= fine).all()
        assert np.isfinite(distance[3]).mean() > 0.2


def test_the_nearest_of_many_bodies_at_all_levels() -> None:
    rng = np.random.default_rng(6)
    forest, roots = octree.join([TREE, octree.build(*shapes.block(0.5, 1, 0.2))])
    poses = np.array([some_pose(rng, 4.0) for _ in range(24)])
    levels, root = np.arange(24) % 4, np.array(roots)[np.arange(24) % 5 % 2]
    half = rng.uniform(0.2, 1, (24, 3))
    root[:4] = -1
    levels[:4] = [0, 1, 0, 1]
    origins, directions = rng.normal(size=(400, 3)) * 8, rng.normal(size=(400, 3))
    directions -= origins / 4
    together = cast(origins, directions, poses, half, levels, forest, root, max_range=12.0)
    alone = [cast(origins, directions, poses[b], half[b], levels[b], forest, root[b]) for b in range(24)]
    distance = np.array([hits.distance for hits in alone])
    distance[distance > 12.0] = np.inf
    nearest = distance.argmin(0)
    np.testing.assert_array_equal(together.distance, distance.min(0))
    found = np.isfinite(together.distance)
    assert 70 < found.sum() < 390
    assert len(set(levels[nearest[found]].tolist())) == 4
    np.testing.assert_array_equal(together.body[found], nearest[found])
    for i in np.flatnonzero(found):
        assert together.face[i] == alone[nearest[i]].face[i]
        np.testing.assert_allclose(together.normal[i], alone[nearest[i]].normal[i])
        assert (together.face[i] >= 0) == (levels[nearest[i]] >= OCTREE)
    assert (np.sum(together.normal[found] * directions[found], 1) < 0).all()
    np.testing.assert_allclose(together.point[found], (origins + together.distance[:, None] * unit(directions))[found])


def test_trees_that_are_shared_and_may_not_be_written_to() -> None:
    for level in (OCTREE, TRIANGLE):
        hits = [cast([3, 0.1, 0.2], [-1, 0, 0], HERE, 1, level, tree, 0) for tree in (TREE, octree.build_cached(*MESH))]
        assert hits[0].distance[0] == hits[1].distance[0] < 3


@pytest.mark.parametrize(("change", "message"), [
    ({"directions": [[0, 0, 0]]}, r"directions\[0\]: expected a length other than 0, got 0"),
    ({"origins": [[np.nan, 0, 0]]}, "rays: expected finite"),
    ({"levels": TRIANGLE}, "roots: expected nodes of a forest of 0"),
    ({"origins": [[0, 0]]}, r"rays: expected origins and directions \(n, 3\), got \(1, 2\)"),
    ({"poses": np.zeros((2, 3))}, r"poses: expected \(b, 7\), got \(2, 3\)"),
])
def test_invalid_arguments_are_rejected(change: dict, message: str) -> None:
    rays = {"origins": [[0, 0, 0]], "directions": [[1, 0, 0]], "poses": HERE, "half": 1, "levels": OBB}
    with pytest.raises(ValueError, match=message):
        cast(**rays | change)
