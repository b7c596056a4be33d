"""Rotations: one formula for numbers, arrays and kernels."""

import math

import numpy as np

from drone_engine.math import quaternion, rotation
from drone_engine.math.poses import compose, inverse, matrices, matrix_from_rpy, poses_from_rpy, rotate_all

ANGLES = [(0.3, -0.8, 2.1), (0.0, 0.0, 0.0), (-3.0, 1.5, -0.2), (0.0, math.pi / 2, 0.0)]


def test_roll_pitch_yaw_are_rotations_about_fixed_axes() -> None:
    for rpy in ANGLES:
        x, y, z, w = quaternion.from_rpy(*rpy)
        np.testing.assert_allclose(matrices(np.array([x, y, z, w])), matrix_from_rpy(*rpy), atol=1e-15)
    assert quaternion.from_rpy(0.0, 0.0, math.pi / 2) == (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))


def test_the_compiled_matrix_is_that_of_arrays_bit_for_bit() -> None:
    quaternions = np.array([quaternion.from_rpy(*rpy) for rpy in ANGLES])
    compiled = np.array([rotation.matrix(*q) for q in quaternions.tolist()]).reshape(-1, 3, 3)
    np.testing.assert_array_equal(matrices(quaternions), compiled)
    np.testing.assert_array_equal(matrices(quaternions.reshape(2, 2, 4)), compiled.reshape(2, 2, 3, 3))


def test_poses_compose_as_their_matrices_do() -> None:
    a, b = poses_from_rpy([(1, 2, 3, *ANGLES[0])]), poses_from_rpy([(-1, 0.5, 2, *ANGLES[2])])
    both = compose(a, b)
    np.testing.assert_allclose(matrices(both[:, 3:]), matrices(a[:, 3:]) @ matrices(b[:, 3:]), atol=1e-15)
    np.testing.assert_allclose(both[0, :3], a[0, :3] + matrices(a[0, 3:]) @ b[0, :3])
    np.testing.assert_allclose(rotate_all(inverse(a[:, 3:]), rotate_all(a[:, 3:], b[:, :3])), b[:, :3])
