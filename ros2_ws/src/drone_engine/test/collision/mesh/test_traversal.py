"""Two octrees against each other find exactly the pairs that a test of all pairs of triangles finds."""

from itertools import pairwise

import numpy as np
import pytest

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box import obb
from drone_engine.collision.mesh import octree, traversal
from drone_engine.collision.mesh.octree import Octree
from drone_engine.collision.triangle.contact import contacts
from drone_engine.collision.triangle.intersection import intersects
from drone_engine.math.rotation import matrix
from reference.octree_inputs import SHAPES, at, ball, cube, poses, torus


def world(tree: Octree, pose: Floats) -> Floats:
    """World coordinates of the corners, with the roundings for which answers are exact."""
    r, c = np.array(matrix(*pose[3:])).reshape(3, 3), tree.corners
    return np.stack([(r[i, 0] * c[..., 0] + r[i, 1] * c[..., 1] + r[i, 2] * c[..., 2]) + pose[i] for i in range(3)], -1)


def brute_force(a: Octree, pose_a: Floats, b: Octree, pose_b: Floats) -> Booleans:
    """Which triangles intersect, (m_a, m_b), from a test of every pair."""
    left, right = world(a, pose_a), world(b, pose_b)
    return intersects(np.repeat(left, len(right), axis=0),
                               np.tile(right, (len(left), 1, 1))).reshape(len(left), len(right))


def sets(offsets: Integers, pairs: Integers) -> list[set[tuple[int, int]]]:
    """The pairs of each query as a set; each pair must occur once."""
    found = [[(int(i), int(j)) for i, j in pairs[first:last]]
             for first, last in pairwise(offsets)]
    assert all(len(set(some)) == len(some) for some in found), "a pair occurs twice"
    return [set(some) for some in found]


@pytest.mark.parametrize("shape_a", SHAPES)
@pytest.mark.parametrize("shape_b", SHAPES)
def test_the_same_triangles_intersect_as_in_brute_force(shape_a: str, shape_b: str) -> None:
    a, b = octree.build(*SHAPES[shape_a]), octree.build(*SHAPES[shape_b])
    count = 16
    pose_a, pose_b = poses(count, 0.5), poses(count, 1.8, seed=2)
    hits = traversal.intersects(a, pose_a, b, pose_b)
    found = sets(*traversal.pairs(a, pose_a, b, pose_b))
    for i in range(count):
        expected = brute_force(a, pose_a[i], b, pose_b[i])
        assert found[i] == set(zip(*(x.tolist() for x in np.nonzero(expected)), strict=True))
        assert hits[i] == expected.any()
    assert hits.any()
    np.testing.assert_array_equal(traversal.intersects(b, pose_b, a, pose_a), hits)
    assert [{(j, i) for i, j in some} for some in sets(*traversal.pairs(b, pose_b, a, pose_a))] == found
    assert (hits <= traversal.intersects(a, pose_a, b, pose_b, boxes=True)).all()


@pytest.mark.parametrize("far", [0.0, 1e6, 1e12])
def test_faces_and_edges_that_touch_exactly(far: float) -> None:
    """Cubes side by side share a face, an edge or a corner; the next number apart they share nothing."""
    tree = octree.build(*cube())
    for shift in ([1, 0, 0], [0, -1, 0], [1, 1, 0], [1, -1, 1], [1, 0.5, 0.25]):
        for quaternion in ([0, 0, 0, 1], [0, 0, 1, 0], [0.5, 0.5, 0.5, 0.5]):
            pose_a, pose_b = at(far, 0, 0), np.array([[far, 0, 0, *quaternion]])
            pose_b[0, :3] += shift
            expected = brute_force(tree, pose_a[0], tree, pose_b[0])
            assert expected.any()
            assert traversal.intersects(tree, pose_a, tree, pose_b).all()
            assert len(sets(*traversal.pairs(tree, pose_a, tree, pose_b))[0]) == expected.sum()
            axis = int(np.argmax(np.abs(shift)))
            pose_b[0, axis] = np.nextafter(pose_b[0, axis], np.sign(shift[axis]) * np.inf)
            if axis == 0 or far == 0.0:  # the corners of the others lose the last digit
                expected = brute_force(tree, pose_a[0], tree, pose_b[0])
                assert traversal.intersects(tree, pose_a, tree, pose_b)[0] == expected.any()


