"""Octrees hold every triangle once, and two of them find exactly what all pairs of triangles would."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box import box as obb
from drone_engine.collision.mesh import octree, traversal
from drone_engine.collision.mesh.octree import Octree
from drone_engine.collision.triangle import intersection as triangle
from drone_engine.math.rotation import matrix

Mesh = tuple[Floats, Integers]


def torus(around: int, across: int, major: float = 1.0, minor: float = 0.35) -> Mesh:
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2.0 * np.pi * u / around, 2.0 * np.pi * v / across
    vertices = np.stack([(major + minor * np.cos(b)) * np.cos(a), (major + minor * np.cos(b)) * np.sin(a),
                         minor * np.sin(b)], -1).reshape(-1, 3)
    i, j, k, m = ((p % around * across + q % across).ravel()
                  for p, q in ((u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)))
    return vertices, np.concatenate([np.stack([i, j, k], -1), np.stack([i, k, m], -1)])


def ball(around: int, radius: float = 1.0) -> Mesh:
    """A sphere of latitudes and longitudes; its poles are triangles without an area."""
    a, b = np.meshgrid(np.arange(around + 1) * np.pi / around, np.arange(around) * 2.0 * np.pi / around, indexing="ij")
    vertices = radius * np.stack([np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)], -1).reshape(-1, 3)
    u, v = (x.ravel() for x in np.meshgrid(np.arange(around), np.arange(around), indexing="ij"))
    i, j, k, m = (p * around + q % around for p, q in ((u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)))
    return vertices, np.concatenate([np.stack([i, j, k], -1), np.stack([i, k, m], -1)])


def cube() -> Mesh:
    vertices = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    return vertices, np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                               [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def soup(count: int, seed: int = 0) -> Mesh:
    """Triangles of all sizes anywhere: needles, copies, and some that are a segment or a point."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-4, -0.5, (count, 1, 1))
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(size=(count, 3, 3)) * size
    corners[::9, 2] = corners[::9, 1]
    corners[::13] = corners[::13, :1]
    corners[1::11] = corners[2:3]
    corners[5::10, 1] = corners[5::10, 0] + 1e-9 * rng.normal(size=corners[5::10, 1].shape)
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def poses(count: int, distance: float, seed: int = 1) -> Floats:
    rng = np.random.default_rng(seed)
    turn = rng.normal(size=(count, 4))
    shift = rng.normal(size=(count, 3))
    shift *= distance * rng.uniform(0.2, 1.0, (count, 1)) / np.linalg.norm(shift, axis=1, keepdims=True)
    return np.concatenate([shift, turn / np.linalg.norm(turn, axis=1, keepdims=True)], axis=1)


def at(*pose: float) -> Floats:
    return np.array([[*pose, 0.0, 0.0, 0.0, 1.0][:7]])


def world(tree: Octree, pose: Floats) -> Floats:
    """The corners that answers are exact for, each operation rounded."""
    r, c = np.array(matrix(*pose[3:])).reshape(3, 3), tree.corners
    return np.stack([(r[i, 0] * c[..., 0] + r[i, 1] * c[..., 1] + r[i, 2] * c[..., 2]) + pose[i] for i in range(3)], -1)


def brute_force(a: Octree, pose_a: Floats, b: Octree, pose_b: Floats) -> Booleans:
    """Which triangles meet, (m_a, m_b), each pair on its own."""
    left, right = world(a, pose_a), world(b, pose_b)
    return triangle.intersects(np.repeat(left, len(right), axis=0),
                               np.tile(right, (len(left), 1, 1))).reshape(len(left), len(right))


def sets(offsets: Integers, pairs: Integers) -> list[set[tuple[int, int]]]:
    found = [[(int(i), int(j)) for i, j in pairs[first:last]]
             for first, last in pairwise(offsets)]
    assert all(len(set(some)) == len(some) for some in found), "a pair came twice"
    return [set(some) for some in found]


