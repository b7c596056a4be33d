"""What exact arithmetic says about boxes and spheres: Python's integers over one power of two, no rounding anywhere.

Shares no code with what it judges. A pair takes about 0.1 ms, ten times as much where exponents are far apart.
"""

from collections.abc import Iterable, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Vector = Sequence[int]
Floats = NDArray[np.float64]
Booleans = NDArray[np.bool_]


def integers(numbers: Iterable[float]) -> tuple[list[int], int]:
    """The numbers times the least power of two that makes all of them whole, and this power."""
    ratios = [float(number).as_integer_ratio() for number in numbers]
    power = max(denominator for _, denominator in ratios)
    return [numerator * (power // denominator) for numerator, denominator in ratios], power


def cross(u: Vector, v: Vector) -> Vector:
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def dot(u: Vector, v: Vector) -> int:
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def boxes_touch(center_a: Floats, axes_a: Floats, half_a: Floats, center_b: Floats, axes_b: Floats,
                half_b: Floats) -> bool:
    """Whether two boxes have a point in common; shapes (3,), (3, 3) with an axis a row, (3,).

    They do if the offset of their centres is in the sum of the segments +-half_k axis_k. Where these span all of
    space, the faces of that sum are parallel to two axes each; where not, the unit vectors, as segments of no length,
    complete them.
    """
    numbers, axis_power = integers([*axes_a.flat, *axes_b.flat])
    axes: list[Vector] = [tuple(numbers[i : i + 3]) for i in range(0, 18, 3)]
    half, half_power = integers([*half_a, *half_b])
    centers, center_power = integers([*center_a, *center_b])
    # Offset and half times axis have to be in the same unit.
    offset = [(b - a) * axis_power * half_power for a, b in zip(centers[:3], centers[3:], strict=True)]
    edges = [tuple(h * x * center_power for x in axis) for h, axis in zip(half, axes, strict=True)]
    spanning = any(dot(cross(axes[i], axes[i + 1]), axes[i + 2]) for i in (0, 3))
    for u, v in combinations(axes if spanning else [*axes, (1, 0, 0), (0, 1, 0), (0, 0, 1)], 2):
        normal = cross(u, v)
        if abs(dot(normal, offset)) > sum(abs(dot(normal, edge)) for edge in edges):
            return False
    return True


def spheres_touch(center_a: Floats, radius_a: float, center_b: Floats, radius_b: float) -> bool:
    """Whether two balls have a point in common."""
    numbers, _ = integers([*center_a, *center_b, radius_a, radius_b])
    return sum((b - a) ** 2 for a, b in zip(numbers[:3], numbers[3:6], strict=True)) <= (numbers[6] + numbers[7]) ** 2


def all_boxes_touch(*boxes: Floats) -> Booleans:
    """The same for n pairs: (n, 3), (n, 3, 3), (n, 3) twice."""
    return np.array([boxes_touch(*pair) for pair in zip(*boxes, strict=True)], np.bool_)


def all_spheres_touch(*spheres: Floats) -> Booleans:
    """The same for n pairs: (n, 3), (n,) twice."""
    return np.array([spheres_touch(*pair) for pair in zip(*spheres, strict=True)], np.bool_)
