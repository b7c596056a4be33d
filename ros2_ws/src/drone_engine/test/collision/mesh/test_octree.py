"""Octrees: each triangle is in one leaf, boxes are tight, meshes are validated and built once."""

from fractions import Fraction

import numpy as np
import pytest

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.mesh import octree
from drone_engine.collision.mesh.node_boxes import SLACK
from reference.octree_inputs import SHAPES, torus


@pytest.mark.parametrize("shape", [*SHAPES, "copies", "same center", "plate", "spiral"])
def test_every_triangle_is_in_one_leaf_and_inside_all_boxes_above_it(shape: str) -> None:
    rng = np.random.default_rng(3)
    vertices, faces = {
        **SHAPES,
        "copies": (np.eye(3), np.tile([[0, 1, 2]], (500, 1))),
        "same center": ((rng.normal(size=(400, 1, 1)) * (np.eye(3) - 1 / 3)).reshape(-1, 3),
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
            center, half = Fraction(tree.box[node, axis]), Fraction(tree.box[node, 3 + axis])
            assert center - half <= Fraction(inside[:, axis].min()) <= Fraction(inside[:, axis].max()) <= center + half
            size = inside[:, axis].max() - inside[:, axis].min()
            assert tree.box[node, 3 + axis] <= 0.5 * size + 4e-16 * np.abs(inside).max(), "not tight"
        own = tree.node_box[node].astype(np.float64)
        along = (inside - own[9:12]) @ own[:9].reshape(3, 3).T
        assert (np.abs(along) <= own[12:15] + SLACK * np.abs(inside).max()).all()
        if children:
            below = range(child, child + children)
            assert first + count == tree.link[below[-1], 2:].sum() and first == tree.link[child, 2]
            assert tree.link[below, 3].sum() == count
            depth[below] = depth[node] + 1
            seen += below
    assert sorted(seen) == list(range(len(tree.box)))
    assert depth.max() <= octree.MAX_DEPTH
    if shape in ("ball", "torus", "soup"):
        assert tree.link[leaves, 3].max() <= octree.LEAF_SIZE + 24 and depth.max() < 16


def test_the_same_mesh_is_built_once_and_read_only() -> None:
    vertices, faces = torus(6, 5)
    tree = octree.build_cached(vertices, faces)
    assert octree.build_cached(vertices.copy(), faces.astype(np.int32)) is tree
    assert octree.build_cached(vertices * 2.0, faces) is not tree
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
def test_invalid_meshes_are_refused(vertices: Floats, faces: Integers, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        octree.build(vertices, faces)