def distances(left: Floats, right: Floats, steps: int = 8) -> Floats:
    """Distances of all triangles by sampling: never below the true ones, above them by less than the spacing."""
    s, t = (x.ravel() for x in np.meshgrid(np.arange(steps + 1) / steps, np.arange(steps + 1) / steps))
    weights = np.stack([s, t, 1 - s - t], -1)[s + t <= 1 + 1e-9]
    return np.array([[np.linalg.norm((weights @ p)[:, None] - (weights @ q)[None], axis=-1).min() for q in right]
                     for p in left])


def test_no_pair_of_triangles_within_the_margin_is_missed() -> None:
    a, b = octree.build(*cube()), octree.build(*torus(6, 4))
    pose_a, pose_b = poses(6, 0.3), poses(6, 1.9, seed=5)
    near = {margin: sets(*traversal.pairs(a, pose_a, b, pose_b, margin=margin)) for margin in (0.0, 0.05, 0.4)}
    for i in range(len(pose_a)):
        left, right = world(a, pose_a[i]), world(b, pose_b[i])
        distance = distances(left, right)
        rotation = np.array(matrix(*pose_a[i, 3:])).reshape(3, 3)
        left, right = left @ rotation, right @ rotation  # coordinates in a's frame, except for its origin
        apart = np.maximum(left.min(1)[:, None] - right.max(1), right.min(1) - left.max(1)[:, None]).max(-1)
        for margin, some in near.items():
            assert {(int(p), int(q)) for p, q in np.argwhere(distance <= margin)} <= some[i]
            assert len(some[i]) < 0.8 * apart.size
            assert all(apart[p, q] <= margin + 1e-9 for p, q in some[i])


def test_a_ball_passes_through_a_ring() -> None:
    ring, shot = octree.build(*torus(32, 16)), octree.build(*ball(12, radius=0.3))
    way = np.linspace(-2.0, 2.0, 81)
    through = np.concatenate([at(0.0, 0.0, z) for z in way])
    aside = np.concatenate([at(0.8, 0.0, z) for z in way])
    still = np.concatenate([at(0.0, 0.0, 0.0)] * len(way))
    assert not traversal.intersects(ring, still, shot, through).any()
    assert not traversal.intersects(ring, still, shot, through, boxes=True).any()
    touched = traversal.intersects(ring, still, shot, aside)
    assert touched.any() and not touched[0] and not touched[-1]


def test_a_surface_inside_another_does_not_intersect_it() -> None:
    outer, inner = octree.build(*ball(12)), octree.build(*ball(12, radius=0.2))
    assert not traversal.intersects(outer, at(0.0, 0.0, 0.0), inner, at(0.1, 0.2, 0.0))[0]


def test_a_forest_answers_as_its_trees_do() -> None:
    trees = [octree.build(*mesh) for mesh in SHAPES.values()]
    forest, roots = octree.join(trees)
    rng = np.random.default_rng(4)
    first, second = rng.integers(0, len(trees), (2, 60))
    pose_a, pose_b = poses(60, 0.5), poses(60, 1.8, seed=2)
    hits = traversal.intersects(forest, pose_a, forest, pose_b, roots_a=roots[first], roots_b=roots[second])
    alone = [traversal.intersects(trees[first[i]], pose_a[i:i + 1], trees[second[i]], pose_b[i:i + 1])[0]
             for i in range(60)]
    assert hits.tolist() == alone and 0 < hits.sum() < 60
    offsets, found = traversal.pairs(forest, pose_a, forest, pose_b, roots_a=roots[first], roots_b=roots[second])
    for i in range(60):
        _, own = traversal.pairs(trees[first[i]], pose_a[i:i + 1], trees[second[i]], pose_b[i:i + 1])
        together = found[offsets[i]:offsets[i + 1]]
        np.testing.assert_array_equal(forest.face[together[:, 0]], trees[first[i]].face[own[:, 0]])
        np.testing.assert_array_equal(forest.corners[together[:, 1]], trees[second[i]].corners[own[:, 1]])


def test_more_pairs_than_the_first_buffer_holds_are_all_found() -> None:
    """A hundred copies of a triangle against a hundred; twice the same."""
    tree = octree.build(np.eye(3), np.tile([[0, 1, 2]], (100, 1)))
    first = traversal.pairs(tree, at(0.0, 0.0, 0.0), tree, at(0.0, 0.0, 0.0))
    assert len(sets(*first)[0]) == 10_000
    again = traversal.pairs(tree, at(0.0, 0.0, 0.0), tree, at(0.0, 0.0, 0.0))
    assert all(np.array_equal(x, y) for x, y in zip(first, again, strict=True))


