"""Formulas of unit quaternions (x, y, z, w), as ROS orders them. Plain Python: importing this loads no compiler.

A quaternion rotates vectors of the body frame into the world frame.
"""

import math
from typing import Any

Quaternion = tuple[float, float, float, float]


def from_rpy(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Quaternion of a rotation about the fixed x, then y, then z axis, in rad (REP-103)."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return (sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy)


def matrix(x: Any, y: Any, z: Any, w: Any) -> tuple[Any, Any, Any, Any, Any, Any, Any, Any, Any]:
    """Rotation matrix of a unit quaternion, row by row: m00, m01, m02, m10, ... m22.

    Its columns are the axes of the body in the world. Takes numbers, or arrays of equal shapes.
    """
    return (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w),
            2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w),
            2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y))
