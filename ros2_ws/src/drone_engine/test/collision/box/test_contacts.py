"""Contacts of boxes with boxes and with planes, against geometry."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine.collision.box import obb, plane, sat
from drone_engine.collision.placement import set_all_axes
from drone_engine.world import World

Contact = tuple[int, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def contact(pose_a: np.ndarray, half_a: np.ndarray, pose_b: np.ndarray, half_b: np.ndarray,
            margin: float = 0.0) -> Contact:
    """Number of points, normal, points, separations, features; a pose is x y z qx qy qz qw."""
    poses = np.array([pose_a, pose_b], float)
    axes = np.empty((2, 3, 3))
    set_all_axes(poses[:, 3:], axes)
    points, normal, point, separation = np.zeros(1, np.int64), np.zeros((1, 3)), np.zeros((1, 8, 3)), np.zeros((1, 8))
    feature = np.zeros((1, 8), np.int64)
    boxes = obb.Boxes(poses[:, :3], axes, np.array([half_a, half_b], float))
    count = obb.contact(boxes, 0, boxes, 1, margin, 0, points, normal, point, separation, feature, obb.scratch())
    return count, normal[0], point[0, :count], separation[0, :count], feature[0, :count]


def pose(x: float, y: float, z: float, turn: tuple[float, float, float] = (0, 0, 0)) -> np.ndarray:
    """A pose; turn: rotation vector, rad."""
    angle = float(np.linalg.norm(turn))
    axis = np.array(turn) / angle if angle else np.zeros(3)
    return np.array([x, y, z, *(axis * np.sin(angle / 2)), np.cos(angle / 2)])


CUBE = np.array([0.5, 0.5, 0.5])


def test_face_on_face_has_four_corners_and_the_depth() -> None:
    count, normal, point, separation, _ = contact(pose(0, 0, 0), CUBE, pose(0.2, 0.1, 0.95), CUBE)
    assert count == 4
    np.testing.assert_allclose(normal, [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(separation, -0.05, atol=1e-12)
    np.testing.assert_allclose(np.sort(point[:, 0]), [-0.3, -0.3, 0.5, 0.5], atol=1e-12)
    np.testing.assert_allclose(point[:, 2], 0.475, atol=1e-12)


def test_rotated_face_on_face_has_eight_corners() -> None:
    count, normal, point, separation, feature = contact(pose(0, 0, 0), CUBE, pose(0, 0, 0.99, (0, 0, np.pi / 4)), CUBE)
    assert count == 8
    assert len(set(feature.tolist())) == 8
    np.testing.assert_allclose(normal, [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(separation, -0.01, atol=1e-12)
    assert np.abs(point[:, :2]).max() == pytest.approx(0.5)


def test_edge_on_edge_has_one_point() -> None:
    b = pose(0, 0, np.sqrt(2) - 0.02, (np.pi / 4, 0, 0))
    count, normal, point, separation, _ = contact(pose(0, 0, 0, (0, np.pi / 4, 0)), CUBE, b, CUBE)
    assert count == 1
    np.testing.assert_allclose(normal, [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(point[0], [0, 0, np.sqrt(0.5) - 0.01], atol=1e-12)
    assert separation[0] == pytest.approx(-0.02)


def test_apart_by_more_than_the_margin_is_no_contact() -> None:
    assert contact(pose(0, 0, 0), CUBE, pose(1.01, 0, 0), CUBE)[0] == 0
    count, normal, _, separation, _ = contact(pose(0, 0, 0), CUBE, pose(1.01, 0, 0), CUBE, margin=0.02)
    assert count == 4
    np.testing.assert_allclose(separation, 0.01, atol=1e-12)
    np.testing.assert_allclose(normal, [1, 0, 0], atol=1e-12)


def directions(pose_a: np.ndarray, half_a: np.ndarray, pose_b: np.ndarray,
               half_b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All directions (n, 3) in which b may separate from a, and the gaps between the boxes along each, (n,)."""
    axes = np.empty((2, 3, 3))
    set_all_axes(np.array([pose_a, pose_b])[:, 3:], axes)
    edges = np.cross(axes[0][:, None], axes[1][None]).reshape(9, 3)
    edges = edges[np.sum(edges**2, axis=1) >= sat.PARALLEL]
    lines = np.vstack([*axes, edges / np.linalg.norm(edges, axis=1, keepdims=True)])
    both = np.vstack([lines, -lines])
    reach = np.abs(both @ axes[0].T) @ half_a + np.abs(both @ axes[1].T) @ half_b
    return both, both @ (pose_b - pose_a)[:3] - reach