@pytest.mark.parametrize("scale", [1e-30, 1e-12, 1e12, 1e25])
def test_answers_do_not_depend_on_the_size_of_meshes(scale: float) -> None:
    vertices, faces = torus(12, 9)
    tree = octree.build(vertices * scale, faces)
    pose_a, pose_b = poses(10, 0.5), poses(10, 2.5, seed=2)
    pose_a[:, :3] *= scale
    pose_b[:, :3] *= scale
    hits = traversal.intersects(tree, pose_a, tree, pose_b)
    assert hits.tolist() == [brute_force(tree, p, tree, q).any() for p, q in zip(pose_a, pose_b, strict=True)]
    assert 0 < hits.sum() < 10


@pytest.mark.parametrize("stretch", [1e-9, 1e-6, 4e-4])
def test_quaternions_whose_length_is_not_exactly_one(stretch: float) -> None:
    tree = octree.build(*torus(12, 9))
    pose_a, pose_b = poses(30, 0.5), poses(30, 2.5, seed=2)
    pose_a[:, 3:] *= 1.0 + stretch
    pose_b[:, 3:] *= 1.0 - stretch
    found = sets(*traversal.pairs(tree, pose_a, tree, pose_b))
    assert [len(some) for some in found] == [brute_force(tree, p, tree, q).sum()
                                             for p, q in zip(pose_a, pose_b, strict=True)]


def test_invalid_poses_roots_and_margins_are_refused() -> None:
    tree = octree.build(*cube())
    good, bad = at(0.0, 0.0, 0.0), at(0.0, 0.0, 0.0)
    bad[0, 6] = 1.1
    for wrong in (bad, at(np.nan, 0.0, 0.0), at(np.inf, 0.0, 0.0), good[:, :6], np.zeros((2, 7))):
        with pytest.raises(ValueError, match="poses_b: expected"):
            traversal.intersects(tree, good, tree, wrong)
    with pytest.raises(ValueError, match="roots_a: expected 1 indices"):
        traversal.intersects(tree, good, tree, good, roots_a=np.array([len(tree.box)]))
    with pytest.raises(ValueError, match="margin: expected"):
        traversal.pairs(tree, good, tree, good, margin=-1.0)


def test_contacts_are_those_of_the_intersecting_triangles() -> None:
    a, b = octree.build(*torus(12, 9)), octree.build(*ball(10))
    pose_a, pose_b = poses(20, 0.5), poses(20, 1.8, seed=2)
    offsets, found, point, normal, depth = traversal.contacts(a, pose_a, b, pose_b)
    for i in range(20):
        rows = slice(offsets[i], offsets[i + 1])
        left, right = world(a, pose_a[i])[found[rows, 0]], world(b, pose_b[i])[found[rows, 1]]
        number, points, normals, depths = contacts(left, right)
        assert len(number) == len(left)
        for ours, theirs in ((point[rows], points), (normal[rows], normals), (depth[rows], depths)):
            np.testing.assert_array_equal(ours, theirs)
    assert len(depth) > 100


@pytest.mark.parametrize("shape", ["ball", "torus", "soup"])
def test_leaf_boxes_overlap_as_in_brute_force(shape: str) -> None:
    """Poses at which bounding boxes overlap: leaf boxes separate some of them, triangles more."""
    a, b = octree.build(*cube()), octree.build(*SHAPES[shape])
    pose_a, pose_b = poses(60, 0.5), poses(60, 2.2, seed=7)
    hits = traversal.intersects(a, pose_a, b, pose_b, boxes=True)

    def leaves(tree: Octree, pose: Floats) -> tuple[Floats, Floats, Floats]:
        box = tree.box[tree.link[:, 1] == 0]
        r = np.array(matrix(*pose[3:])).reshape(3, 3)
        reach = np.linalg.norm(np.abs(tree.box[0, :3]) + tree.box[0, 3:])
        pad = 16.0 * 2.0**-52 * (np.linalg.norm(pose[:3]) + reach)
        center = np.stack([(r[i, 0] * box[:, 0] + r[i, 1] * box[:, 1] + r[i, 2] * box[:, 2]) + pose[i]
                           for i in range(3)], -1)
        return center, np.tile(r.T, (len(box), 1, 1)), box[:, 3:] + pad

    for i in range(60):
        left, right = leaves(a, pose_a[i]), leaves(b, pose_b[i])
        n, m = len(left[0]), len(right[0])
        pairs = [np.repeat(x, m, axis=0) for x in left] + [np.concatenate([x] * n) for x in right]
        assert hits[i] == obb.intersects(*pairs).any()
    assert (traversal.intersects(a, pose_a, b, pose_b) <= hits).all() and 0 < hits.sum() < 60
