"""Cameras: their poses in the world, projections and frustums.

Bodies and cameras look along +x with z up (REP-103); the eye frame of OpenGL looks along -z with y up. The optical
frame of ROS has z ahead and y down. Matrices are (4, 4) and transform column vectors.
"""

import math

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.scene.picture import Camera
from drone_render.frame.poses import matrices, pose

EYE_FROM_CAMERA = np.array([[0, -1, 0, 0], [0, 0, 1, 0], [-1, 0, 0, 0], [0, 0, 0, 1]], dtype=np.float64)
OPTICAL = np.array([0.0, 0, 0, -0.5, 0.5, -0.5, 0.5])  # pose of the optical frame in the camera's frame


def moves_in_parent(camera: Camera) -> bool:
    """Whether the camera moves relative to its parent, so that its transform changes from picture to picture."""
    return camera.level or camera.look_at is not None or camera.orbit is not None


def camera_matrix(camera: Camera, parent: Floats, target: Floats | None, time: float) -> Floats:
    """Matrix (4, 4) of a camera in the world at `time` in s.

    parent: matrix (4, 4) of its parent, the unit matrix if it has none; target: position (3,) of the object that it
    looks at, or None.
    """
    base = parent
    if camera.level:
        base = matrices(pose((*parent[:3, 3], 0.0, 0.0, math.atan2(parent[1, 0], parent[0, 0]))))
    base = base @ matrices(pose(camera.pose))
    position = base[:3, 3]
    if camera.orbit is not None:
        center, angle = position, 2 * math.pi * math.fmod(time / camera.orbit.period, 1.0)
        offset = np.array([math.cos(angle), math.sin(angle), 0.0]) * camera.orbit.radius
        position = center + offset + [0.0, 0.0, camera.orbit.height]
        target = center if target is None else target
    return base if target is None else look_at(position, target)


def look_at(position: Floats, target: Floats) -> Floats:
    """Matrix (4, 4) of a camera at `position` (3,) that looks at `target` (3,) with a level horizon."""
    x, y, z = target - position
    return matrices(pose((*position, 0.0, -math.atan2(z, math.hypot(x, y)), math.atan2(y, x))))


def view(camera: Floats) -> Floats:
    """Matrix (4, 4) from the world to the eye frame, for a camera with the matrix `camera` (4, 4)."""
    rotation = camera[:3, :3].T
    inverse = np.eye(4)
    inverse[:3, :3], inverse[:3, 3] = rotation, -rotation @ camera[:3, 3]
    return EYE_FROM_CAMERA @ inverse


def projection(camera: Camera) -> Floats:
    """Matrix (4, 4) from the eye frame to clip space. y is negated, so the first row read back is the top row."""
    width, height = camera.size
    focal = 1 / math.tan(camera.fov / 2)
    near, far = camera.near, camera.far
    return np.array([
        [focal, 0, 0, 0],
        [0, -focal * width / height, 0, 0],
        [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)],
        [0, 0, -1, 0],
    ])  # fmt: skip


def intrinsics(camera: Camera) -> Floats:
    """Camera matrix K (3, 3): from the optical frame to pixels, whose centers have integer coordinates."""
    width, height = camera.size
    focal = width / 2 / math.tan(camera.fov / 2)
    return np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])


def frustum(clip: Floats) -> Floats:
    """The six planes (6, 4) of a view frustum, normals pointing inwards; clip: projection @ view.

    After Gribb and Hartmann (2001), Fast Extraction of Viewing Frustum Planes.
    """
    planes = np.concatenate([clip[3] + clip[:3], clip[3] - clip[:3]])
    return np.asarray(planes / np.linalg.norm(planes[:, :3], axis=1, keepdims=True))
