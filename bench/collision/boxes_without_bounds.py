"""The box intersection kernel without error bounds, to measure the cost of exact answers."""

import numba
import numpy as np

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.box.sat import BLOCK, gaps_of_column

ROWS = 27  # offset 0, half extents 3 and 6, axes 9 and 18


@numba.njit(error_model="numpy")
def _gather(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, table):
    """Copies `count` pairs from `first` on into the table, one row of BLOCK numbers per component."""
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
def _test_block(table, result):
    """Writes for each pair of the table whether no axis separates it: 1 or 0."""
    for k in range(BLOCK):
        gap = gaps_of_column(table, k)
        result[k] = max(gap[0], gap[1], gap[2], gap[3], gap[4], gap[5], gap[6], gap[7], gap[8], gap[9], gap[10],
                         gap[11], gap[12], gap[13], gap[14]) <= 0.0


@numba.njit(error_model="numpy")
def _test_all(center_a, axes_a, half_a, center_b, axes_b, half_b, hit):
    """Whether each pair intersects: flat arrays of centers, axes and half extents; hit (n,) is the output."""
    table, result = np.zeros(ROWS * BLOCK), np.empty(BLOCK, np.uint8)
    for first in range(0, len(hit), BLOCK):
        count = min(BLOCK, len(hit) - first)
        _gather(first, count, center_a, axes_a, half_a, center_b, axes_b, half_b, table)
        _test_block(table, result)
        for k in range(count):
            hit[first + k] = result[k]


def intersects(*boxes: Floats) -> Booleans:
    """Like box.intersects, for contiguous arrays of the right shapes, and subject to rounding."""
    hit = np.empty(len(boxes[0]), np.bool_)
    _test_all(*[*(array.reshape(-1) for array in boxes), hit.view(np.uint8)])
    return hit
