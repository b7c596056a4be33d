"""Intersection tests of triangles whose answers are known from elementary geometry."""

import numpy as np
import pytest

from drone_engine.arrays import Floats
from drone_engine.collision.triangle import intersection

FLAT = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]


def intersect(a: object, b: object) -> bool:
    """The answer for a and b, which must be that for b and a."""
    first, second = np.array([a], np.float64), np.array([b], np.float64)
    answer = bool(intersection.intersects(first, second)[0])
    assert bool(intersection.intersects(second, first)[0]) == answer
    return answer


@pytest.mark.parametrize(("other", "answer"), [
    ([[1, 1, -1], [1, 1, 1], [2, 1, 1]], True),  # through the middle
    ([[3, 3, -1], [3, 3, 1], [4, 4, 0]], False),  # beside it
    ([[1, 1, 0], [1, 1, 1], [2, 1, 1]], True),  # a corner on the face
    ([[1, 1, 5e-324], [1, 1, 1], [2, 1, 1]], False),  # above it by the smallest positive number
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
def test_triangle_against_one_in_the_xy_plane(other: object, answer: bool) -> None:
    assert intersect(FLAT, other) == answer


@pytest.mark.parametrize(("a", "b", "answer"), [
    ([[0, 0, 0], [2, 2, 2], [1, 1, 1]], [[0, 2, 1], [2, 0, 1], [1, 1, 1]], True),  # crossing
    ([[0, 0, 0], [2, 2, 2], [1, 1, 1]], [[0, 2, 0], [2, 0, 1], [2, 0, 1]], False),  # skew
    ([[0, 0, 0], [1, 1, 1], [0, 0, 0]], [[1, 1, 1], [3, 3, 3], [2, 2, 2]], True),  # end to end
    ([[0, 0, 0], [1, 1, 1], [0, 0, 0]], [[2, 2, 2], [3, 3, 3], [2, 2, 2]], False),  # on one line, apart
    ([[1, 1, 1]] * 3, [[1, 1, 1]] * 3, True),
    ([[1, 1, 1]] * 3, [[1, 1, 1 + 2.0**-52]] * 3, False),
])
def test_degenerate_triangles(a: object, b: object, answer: bool) -> None:
    assert intersect(a, b) == answer


@pytest.mark.parametrize("scale", [1e-320, 1e-200, 1e200, 1e307])
def test_answers_do_not_depend_on_size(scale: float) -> None:
    flat = np.array(FLAT) * scale
    assert intersect(flat, np.array([[1, 1, -1], [1, 1, 1], [2, 1, 1]]) * scale)
    assert not intersect(flat, np.array([[3, 3, -1], [3, 3, 1], [4, 4, 0]]) * scale)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite_are_refused(wrong: float) -> None:
    good = np.zeros((3, 3, 3))
    bad = good.copy()
    bad[1, 2, 0] = wrong
    with pytest.raises(ValueError, match=r"triangle: b\[1\]: expected finite numbers, got"):
        intersection.intersects(good, bad)


def test_large_finite_numbers_are_accepted() -> None:
    large = np.full((4, 3, 3), 1.7e308)
    assert intersection.intersects(large, large).all()


@pytest.mark.parametrize(("a", "b", "message"), [
    (np.zeros((2, 3)), np.zeros((1, 3, 3)), r"triangle: a: expected shape \(n, 3, 3\), got \(2, 3\)"),
    (np.zeros((1, 3, 3)), np.zeros((1, 3, 2)), r"triangle: b: expected shape \(n, 3, 3\), got \(1, 3, 2\)"),
    (np.zeros((1, 3, 3)), np.zeros((2, 3, 3)), "expected as many triangles in b as in a, 1, got 2"),
])
def test_wrong_shapes_are_refused(a: Floats, b: Floats, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        intersection.intersects(a, b)


def test_no_pairs_give_no_answers() -> None:
    assert intersection.intersects(np.empty((0, 3, 3)), np.empty((0, 3, 3))).shape == (0,)