SHAPES = {"ball": ball(10), "torus": torus(12, 9), "cube": cube(), "soup": soup(150),
          "one": (np.eye(3), np.array([[0, 1, 2]]))}


@pytest.mark.parametrize("shape", [*SHAPES, "copies", "same centre", "plate", "spiral"])
def test_every_triangle_stands_in_one_leaf_and_in_all_boxes_above_it(shape: str) -> None:
    rng = np.random.default_rng(3)
    vertices, faces = {
        **SHAPES,
        "copies": (np.eye(3), np.tile([[0, 1, 2]], (500, 1))),
        "same centre": ((rng.normal(size=(400, 1, 1)) * (np.eye(3) - 1 / 3)).reshape(-1, 3),
                        np.arange(1200).reshape(-1, 3)),
        "plate": (np.column_stack([rng.normal(size=(300, 2)), np.full(300, 0.1)]), rng.integers(0, 300, (400, 3))),
        "spiral": (2.0 ** -np.arange(900.0)[:, None] * np.array([1.0, 0.5, 0.3]), np.arange(900).reshape(-1, 3)),
    }[shape]
    tree = octree.build(vertices, faces)
    assert sorted(tree.face.tolist()) == list(range(len(faces)))
    np.testing.assert_array_equal(tree.corners, np.asarray(vertices)[np.asarray(faces)[tree.face]])
    leaves = np.flatnonzero(tree.link[:, 1] == 0)
    covered = np.concatenate([np.arange(first, first + count) for first, count in tree.link[leaves, 2:]])
    assert sorted(covered.tolist()) == list(range(len(faces)))
    seen, depth = [0], np.zeros(len(tree.box), np.int64)
    for node, (child, children, first, count) in enumerate(tree.link):
        inside = tree.corners[first:first + count].reshape(-1, 3)
        for axis in range(3):
            centre, half = Fraction(tree.box[node, axis]), Fraction(tree.box[node, 3 + axis])
            assert centre - half <= Fraction(inside[:, axis].min()) <= Fraction(inside[:, axis].max()) <= centre + half
            size = inside[:, axis].max() - inside[:, axis].min()
            assert tree.box[node, 3 + axis] <= 0.5 * size + 4e-16 * np.abs(inside).max(), "not tight"
        own = tree.tight[node].astype(np.float64)
        along = (inside - own[9:12]) @ own[:9].reshape(3, 3).T
        assert (np.abs(along) <= own[12:15] + octree.tight.SLACK * np.abs(inside).max()).all()
        if children:
            below = range(child, child + children)
            assert first + count == tree.link[below[-1], 2:].sum() and first == tree.link[child, 2]
            assert tree.link[below, 3].sum() == count
            depth[below] = depth[node] + 1
            seen += below
    assert sorted(seen) == list(range(len(tree.box)))
    assert depth.max() <= octree.DEPTH
    if shape in ("ball", "torus", "soup"):
        assert tree.link[leaves, 3].max() <= octree.LEAF + 24 and depth.max() < 16


@pytest.mark.parametrize("shape_a", SHAPES)
@pytest.mark.parametrize("shape_b", SHAPES)
def test_the_same_triangles_meet_as_in_brute_force(shape_a: str, shape_b: str) -> None:
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
        for turn in ([0, 0, 0, 1], [0, 0, 1, 0], [0.5, 0.5, 0.5, 0.5]):
            pose_a, pose_b = at(far, 0, 0), np.array([[far, 0, 0, *turn]])
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
    """Distances of all triangles by sampling: never below the true ones, above them by less than a sample's spacing."""
    s, t = (x.ravel() for x in np.meshgrid(np.arange(steps + 1) / steps, np.arange(steps + 1) / steps))
    weights = np.stack([s, t, 1 - s - t], -1)[s + t <= 1 + 1e-9]
    return np.array([[np.linalg.norm((weights @ p)[:, None] - (weights @ q)[None], axis=-1).min() for q in right]
                     for p in left])


