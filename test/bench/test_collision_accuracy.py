"""The counts of `make accuracy`: missed and false hits, first hits, and distances of surfaces at these."""

from pathlib import Path

import numpy as np
import pytest

from bench.accuracy.collision.approaches import lines
from bench.accuracy.collision.comparison import Tally, answers, compare_contacts, count, first_hits, measure_first_hits
from bench.accuracy.collision.flights import Encounter
from bench.accuracy.collision.mesh_distance import surface_distance
from drone_engine.assets import asset_path
from drone_engine.collision.mesh import octree
from drone_engine.collision.triangle.closest import closest_points

CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
         (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
CUBE = octree.build(CORNERS, FACES)
HERE = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
EIGHTH = np.sin(np.pi / 8), np.cos(np.pi / 8)  # a rotation by 45 degrees


def test_missed_and_false_hits_of_a_coarser_level_are_counted() -> None:
    tally = Tally()
    count(tally, np.array([[1, 1, 0, 0, 1], [1, 1, 1, 0, 0], [1, 0, 0, 0, 1], [1, 0, 0, 1, 0]], bool))
    assert tally.poses == 5
    assert tally.hits == [3, 3, 2, 2]
    assert tally.false == [2, 2, 1, 0]
    assert tally.missed == [1, 1, 1, 0]


def test_a_first_hit_follows_a_second_without_hits() -> None:
    times = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 5.0, 5.1, 5.2, 9.0, 9.1])
    hit = np.array([0, 1, 0, 1, 1, 1, 1, 0, 0, 1], bool)
    assert first_hits(times, hit) == [(1, True), (5, False), (9, True)]


@pytest.mark.parametrize(("pose_a", "pose_b", "distance"), [
    ((0, 0, 0, 0, 0, 0, 1), (2.25, 0.5, -0.3, 0, 0, 0, 1), 0.25),
    ((0, 0, 0, 0, 0, 0, 1), (2.3, 2.4, 0, 0, 0, 0, 1), 0.5),  # parallel edges
    ((0, 0, 0, 0, 0, 0, 1), (1.3 + np.sqrt(2), 0.2, 0, 0, 0, *EIGHTH), 0.3),  # an edge before a face
    ((0, 0, 0, 0, 0, *EIGHTH), (0.1 + np.sqrt(8), 0, 0, 0, EIGHTH[0], 0, EIGHTH[1]), 0.1),  # edges that cross
])
def test_distances_of_cubes(pose_a: tuple[float, ...], pose_b: tuple[float, ...], distance: float) -> None:
    a, b = np.array(pose_a, float), np.array(pose_b, float)
    assert surface_distance(CUBE, a, CUBE, b) == pytest.approx(distance, abs=1e-12)
    assert surface_distance(CUBE, b, CUBE, a) == pytest.approx(distance, abs=1e-12)


def test_distances_of_many_triangles() -> None:
    random = np.random.default_rng(2)
    for _ in range(40):
        a, b = (octree.build(np.repeat(random.uniform(-1, 1, (40, 3)), 3, axis=0) + random.normal(0, 0.02, (120, 3)),
                             np.arange(120).reshape(40, 3)) for _ in range(2))
        distance = np.array([1.2, 0.9, 1.5, 0, 0, 0, 1])
        near = min(closest_points(tuple(s.ravel()), tuple(t.ravel() + np.tile(distance[:3], 3)))[0]
                   for s in a.corners for t in b.corners)
        assert surface_distance(a, HERE, b, distance) == pytest.approx(np.sqrt(near), abs=1e-12)


def test_first_hits_of_cubes_are_where_their_bounds_touch(tmp_path: Path) -> None:
    path = tmp_path / "cube.obj"
    path.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
                    + "".join(f"f {i + 1} {j + 1} {k + 1}\n" for i, j, k in FACES))
    left = np.arange(4.1, 1.6, -0.3)
    there = np.tile(HERE, (len(left), 1))
    there[:, 0] = left
    e = Encounter(path, path, -left, np.tile(HERE, (len(left), 1)), there)
    tally = Tally()
    measure_first_hits(tally, e, answers(e))
    assert [len(gaps) for gaps in tally.gaps] == [1, 1, 1, 1]
    assert [gaps[0] for gaps in tally.gaps] == pytest.approx([2 * np.sqrt(3) - 2, 0, 0, 0], abs=1e-4)


def test_each_level_reports_hits_later_than_the_one_before_and_misses_none() -> None:
    tally = Tally()
    drone, ring = asset_path("models", "drone.obj"), asset_path("models", "ring.obj")
    rows, near = lines(drone, ring, 6, np.random.default_rng(3))
    measure_first_hits(tally, rows, answers(rows))
    count(tally, answers(near))
    compare_contacts(tally, near, answers(near))
    sphere, obb, tree, triangle = (np.mean(gaps) for gaps in tally.gaps)
    assert sphere > obb > tree > triangle == 0.0
    assert tally.false[0] >= tally.false[1] > tally.false[2] > tally.false[3] == 0
    assert tally.missed == [0, 0, 0, 0]
    assert tally.hits[3] == tally.poses // 2  # exactly the poses past the touch
    assert np.median(tally.depth[0]) > np.median(tally.depth[2]) > 0.0 == max(tally.depth[3])
