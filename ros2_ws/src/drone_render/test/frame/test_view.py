"""Poses, cameras and projections against their geometric meaning."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drone_engine.scene.fields import ORIGIN
from drone_engine.scene.picture import Camera, Orbit
from drone_render.frame import poses, view

ANGLE = st.floats(-3.0, 3.0)
UNIT = np.eye(4)


@given(st.tuples(ANGLE, ANGLE, ANGLE, ANGLE, ANGLE, ANGLE))
def test_a_pose_survives_its_matrix(numbers: tuple[float, float, float, float, float, float]) -> None:
    pose = poses.pose(numbers)
    again = poses.pose_from_matrix(poses.matrices(pose))
    again[3:] *= np.sign(again[3:] @ pose[3:])  # q and -q are the same rotation
    np.testing.assert_allclose(again, pose, atol=1e-9)


def test_roll_pitch_and_yaw_rotate_about_the_axes_of_rep_103() -> None:
    ahead = poses.matrices(poses.pose((0, 0, 0, 0, 0, math.pi / 2)))[:3, 0]
    np.testing.assert_allclose(ahead, [0, 1, 0], atol=1e-12)  # yaw: from forward to the left
    ahead = poses.matrices(poses.pose((0, 0, 0, 0, math.pi / 2, 0)))[:3, 0]
    np.testing.assert_allclose(ahead, [0, 0, -1], atol=1e-12)  # pitch: nose down
    left = poses.matrices(poses.pose((0, 0, 0, math.pi / 2, 0, 0)))[:3, 1]
    np.testing.assert_allclose(left, [0, 0, 1], atol=1e-12)  # roll: left side up


def test_half_way_is_half_the_distance_and_half_the_shorter_rotation() -> None:
    before, after = poses.pose((0, 0, 0, 0, 0, 3.0)), poses.pose((2, 4, -2, 0, 0, -3.0))
    (middle,) = poses.interpolate(before[None], after[None], 0.5)
    np.testing.assert_allclose(middle[:3], [1, 2, -1])
    heading = poses.matrices(middle)[:3, 0]
    np.testing.assert_allclose(heading, [-1, 0, 0], atol=1e-9)  # through pi, not through 0
    (third,) = poses.interpolate(before[None], after[None], 1 / 3)
    turned = math.acos(poses.matrices(third)[:3, 0] @ poses.matrices(before)[:3, 0])
    assert turned == pytest.approx((2 * math.pi - 6) / 3)


def test_the_ends_of_an_interpolation_are_the_states() -> None:
    states = np.array([poses.pose((1, 2, 3, 0.1, 0.2, 0.3)), poses.pose((0, 0, 0, -1, 0.5, 2))])
    after = states[::-1].copy()
    np.testing.assert_allclose(poses.interpolate(states, after, 0.0), states, atol=1e-15)
    np.testing.assert_allclose(poses.interpolate(states, states, 0.7), states, atol=1e-15)


def test_a_level_camera_takes_heading_but_no_tilt() -> None:
    parent = poses.matrices(poses.pose((5, 0, 2, 0.4, -0.3, 1.0)))
    matrix = view.camera_matrix(Camera(pose=(-3, 0, 1, 0, 0, 0), level=True), parent, None, 0.0)
    np.testing.assert_allclose(matrix[:3, 2], [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(matrix[:3, 3], [5 - 3 * math.cos(1), -3 * math.sin(1), 3], atol=1e-12)


def test_a_camera_that_looks_at_something_has_it_in_the_middle() -> None:
    target = np.array([7.0, -3.0, 0.5])
    camera = Camera(pose=(1, 2, 4, 0, 0, 0), look_at="thing")
    eye = view.view(view.camera_matrix(camera, UNIT, target, 0.0)) @ [*target, 1]
    np.testing.assert_allclose(eye[:2], 0, atol=1e-12)
    assert eye[2] < 0


def test_an_orbit_keeps_its_radius_and_comes_back() -> None:
    camera = Camera(pose=ORIGIN, orbit=Orbit(radius=3, height=1, period=8))
    parent = poses.matrices(poses.pose((10, 0, 0, 0, 0, 0)))
    places = [view.camera_matrix(camera, parent, None, time)[:3, 3] for time in (0.0, 2.0, 8.0)]
    np.testing.assert_allclose(places[0], [13, 0, 1])
    np.testing.assert_allclose(places[1], [10, 3, 1], atol=1e-12)
    np.testing.assert_allclose(places[2], places[0], atol=1e-12)


def test_projection_and_camera_info_agree() -> None:
    camera = Camera(size=(320, 200), fov=1.0)
    point = np.array([5.0, 0.7, -0.4])  # ahead, left, up
    clip = view.projection(camera) @ view.view(UNIT) @ [*point, 1]
    drawn = (clip[:2] / clip[3] + 1) / 2 * [320, 200] - 0.5  # pixel centers have integer coordinates; row 0 is the top
    optical = np.linalg.inv(poses.matrices(view.OPTICAL)) @ [*point, 1]
    expected = view.intrinsics(camera) @ optical[:3]
    np.testing.assert_allclose(drawn, expected[:2] / expected[2], atol=1e-9)
    assert drawn[0] < 160 and drawn[1] > 100  # to the left and below the middle


def test_visible_points_are_inside_the_frustum() -> None:
    planes = view.frustum(view.projection(Camera(near=0.1, far=50)) @ view.view(UNIT))
    inside = planes @ [10, 0, 0, 1]
    assert (inside > 0).all()
    for outside in ([-1, 0, 0, 1], [60, 0, 0, 1], [1, 3, 0, 1], [1, 0, -3, 1]):
        assert (planes @ outside < 0).any()