def test_no_triangle_within_the_margin_is_missed() -> None:
    a, b = octree.build(*cube()), octree.build(*torus(6, 4))
    pose_a, pose_b = poses(6, 0.3), poses(6, 1.9, seed=5)
    near = {margin: sets(*traversal.pairs(a, pose_a, b, pose_b, margin=margin)) for margin in (0.0, 0.05, 0.4)}
    for i in range(len(pose_a)):
        left, right = world(a, pose_a[i]), world(b, pose_b[i])
        distance = distances(left, right)
        turn = np.array(matrix(*pose_a[i, 3:])).reshape(3, 3)
        left, right = left @ turn, right @ turn  # the boxes of a's frame, but for its origin
        apart = np.maximum(left.min(1)[:, None] - right.max(1), right.min(1) - left.max(1)[:, None]).max(-1)
        for margin, some in near.items():
            assert {(int(p), int(q)) for p, q in np.argwhere(distance <= margin)} <= some[i]
            assert len(some[i]) < 0.8 * apart.size
            assert all(apart[p, q] <= margin + 1e-9 for p, q in some[i])


def test_a_ball_flies_through_a_ring() -> None:
    ring, shot = octree.build(*torus(32, 16)), octree.build(*ball(12, radius=0.3))
    way = np.linspace(-2.0, 2.0, 81)
    through = np.concatenate([at(0.0, 0.0, z) for z in way])
    aside = np.concatenate([at(0.8, 0.0, z) for z in way])
    still = np.concatenate([at(0.0, 0.0, 0.0)] * len(way))
    assert not traversal.intersects(ring, still, shot, through).any()
    assert not traversal.intersects(ring, still, shot, through, boxes=True).any()
    touched = traversal.intersects(ring, still, shot, aside)
    assert touched.any() and not touched[0] and not touched[-1]


def test_surfaces_meet_and_not_what_they_enclose() -> None:
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


def test_more_pairs_than_expected_are_all_there_and_the_same_again() -> None:
    """A hundred copies against a hundred: more than the first buffer holds."""
    tree = octree.build(np.eye(3), np.tile([[0, 1, 2]], (100, 1)))
    first = traversal.pairs(tree, at(0.0, 0.0, 0.0), tree, at(0.0, 0.0, 0.0))
    assert len(sets(*first)[0]) == 10_000
    again = traversal.pairs(tree, at(0.0, 0.0, 0.0), tree, at(0.0, 0.0, 0.0))
    assert all(np.array_equal(x, y) for x, y in zip(first, again, strict=True))


@pytest.mark.parametrize("scale", [1e-30, 1e-12, 1e12, 1e25])
def test_any_size_of_meshes(scale: float) -> None:
    vertices, faces = torus(12, 9)
    tree = octree.build(vertices * scale, faces)
    pose_a, pose_b = poses(10, 0.5), poses(10, 2.5, seed=2)
    pose_a[:, :3] *= scale
    pose_b[:, :3] *= scale
    hits = traversal.intersects(tree, pose_a, tree, pose_b)
    assert hits.tolist() == [brute_force(tree, p, tree, q).any() for p, q in zip(pose_a, pose_b, strict=True)]
    assert 0 < hits.sum() < 10


@pytest.mark.parametrize("stretch", [1e-9, 1e-6, 4e-4])
def test_quaternions_that_are_not_quite_of_length_one(stretch: float) -> None:
    tree = octree.build(*torus(12, 9))
    pose_a, pose_b = poses(30, 0.5), poses(30, 2.5, seed=2)
    pose_a[:, 3:] *= 1.0 + stretch
    pose_b[:, 3:] *= 1.0 - stretch
    found = sets(*traversal.pairs(tree, pose_a, tree, pose_b))
    assert [len(some) for some in found] == [brute_force(tree, p, tree, q).sum()
                                             for p, q in zip(pose_a, pose_b, strict=True)]


