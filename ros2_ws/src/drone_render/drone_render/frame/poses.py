"""Poses and transformation matrices.

A pose is (..., 7) float64: x y z in m and a unit quaternion x y z w, of a child in its parent's frame. A matrix is
(..., 4, 4), transforms column vectors, and leads from the child's frame to the parent's.
"""

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.math.poses import matrices as rotation_matrices
from drone_engine.math.poses import poses_from_rpy
from drone_engine.scene.fields import Pose

ORIGIN = np.array([0.0, 0, 0, 0, 0, 0, 1])


def pose(numbers: Pose) -> Floats:
    """Pose (7,) of x, y, z in m and roll, pitch, yaw in rad, as scene files have them."""
    row: Floats = poses_from_rpy([numbers])[0]
    return row


def matrices(poses: Floats) -> Floats:
    """Matrices (..., 4, 4) of poses (..., 7)."""
    result = np.zeros((*poses.shape[:-1], 4, 4))
    result[..., :3, :3] = rotation_matrices(poses[..., 3:])
    result[..., :3, 3] = poses[..., :3]
    result[..., 3, 3] = 1.0
    return result


def pose_from_matrix(matrix: Floats) -> Floats:
    """Pose (7,) of a rigid transformation (4, 4), by the method of Shepperd (1978)."""
    m = matrix[:3, :3]
    squares = np.array([m[0, 0], m[1, 1], m[2, 2], np.trace(m)])  # the largest keeps the division well conditioned
    i = int(np.argmax(squares))
    if i == 3:
        quaternion = [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1 + squares[3]]
    else:
        j, k = (i + 1) % 3, (i + 2) % 3
        quaternion = [0.0, 0.0, 0.0, m[k, j] - m[j, k]]
        quaternion[i] = 1 + m[i, i] - m[j, j] - m[k, k]
        quaternion[j], quaternion[k] = m[j, i] + m[i, j], m[k, i] + m[i, k]
    return np.concatenate([matrix[:3, 3], np.array(quaternion) / np.linalg.norm(quaternion)])


def interpolate(before: Floats, after: Floats, fraction: float) -> Floats:
    """Poses (n, 7) between `before` and `after`, (n, 7) each, at a fraction from 0 to 1.

    Positions move on a straight line, orientations along the shorter arc at a constant rate (slerp).
    """
    result = before + fraction * (after - before)
    cosine = np.einsum("ni,ni->n", before[:, 3:], after[:, 3:])
    angle = np.arccos(np.minimum(np.abs(cosine), 1.0))
    sine = np.sin(angle)
    differs = sine > 1e-6  # below, both orientations are equal within rounding
    scale = np.where(differs, sine, 1.0)
    first = np.where(differs, np.sin((1 - fraction) * angle) / scale, 1 - fraction)
    second = np.where(differs, np.sin(fraction * angle) / scale, fraction) * np.where(cosine < 0, -1.0, 1.0)
    result[:, 3:] = first[:, None] * before[:, 3:] + second[:, None] * after[:, 3:]
    result[:, 3:] /= np.linalg.norm(result[:, 3:], axis=1, keepdims=True)
    return result
