"""Whether boxes touch, by the same separating axes in the same blocks without bounds: to tell what exactness costs."""

import numba
import numpy as np

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.box.sat import BLOCK, gaps_of_column

ROWS = 27  # offset 0, half extents 3 and 6, axes 9 and 18


@numba.njit(error_model="numpy")
def _gather(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, table):
    for k in range(count):
        for i in range(3):
            at = np.uint64(3 * (first + k) + i)
            table[i * BLOCK + k] = center_b[at] - center_a[at]
            table[(3 + i) * BLOCK + k] = half_a[at]
            table[(6 + i) * BLOCK + k] = half_b[at]
        for i in range(9):
            at = np.uint64(9 * (first + k) + i)
            table[(9 + i) * BLOCK + k] = axes_a[at]
            table[(18 + i) * BLOCK + k] = axes_b[at]


@numba.njit(error_model="numpy")
def _judge(table, verdict):
    for k in range(BLOCK):
        gap = gaps_of_column(table, k)
        verdict[k] = max(gap[0], gap[1], gap[2], gap[3], gap[4], gap[5], gap[6], gap[7], gap[8], gap[9], gap[10],
                         gap[11], gap[12], gap[13], gap[14]) <= 0.0


@numba.njit(error_model="numpy")
def _decide(center_a, axes_a, half_a, center_b, axes_b, half_b, hit):
    table, verdict = np.zeros(ROWS * BLOCK), np.empty(BLOCK, np.uint8)
    for first in range(0, len(hit), BLOCK):
        count = min(BLOCK, len(hit) - first)
        _gather(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, table)
        _judge(table, verdict)
        for k in range(count):
            hit[first + k] = verdict[k]


def intersects(*boxes: Floats) -> Booleans:
    """As obb.intersects, for arrays of the right shapes, and right but for rounding."""
    hit = np.empty(len(boxes[0]), np.bool_)
    _decide(*[*(array.reshape(-1) for array in boxes), hit.view(np.uint8)])
    return hit