def test_the_same_mesh_is_built_once() -> None:
    vertices, faces = torus(6, 5)
    tree = octree.of(vertices, faces)
    assert octree.of(vertices.copy(), faces.astype(np.int32)) is tree
    assert octree.of(vertices * 2.0, faces) is not tree
    with pytest.raises(ValueError, match="read-only"):
        tree.box[0, 0] = 1.0


@pytest.mark.parametrize(("vertices", "faces", "message"), [
    (np.zeros((3, 2)), [[0, 1, 2]], r"vertices: expected .* \(v, 3\), got shape \(3, 2\)"),
    ([[0, 0, np.nan]] * 3, [[0, 1, 2]], "vertices: expected finite"),
    ([[0, 0, 1e31]] * 3, [[0, 1, 2]], r"vertices: expected .* up to 1e\+30"),
    (np.eye(3), np.zeros((0, 3), int), "at least one face"),
    (np.eye(3), [[0, 1, 3]], "faces: expected indices from 0 to 2, got 0 to 3"),
    (np.eye(3), [[0, 1, -1]], "got -1 to 1"),
    (np.eye(3), [[0.0, 1.0, 2.0]], "faces: expected integers"),
])
def test_what_is_no_mesh_is_refused(vertices: Floats, faces: Integers, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        octree.build(vertices, faces)


def test_what_is_no_pose_is_refused() -> None:
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


def test_contacts_are_those_of_the_triangles_that_meet() -> None:
    a, b = octree.build(*torus(12, 9)), octree.build(*ball(10))
    pose_a, pose_b = poses(20, 0.5), poses(20, 1.8, seed=2)
    offsets, found, point, normal, depth = traversal.contacts(a, pose_a, b, pose_b)
    for i in range(20):
        rows = slice(offsets[i], offsets[i + 1])
        left, right = world(a, pose_a[i])[found[rows, 0]], world(b, pose_b[i])[found[rows, 1]]
        number, points, normals, depths = triangle.contacts(left, right)
        assert len(number) == len(left)
        for ours, theirs in ((point[rows], points), (normal[rows], normals), (depth[rows], depths)):
            np.testing.assert_array_equal(ours, theirs)
    assert len(depth) > 100


@pytest.mark.parametrize("shape", ["ball", "torus", "soup"])
def test_leaf_boxes_meet_as_in_brute_force(shape: str) -> None:
    """Between triangles that meet and bounds that meet: some pairs are told apart by leaf boxes alone."""
    a, b = octree.build(*cube()), octree.build(*SHAPES[shape])
    pose_a, pose_b = poses(60, 0.5), poses(60, 2.2, seed=7)
    hits = traversal.intersects(a, pose_a, b, pose_b, boxes=True)

    def leaves(tree: Octree, pose: Floats) -> tuple[Floats, Floats, Floats]:
        box = tree.box[tree.link[:, 1] == 0]
        r = np.array(matrix(*pose[3:])).reshape(3, 3)
        reach = np.linalg.norm(np.abs(tree.box[0, :3]) + tree.box[0, 3:])
        pad = 16.0 * 2.0**-52 * (np.linalg.norm(pose[:3]) + reach)
        centre = np.stack([(r[i, 0] * box[:, 0] + r[i, 1] * box[:, 1] + r[i, 2] * box[:, 2]) + pose[i]
                           for i in range(3)], -1)
        return centre, np.tile(r.T, (len(box), 1, 1)), box[:, 3:] + pad

    for i in range(60):
        left, right = leaves(a, pose_a[i]), leaves(b, pose_b[i])
        n, m = len(left[0]), len(right[0])
        pairs = [np.repeat(x, m, axis=0) for x in left] + [np.concatenate([x] * n) for x in right]
        assert hits[i] == obb.intersects(*pairs).any()
    assert (traversal.intersects(a, pose_a, b, pose_b) <= hits).all() and 0 < hits.sum() < 60
