"""Exact signs against rational arithmetic."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine.collision import exact_arithmetic

any_number = st.floats(allow_nan=False, allow_infinity=False)
small_integers = st.integers(-4, 4).map(float)
nudged = st.builds(lambda x, up: math.nextafter(x, math.inf if up else -math.inf), small_integers, st.booleans())


def sign_of(value: Fraction) -> int:
    return (value > 0) - (value < 0)


@settings(max_examples=500, deadline=None)
@given(st.lists(st.tuples(st.sampled_from([1, -1]), any_number, any_number, any_number, any_number), max_size=8))
def test_a_sum_of_products_has_its_exact_sign(terms: list[tuple[int, float, float, float, float]]) -> None:
    acc = exact_arithmetic.zeros()
    total = Fraction(0)
    for sign, *factors in terms:
        exact_arithmetic.add_product(acc, sign, *factors)
        total += sign * math.prod(map(Fraction, factors))
    assert exact_arithmetic.sign(acc) == sign_of(total)
    assert exact_arithmetic.sign(acc) == 0  # cleared


@settings(max_examples=300, deadline=None)
@given(st.lists(any_number, min_size=3, max_size=3), st.lists(any_number, min_size=3, max_size=3))
def test_cancellation_down_to_the_last_bit_is_detected(a: list[float], b: list[float]) -> None:
    acc = exact_arithmetic.zeros()
    exact_arithmetic.add_product(acc, 1, *a, 1.0)
    exact_arithmetic.add_product(acc, -1, *a, 1.0)
    assert exact_arithmetic.sign(acc) == 0
    exact_arithmetic.add_product(acc, 1, *b, 1.0)
    exact_arithmetic.add_product(acc, 1, 5e-324, 5e-324, 5e-324, 5e-324)
    exact_arithmetic.add_product(acc, -1, *b, 1.0)
    assert exact_arithmetic.sign(acc) == 1


@pytest.mark.parametrize("extreme", [5e-324, 2.2e-308, 1.7976931348623157e308])
def test_four_extremes_neither_overflow_nor_vanish(extreme: float) -> None:
    acc = exact_arithmetic.zeros()
    for sign in (1, -1):
        for _ in range(1000):
            exact_arithmetic.add_product(acc, sign, *[extreme] * 4)
        assert exact_arithmetic.sign(acc) == sign


@settings(max_examples=300, deadline=None)
@given(st.lists(st.one_of(nudged, small_integers), min_size=12, max_size=12))
def test_orientation_in_space(numbers: list[float]) -> None:
    a, b, c, d = (list(map(Fraction, numbers[i:i + 3])) for i in range(0, 12, 3))
    u, v, w = ([p - q for p, q in zip(x, a, strict=True)] for x in (b, c, d))
    det = (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]))
    assert exact_arithmetic.orient3d(*numbers) == sign_of(det)


@settings(max_examples=300, deadline=None)
@given(st.lists(st.one_of(nudged, small_integers), min_size=6, max_size=6))
def test_orientation_in_the_plane(numbers: list[float]) -> None:
    ax, ay, bx, by, cx, cy = map(Fraction, numbers)
    assert exact_arithmetic.orient2d(*numbers) == sign_of((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))


def test_nearly_coplanar_points_far_away_which_floating_point_gets_wrong() -> None:
    base = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.25, 0.5, 0]]) + 1e6
    assert exact_arithmetic.orient3d(*base.ravel()) == 0
    base[3, 2] = np.nextafter(base[3, 2], np.inf)
    assert exact_arithmetic.orient3d(*base.ravel()) == 1
