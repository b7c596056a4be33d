"""The kernel that decides blocks of boxes, without what makes it exact: to tell what exactness costs."""

import inspect
from typing import Any

import numba
import numpy as np

from drone_sim.arrays import Booleans, Floats
from drone_sim.collision import obb
from drone_sim.collision.obb import BLOCK, ROWS

BOUNDS = ("size", "shape", "negative", "known", "volume", "tolerance")  # words of lines that serve the error bound


def _stripped(name: str) -> Any:
    """A kernel of obb.py compiled without the lines that serve the error bound, any gap above 0 being one."""
    lines = inspect.getsource(getattr(obb, name).py_func).splitlines()[1:]
    docs = [i for i, line in enumerate(lines) if '"""' in line]
    kept = [line for line in lines[docs[-1] + 1 :] if not any(word in line for word in BOUNDS) or "verdict[k]" in line]
    body = [line.split("=")[0] + "= gap <= 0.0" if "verdict[k]" in line else line for line in kept]
    scope = dict(vars(obb))
    exec("\n".join([lines[0], *body]), scope)
    return numba.njit(error_model="numpy")(scope[name])


_gather, _judge = _stripped("_gather"), _stripped("_judge")


@numba.njit(error_model="numpy")
def _decide(center_a, axes_a, half_a, center_b, axes_b, half_b, hit):  # type: ignore[no-untyped-def]
    table, verdict = np.zeros(ROWS * BLOCK), np.empty(BLOCK, np.uint8)
    for first in range(0, len(hit), BLOCK):
        count = min(BLOCK, len(hit) - first)
        p, q, r, s = 3 * first, 3 * (first + count), 9 * first, 9 * (first + count)
        _gather(count, center_a[p:q], axes_a[r:s], half_a[p:q], center_b[p:q], axes_b[r:s], half_b[p:q], table)
        _judge(table, verdict)
        for k in range(count):
            hit[first + k] = verdict[k]


def intersects(*boxes: Floats) -> Booleans:
    """As obb.intersects, for arrays of the right shapes, and right but for rounding."""
    hit = np.empty(len(boxes[0]), np.bool_)
    _decide(*[array.reshape(-1) for array in boxes], hit.view(np.uint8))
    return hit
