"""Poses, cameras and projections, in NumPy alone.

A pose is (..., 7) float64: x y z in m and a quaternion x y z w. Matrices are (..., 4, 4) and turn column vectors.
Bodies and cameras look along +x with z up (REP-103); the eye of OpenGL looks along -z with y up.
"""

import math

import numpy as np
import numpy.typing as npt

from drone_engine.scene.fields import Pose
from drone_engine.scene.picture import Camera

Array = npt.NDArray[np.float64]

EYE_FROM_CAMERA = np.array([[0, -1, 0, 0], [0, 0, 1, 0], [-1, 0, 0, 0], [0, 0, 0, 1]], dtype=np.float64)
ORIGIN = np.array([0.0, 0, 0, 0, 0, 0, 1])
OPTICAL = np.array([0.0, 0, 0, -0.5, 0.5, -0.5, 0.5])  # pose of the optical frame (z ahead, y down) in the camera's


def pose(numbers: Pose) -> Array:
    """The pose, (7,), of x, y, z, roll, pitch, yaw."""
    x, y, z, roll, pitch, yaw = numbers
    (sr, sp, sy), (cr, cp, cy) = ([turn(half / 2) for half in (roll, pitch, yaw)] for turn in (math.sin, math.cos))
    return np.array([
        x, y, z,
        sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy,
    ])  # fmt: skip


def matrices(poses: Array) -> Array:
    """Matrices (..., 4, 4) of poses (..., 7): from the pose's frame to the one that it is given in."""
    x, y, z, w = np.moveaxis(poses[..., 3:], -1, 0)
    result = np.zeros((*poses.shape[:-1], 4, 4))
    result[..., 0, 0] = 1 - 2 * (y * y + z * z)
    result[..., 0, 1] = 2 * (x * y - z * w)
    result[..., 0, 2] = 2 * (x * z + y * w)
    result[..., 1, 0] = 2 * (x * y + z * w)
    result[..., 1, 1] = 1 - 2 * (x * x + z * z)
    result[..., 1, 2] = 2 * (y * z - x * w)
    result[..., 2, 0] = 2 * (x * z - y * w)
    result[..., 2, 1] = 2 * (y * z + x * w)
    result[..., 2, 2] = 1 - 2 * (x * x + y * y)
    result[..., :3, 3] = poses[..., :3]
    result[..., 3, 3] = 1.0
    return result


def pose_of(matrix: Array) -> Array:
    """The pose, (7,), of a matrix (4, 4) that turns and moves only (Shepperd 1978)."""
    m = matrix[:3, :3]
    squares = np.array([m[0, 0], m[1, 1], m[2, 2], np.trace(m)])  # the largest keeps the division well conditioned
    i = int(np.argmax(squares))
    if i == 3:
        turn = [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1 + squares[3]]
    else:
        j, k = (i + 1) % 3, (i + 2) % 3
        turn = [0.0, 0.0, 0.0, m[k, j] - m[j, k]]
        turn[i] = 1 + m[i, i] - m[j, j] - m[k, k]
        turn[j], turn[k] = m[j, i] + m[i, j], m[k, i] + m[i, k]
    return np.concatenate([matrix[:3, 3], np.array(turn) / np.linalg.norm(turn)])


def interpolate(before: Array, after: Array, fraction: float) -> Array:
    """Poses (n, 7) between two states: positions on a line, turns on the shorter arc at an even rate (slerp)."""
    result = before + fraction * (after - before)
    cosine = np.einsum("ni,ni->n", before[:, 3:], after[:, 3:])
    angle = np.arccos(np.minimum(np.abs(cosine), 1.0))
    sine = np.sin(angle)
    turns = sine > 1e-6  # below, the two are one and the same
    scale = np.where(turns, sine, 1.0)
    first = np.where(turns, np.sin((1 - fraction) * angle) / scale, 1 - fraction)
    second = np.where(turns, np.sin(fraction * angle) / scale, fraction) * np.where(cosine < 0, -1.0, 1.0)
    result[:, 3:] = first[:, None] * before[:, 3:] + second[:, None] * after[:, 3:]
    result[:, 3:] /= np.linalg.norm(result[:, 3:], axis=1, keepdims=True)
    return result


def turns(camera: Camera) -> bool:
    """Whether the camera moves against its parent, so that its transform changes from picture to picture."""
    return camera.level or camera.look_at is not None or camera.orbit is not None


def camera_matrix(camera: Camera, parent: Array, target: Array | None, time: float) -> Array:
    """Where a camera is in the world, (4, 4), at `time` in s.

    parent: matrix of its parent, or the unit matrix; target: position (3,) of what it looks at, or None.
    """
    base = parent
    if camera.level:
        base = matrices(pose((*parent[:3, 3], 0.0, 0.0, math.atan2(parent[1, 0], parent[0, 0]))))
    base = base @ matrices(pose(camera.pose))
    position = base[:3, 3]
    if camera.orbit is not None:
        centre, angle = position, 2 * math.pi * math.fmod(time / camera.orbit.period, 1.0)
        reach = np.array([math.cos(angle), math.sin(angle), 0.0]) * camera.orbit.radius
        position = centre + reach + [0.0, 0.0, camera.orbit.height]
        target = centre if target is None else target
    return base if target is None else look(position, target)


def look(position: Array, target: Array) -> Array:
    """Matrix (4, 4) of a camera at `position` that looks at `target` with its horizon level."""
    x, y, z = target - position
    return matrices(pose((*position, 0.0, -math.atan2(z, math.hypot(x, y)), math.atan2(y, x))))


def view(camera: Array) -> Array:
    """From the world to the eye of OpenGL, (4, 4), for a camera at the matrix `camera`."""
    turn = camera[:3, :3].T
    inverse = np.eye(4)
    inverse[:3, :3], inverse[:3, 3] = turn, -turn @ camera[:3, 3]
    return EYE_FROM_CAMERA @ inverse


def projection(camera: Camera) -> Array:
    """From the eye to clip space, (4, 4). y is turned over, so that the first row read back is the top row."""
    width, height = camera.size
    focal = 1 / math.tan(camera.fov / 2)
    near, far = camera.near, camera.far
    return np.array([
        [focal, 0, 0, 0],
        [0, -focal * width / height, 0, 0],
        [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)],
        [0, 0, -1, 0],
    ])  # fmt: skip


def intrinsics(camera: Camera) -> Array:
    """The camera matrix K, (3, 3): from the optical frame to pixels, whose centres have whole numbers."""
    width, height = camera.size
    focal = width / 2 / math.tan(camera.fov / 2)
    return np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])


def frustum(clip: Array) -> Array:
    """The six planes (6, 4) of what a camera sees, pointing inwards; clip: projection @ view (Gribb and Hartmann)."""
    planes = np.concatenate([clip[3] + clip[:3], clip[3] - clip[:3]])
    return np.asarray(planes / np.linalg.norm(planes[:, :3], axis=1, keepdims=True))
