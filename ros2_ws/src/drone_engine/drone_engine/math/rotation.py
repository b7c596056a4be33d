"""Compiled functions of unit quaternions (x, y, z, w) and vectors: numbers in, tuples of numbers out."""

import math

from drone_engine.kernel import inlined, kernel
from drone_engine.math import quaternion

SERIES_LIMIT = 1.0 / 16.0  # square of half the angle, rad^2, up to which the series below are exact to rounding

matrix = inlined(quaternion.matrix)


@inlined
def rotate(x, y, z, w, vx, vy, vz):
    """Rotates a vector (vx, vy, vz) from the body frame into the world frame by the quaternion (x, y, z, w)."""
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return (vx + w * tx + y * tz - z * ty, vy + w * ty + z * tx - x * tz, vz + w * tz + x * ty - y * tx)


@inlined
def multiply(ax, ay, az, aw, bx, by, bz, bw):
    """Hamilton product of the quaternions a and b: the rotation b, then a, both about axes of the world."""
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by + ay * bw + az * bx - ax * bz,
            aw * bz + az * bw + ax * by - ay * bx, aw * bw - ax * bx - ay * by - az * bz)


@inlined
def normalized(x, y, z, w):
    """The quaternion scaled to length 1."""
    scale = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    return x * scale, y * scale, z * scale, w * scale


@kernel
def integrate_rotation(x, y, z, w, wx, wy, wz, h):
    """Orientation after h s at the angular velocity (wx, wy, wz), rad/s in the world; exact if that is constant.

    Exponential map: q' = exp(h w / 2) q. Returns a unit quaternion (x, y, z, w).
    """
    square = 0.25 * h * h * (wx * wx + wy * wy + wz * wz)
    if square <= SERIES_LIMIT:
        return integrate_small_rotation(x, y, z, w, wx, wy, wz, h)
    half = math.sqrt(square)
    return _multiplied(x, y, z, w, wx, wy, wz, 0.5 * h * math.sin(half) / half, math.cos(half))


@inlined
def integrate_small_rotation(x, y, z, w, wx, wy, wz, h):
    """integrate_rotation where the square of half the angle is at most SERIES_LIMIT: by series, without branches."""
    u = 0.25 * h * h * (wx * wx + wy * wy + wz * wz)
    s = 1.0 - u * (1 / 6 - u * (1 / 120 - u * (1 / 5040 - u * (1 / 362880 - u * (1 / 39916800)))))
    c = 1.0 - u * (1 / 2 - u * (1 / 24 - u * (1 / 720 - u * (1 / 40320 - u * (1 / 3628800 - u * (1 / 479001600))))))
    return _multiplied(x, y, z, w, wx, wy, wz, 0.5 * h * s, c)


@inlined
def _multiplied(x, y, z, w, wx, wy, wz, s, c):
    """Product of the quaternion with vector part s (wx, wy, wz) and scalar part c, and (x, y, z, w), normalized."""
    nx, ny, nz, nw = multiply(s * wx, s * wy, s * wz, c, x, y, z, w)
    return normalized(nx, ny, nz, nw)
