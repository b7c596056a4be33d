"""Arrays of poses, quaternions and vectors, in NumPy. Importing this loads no compiler.

A pose is x y z in m and a unit quaternion x y z w; all functions accept leading axes and broadcast them.
"""

from collections.abc import Iterable

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.math.quaternion import from_rpy, matrix

Rpy = tuple[float, float, float, float, float, float]  # x, y, z in m; roll, pitch, yaw in rad


def poses_from_rpy(rows: Iterable[Rpy]) -> Floats:
    """Poses (n, 7) of n rows x, y, z, roll, pitch, yaw, as scene files have them."""
    return np.array([(*row[:3], *from_rpy(*row[3:])) for row in rows], np.float64).reshape(-1, 7)


def matrices(quaternions: Floats) -> Floats:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4); the columns are the body's axes in the world."""
    elements: Floats = np.stack(matrix(*np.moveaxis(np.asarray(quaternions), -1, 0)), axis=-1)
    return elements.reshape(*elements.shape[:-1], 3, 3)


def matrix_from_rpy(roll: float, pitch: float, yaw: float) -> Floats:
    """Rotation matrix (3, 3) of a rotation about the fixed x, then y, then z axis, in rad: Rz Ry Rx."""
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x)


def compose(poses_a: Floats, poses_b: Floats) -> Floats:
    """Poses b (..., 7), given in the frames of the poses a (..., 7), in the parent frame of a."""
    out = np.empty(np.broadcast_shapes(poses_a.shape, poses_b.shape))
    out[..., :3] = poses_a[..., :3] + rotate_all(poses_a[..., 3:], poses_b[..., :3])
    xyz_a, w_a, xyz_b, w_b = poses_a[..., 3:6], poses_a[..., 6:], poses_b[..., 3:6], poses_b[..., 6:]
    out[..., 3:6] = w_a * xyz_b + w_b * xyz_a + np.cross(xyz_a, xyz_b)
    out[..., 6:] = w_a * w_b - (xyz_a * xyz_b).sum(-1, keepdims=True)
    return out


def rotate_all(quaternions: Floats, vectors: Floats) -> Floats:
    """Vectors (..., 3) of the body frames in the world frame; unit quaternions (..., 4)."""
    axis, w = quaternions[..., :3], quaternions[..., 3:]
    t = 2.0 * np.cross(axis, vectors)
    rotated: Floats = vectors + w * t + np.cross(axis, t)
    return rotated


def inverse(quaternions: Floats) -> Floats:
    """Conjugates (..., 4) of unit quaternions (..., 4): the inverse rotations."""
    conjugate: Floats = quaternions * np.array([-1.0, -1.0, -1.0, 1.0])
    return conjugate
