"""Quaternions (x, y, z, w) as ROS has them, and vectors: scalars and tuples in, scalars and tuples out."""

import math

import numpy as np
from numpy.typing import NDArray

from drone_engine.kernel import inlined, kernel

Quaternion = tuple[float, float, float, float]
LITTLE = 1.0 / 16.0  # square of half an angle, in rad, up to which short series have all digits


def from_rpy(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Rotation about the fixed x, then y, then z axis, in rad (REP-103)."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return (sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy)


@inlined
def matrix(x, y, z, w):
    """Rows of the rotation matrix, nine numbers: m00 m01 m02 m10 ... m22; columns are the body's axes in the world."""
    return (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w),
            2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w),
            2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y))


@inlined
def rotate(x, y, z, w, vx, vy, vz):
    """The vector v, given in the body, in the world."""
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return (vx + w * tx + y * tz - z * ty, vy + w * ty + z * tx - x * tz, vz + w * tz + x * ty - y * tx)


@kernel
def turned(x, y, z, w, wx, wy, wz, h):
    """The unit quaternion after h s at the angular velocity (wx, wy, wz), rad/s in the world: exact if it is constant.

    Exponential map: q' = exp(h w / 2) q.
    """
    square = 0.25 * h * h * (wx * wx + wy * wy + wz * wz)
    if square <= LITTLE:
        return turned_little(x, y, z, w, wx, wy, wz, h)
    half = math.sqrt(square)
    return _turned(x, y, z, w, wx, wy, wz, 0.5 * h * math.sin(half) / half, math.cos(half))


@inlined
def turned_little(x, y, z, w, wx, wy, wz, h):
    """The same where the square of half the angle is at most LITTLE, by series, without branches."""
    u = 0.25 * h * h * (wx * wx + wy * wy + wz * wz)
    s = 1.0 - u * (1 / 6 - u * (1 / 120 - u * (1 / 5040 - u * (1 / 362880 - u * (1 / 39916800)))))
    c = 1.0 - u * (1 / 2 - u * (1 / 24 - u * (1 / 720 - u * (1 / 40320 - u * (1 / 3628800 - u * (1 / 479001600))))))
    return _turned(x, y, z, w, wx, wy, wz, 0.5 * h * s, c)


@inlined
def _turned(x, y, z, w, wx, wy, wz, s, c):
    """The quaternion (s w, c) q, made a unit one again."""
    ax, ay, az = s * wx, s * wy, s * wz
    nx = c * x + ax * w + ay * z - az * y
    ny = c * y + ay * w + az * x - ax * z
    nz = c * z + az * w + ax * y - ay * x
    nw = c * w - ax * x - ay * y - az * z
    norm = 1.0 / math.sqrt(nx * nx + ny * ny + nz * nz + nw * nw)
    return (nx * norm, ny * norm, nz * norm, nw * norm)


def compose(poses_a: NDArray[np.float64], poses_b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses b, given in the frames a, in a's parent frame; (n, 7) each: x y z qx qy qz qw."""
    out = np.empty(np.broadcast_shapes(poses_a.shape, poses_b.shape))
    out[..., :3] = poses_a[..., :3] + rotate_all(poses_a[..., 3:], poses_b[..., :3])
    xyz_a, w_a, xyz_b, w_b = poses_a[..., 3:6], poses_a[..., 6:], poses_b[..., 3:6], poses_b[..., 6:]
    out[..., 3:6] = w_a * xyz_b + w_b * xyz_a + np.cross(xyz_a, xyz_b)
    out[..., 6:] = w_a * w_b - (xyz_a * xyz_b).sum(-1, keepdims=True)
    return out


def rotate_all(quaternions: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors (n, 3) of the bodies' frames in the world; quaternions: (n, 4)."""
    axis, w = quaternions[..., :3], quaternions[..., 3:]
    t = 2.0 * np.cross(axis, vectors)
    turned_vectors: NDArray[np.float64] = vectors + w * t + np.cross(axis, t)
    return turned_vectors


def inverse(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """The opposite rotations; unit quaternions (n, 4)."""
    conjugate: NDArray[np.float64] = quaternions * np.array([-1.0, -1.0, -1.0, 1.0])
    return conjugate
