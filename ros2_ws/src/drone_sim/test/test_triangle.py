"""Triangles against triangles: what plain geometry says."""

import numpy as np
import pytest

from drone_sim.arrays import Floats
from drone_sim.collision import triangle

FLAT = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]


def meet(a: object, b: object) -> bool:
    """Both ways round, which must agree."""
    first, second = np.array([a], np.float64), np.array([b], np.float64)
    answer = bool(triangle.intersects(first, second)[0])
    assert bool(triangle.intersects(second, first)[0]) == answer
    return answer


@pytest.mark.parametrize(("other", "answer"), [
    ([[1, 1, -1], [1, 1, 1], [2, 1, 1]], True),  # through the middle
    ([[3, 3, -1], [3, 3, 1], [4, 4, 0]], False),  # beside it
    ([[1, 1, 0], [1, 1, 1], [2, 1, 1]], True),  # a corner on the face
    ([[1, 1, 5e-324], [1, 1, 1], [2, 1, 1]], False),  # by the smallest number there is above it
    ([[-1, -1, 0], [1, -1, 0], [0, 0, 0]], True),  # in the plane, corner on corner
    ([[1, 1, 0], [1.5, 1, 0], [1, 1.5, 0]], True),  # in the plane, inside
    ([[-1, -1, 0], [9, -1, 0], [-1, 9, 0]], True),  # in the plane, around
    ([[3, 3, 0], [4, 3, 0], [3, 4, 0]], False),  # in the plane, beside
    ([[0, 0, 1], [4, 0, 1], [0, 4, 1]], False),  # parallel
    ([[0, 0, 0], [4, 0, 0], [0, 0, 4]], True),  # a common edge
    ([[2, 2, -1], [2, 2, 1], [2, 2, 0]], True),  # a segment through the long edge
    ([[2, 3, -1], [2, 3, 1], [2, 3, 0]], False),  # a segment beside it
    ([[1, 1, 0], [1, 1, 0], [1, 1, 0]], True),  # a point on the face
    ([[1, 1, 1], [1, 1, 1], [1, 1, 1]], False),  # a point above it
])
def test_a_triangle_in_the_plane(other: object, answer: bool) -> None:
    assert meet(FLAT, other) == answer


@pytest.mark.parametrize(("a", "b", "answer"), [
    ([[0, 0, 0], [2, 2, 2], [1, 1, 1]], [[0, 2, 1], [2, 0, 1], [1, 1, 1]], True),  # crossing
    ([[0, 0, 0], [2, 2, 2], [1, 1, 1]], [[0, 2, 0], [2, 0, 1], [2, 0, 1]], False),  # skew
    ([[0, 0, 0], [1, 1, 1], [0, 0, 0]], [[1, 1, 1], [3, 3, 3], [2, 2, 2]], True),  # end to end
    ([[0, 0, 0], [1, 1, 1], [0, 0, 0]], [[2, 2, 2], [3, 3, 3], [2, 2, 2]], False),  # on one line, apart
    ([[1, 1, 1]] * 3, [[1, 1, 1]] * 3, True),
    ([[1, 1, 1]] * 3, [[1, 1, 1 + 2.0**-52]] * 3, False),
])
def test_segments_and_points(a: object, b: object, answer: bool) -> None:
    assert meet(a, b) == answer


@pytest.mark.parametrize("scale", [1e-320, 1e-200, 1e200, 1e307])
def test_size_does_not_matter(scale: float) -> None:
    flat = np.array(FLAT) * scale
    assert meet(flat, np.array([[1, 1, -1], [1, 1, 1], [2, 1, 1]]) * scale)
    assert not meet(flat, np.array([[3, 3, -1], [3, 3, 1], [4, 4, 0]]) * scale)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_named(wrong: float) -> None:
    good = np.zeros((3, 3, 3))
    bad = good.copy()
    bad[1, 2, 0] = wrong
    with pytest.raises(ValueError, match=r"finite corners expected, b\[1\]"):
        triangle.intersects(good, bad)


def test_large_numbers_are_finite() -> None:
    large = np.full((4, 3, 3), 1.7e308)
    assert triangle.intersects(large, large).all()


@pytest.mark.parametrize(("a", "b", "message"), [
    (np.zeros((2, 3)), np.zeros((1, 3, 3)), r"a of shape \(n, 3, 3\) expected, \(2, 3\) came"),
    (np.zeros((1, 3, 3)), np.zeros((1, 3, 2)), r"b of shape \(n, 3, 3\) expected, \(1, 3, 2\) came"),
    (np.zeros((1, 3, 3)), np.zeros((2, 3, 3)), "as many a as b expected, 1 and 2 came"),
])
def test_shapes(a: Floats, b: Floats, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        triangle.intersects(a, b)


def test_no_pair_has_no_answer() -> None:
    assert triangle.intersects(np.empty((0, 3, 3)), np.empty((0, 3, 3))).shape == (0,)
