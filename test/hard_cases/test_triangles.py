"""Triangle against triangle: each answer is that of exact arithmetic on the same float64 numbers."""

import itertools
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine.arrays import Floats
from drone_engine.collision.triangle import intersection as triangle
from reference import triangle_oracle
from reference.triangle_families import FAMILIES

SAMPLE = 2000  # pairs per family; a quarter of that where the oracle's integers have a thousand bits

Corners = list[list[float]]


def expected(a: Floats, b: Floats) -> list[bool]:
    return [triangle_oracle.intersects(x, y) for x, y in zip(a.tolist(), b.tolist(), strict=True)]


@pytest.mark.parametrize("family", FAMILIES)
def test_no_answer_differs_from_the_oracle(family: str) -> None:
    count = SAMPLE // 4 if family == "tiny_and_huge" else SAMPLE
    a, b = FAMILIES[family](np.random.default_rng(zlib.crc32(family.encode())), count)
    answers = expected(a, b)
    assert 0.05 < np.mean(answers) < 0.95, "nearly all pairs of the family have the same answer"
    np.testing.assert_array_equal(triangle.intersects(a, b), answers)


@pytest.mark.parametrize("family", FAMILIES)
def test_swapping_and_permuting_change_nothing(family: str) -> None:
    a, b = FAMILIES[family](np.random.default_rng(5), 300)
    answers = triangle.intersects(a, b)
    for order in itertools.permutations(range(3)):
        np.testing.assert_array_equal(triangle.intersects(a[:, order], b), answers)
        np.testing.assert_array_equal(triangle.intersects(b, a[:, order]), answers)


def corners(number: st.SearchStrategy[float]) -> st.SearchStrategy[Corners]:
    return st.lists(st.lists(number, min_size=3, max_size=3), min_size=6, max_size=6)


@st.composite
def nudges(draw: st.DrawFn) -> Corners:
    """Corners on a small grid, some of them an ulp off, near the origin or far from it."""
    grid = draw(corners(st.integers(-2, 2).map(float)))
    offset = draw(st.sampled_from([0.0, 1e6, 1 / 3]))
    steps = draw(st.lists(st.integers(-1, 1), min_size=18, max_size=18))
    moved = np.array(grid) + offset
    up = np.nextafter(moved, np.copysign(np.inf, np.reshape(steps, (6, 3))))
    result: Corners = np.where(np.reshape(steps, (6, 3)) == 0, moved, up).tolist()
    return result


@given(corners(st.integers(-2, 2).map(float)))
@settings(max_examples=300, deadline=None)
def test_small_whole_coordinates(six: Corners) -> None:
    agree(six)


@given(nudges())
@settings(max_examples=300, deadline=None)
def test_an_ulp_off_a_grid(six: Corners) -> None:
    agree(six)


@given(corners(st.floats(allow_nan=False, allow_infinity=False)))
@settings(max_examples=100, deadline=None)
def test_any_finite_numbers(six: Corners) -> None:
    agree(six)


def agree(six: Corners) -> None:
    a, b = np.array([six[:3]]), np.array([six[3:]])
    answer = triangle_oracle.intersects(six[:3], six[3:])
    assert bool(triangle.intersects(a, b)[0]) == answer
    assert bool(triangle.intersects(b, a)[0]) == answer