number = st.floats(-1, 1)
vector = st.tuples(number, number, number)
size = st.tuples(*[st.floats(0.05, 1)] * 3)


@given(vector, vector, size, vector, vector, size)
@settings(max_examples=300, deadline=None)
def test_swapping_the_boxes_reverses_the_normal(
        pa: tuple, ta: tuple, ha: tuple, pb: tuple, tb: tuple, hb: tuple) -> None:
    a, b = (pose(*pa, ta), np.array(ha)), (pose(*pb, tb), np.array(hb))
    first, second = contact(*a, *b), contact(*b, *a)
    assert (first[0] > 0) == (second[0] > 0)
    if not first[0]:
        return
    assert np.linalg.norm(first[1]) == pytest.approx(1.0)
    assert first[3].min() == pytest.approx(second[3].min(), abs=0.02)  # faces are preferred slightly
    normals, apart = directions(*a, *b)
    best = np.argmax(apart)
    others = np.linalg.norm(normals - normals[best], axis=1) > 1e-9
    if apart[others].max() < apart[best] - sat.FACE_PREFERENCE * min(*ha, *hb) - 1e-9:  # no tie
        np.testing.assert_allclose(first[1], normals[best], atol=1e-6)
        np.testing.assert_allclose(second[1], -normals[best], atol=1e-6)
        assert first[3].min() == pytest.approx(second[3].min(), abs=1e-9)


@given(vector, vector, size, vector, vector, size)
@settings(max_examples=300, deadline=None)
def test_moving_apart_along_the_normal_by_the_depth_ends_the_contact(
        pa: tuple, ta: tuple, ha: tuple, pb: tuple, tb: tuple, hb: tuple) -> None:
    count, normal, _, separation, _ = contact(pose(*pa, ta), np.array(ha), pose(*pb, tb), np.array(hb))
    if count:
        moved = np.array(pb) + normal * (1e-9 - separation.min())
        assert contact(pose(*pa, ta), np.array(ha), pose(*moved, tb), np.array(hb))[0] == 0


def test_contacts_of_a_box_with_a_plane_are_its_lowest_corners() -> None:
    axes = np.empty((1, 3, 3))
    set_all_axes(pose(0, 0, 0)[None, 3:], axes)
    point, separation, feature = np.zeros((8, 3)), np.zeros(8), np.zeros(8, np.int64)
    count = plane.contact(np.array([[1.0, 2.0, 0.49]]), axes, CUBE[None], 0, 0.0, 0.001, point, separation, feature)
    assert count == 4
    np.testing.assert_allclose(separation[:4], -0.01, atol=1e-12)
    np.testing.assert_allclose(point[:4].mean(0), [1, 2, -0.005], atol=1e-12)


def test_more_contacts_than_the_buffers_hold_are_not_cut_short(world: Callable[..., World]) -> None:
    poses = ", ".join(f"[{x}, {y}, {0.6 * z}]" for x in range(5) for y in range(5) for z in range(5))
    busy = world(f"floor: {{model: floor, static: true, collision: {{level: floor}}}}\n"
                 f"crate: {{model: crate, mass: 1, poses: [{poses}]}}")
    busy.step()
    assert busy.contact_counts()["obb"] == 125
    assert len(busy.events) == 125
