"""Triangles against triangles: what plain geometry says."""

import numpy as np
import pytest

from drone_engine.arrays import Floats
from drone_engine.collision.triangle import intersection as triangle

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


def test_contact_of_a_tip_in_a_face() -> None:
    number, point, normal, depth = triangle.contacts(
        np.array([FLAT, FLAT], np.float64), np.array([[[1, 1, 5], [1, 1, 6], [2, 1, 6]],
                                                      [[1, 1, -0.25], [1, 1, 1], [2, 1, 1]]], np.float64))
    assert number.tolist() == [1]
    np.testing.assert_allclose(point, [[1.1, 1, 0]])  # the middle of the cut from (1, 1, 0) to (1.2, 1, 0)
    np.testing.assert_allclose(normal, [[0, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(depth, [0.25])


def test_contact_takes_the_shorter_way_out() -> None:
    a = np.array([FLAT], np.float64)
    b = np.array([[[0.125, 1, -3], [0.125, 1, 3], [0.125, 2, 3]]])  # 3 m through a, but only 0.125 m from its side
    _, _, normal, depth = triangle.contacts(a, b)
    np.testing.assert_allclose(normal, [[-1, 0, 0]], atol=1e-15)
    assert depth.tolist() == [0.125]


@pytest.mark.parametrize(("a", "b"), [
    (FLAT, [[1, 1, 0], [9, 1, 0], [1, 9, 0]]),  # in one plane
    (FLAT, FLAT),
    (FLAT, [[1, 1, -1], [1, 1, 1], [1, 1, 0]]),  # a segment
    (FLAT, [[1, 1, 0], [1, 1, 0], [1, 1, 0]]),  # a point
    ([[0, 0, 0], [2, 2, 2], [1, 1, 1]], [[0, 2, 1], [2, 0, 1], [1, 1, 1]]),  # two segments
    ([[0, 0, 0], [2, 2, 2], [1, 1, 1]], [[1, 1, 1], [3, 3, 3], [2, 2, 2]]),  # on one line
    ([[0, 0, 1], [0, 0, 1], [0, 0, 1]], [[0, 0, 1], [0, 0, 1], [0, 0, 1]]),
])
def test_degenerate_contacts_are_contacts(a: object, b: object) -> None:
    first, second = np.array([a], np.float64), np.array([b], np.float64)
    number, point, normal, depth = triangle.contacts(first, second)
    assert number.tolist() == [0]
    assert np.linalg.norm(normal) == pytest.approx(1.0)
    assert 0.0 <= depth[0] <= 1.0
    for corners in (first, second):
        gap, _, _ = triangle.distances(corners, np.repeat(point[:, None], 3, axis=1))
        assert gap[0] < 1e-12


@pytest.mark.parametrize("offset", [0.0, 1e4])
def test_contact_point_is_on_both_and_the_depth_is_the_way_out(offset: float) -> None:
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, 3000, 3, 3)) + offset
    number, point, normal, depth = triangle.contacts(a, b)
    assert len(number) > 300
    for corners in (a[number], b[number]):
        gap, _, _ = triangle.distances(corners, np.repeat(point[:, None], 3, axis=1))
        assert gap.max() < 1e-9
    assert not triangle.intersects(a[number], b[number] + (normal * (depth[:, None] + 1e-9))[:, None]).any()
    back = triangle.contacts(b, a)
    np.testing.assert_array_equal(back[0], number)
    np.testing.assert_allclose(back[1], point, atol=1e-9)
    np.testing.assert_array_equal(back[2], -normal)
    np.testing.assert_array_equal(back[3], depth)


@pytest.mark.parametrize(("other", "gap"), [
    ([[1, 1, 2], [1, 1, 3], [2, 1, 3]], 2.0),  # a corner above the face
    ([[5, 0, 0], [6, 0, 0], [5, 1, 1]], 1.0),  # corner to corner
    ([[2, -1, -1], [2, -1, 1], [2, -5, 0]], 1.0),  # edge to edge
    ([[3, 3, -1], [3, 3, 1], [9, 9, 0]], 2**0.5),  # edge to the slanting edge
    ([[1, 1, 7], [1, 1, 7], [1, 1, 7]], 7.0),  # a point
    ([[-3, 0, 4], [9, 0, 4], [3, 0, 4]], 4.0),  # a parallel segment
    ([[1, 1, -1], [1, 1, 1], [2, 1, 1]], 0.0),  # through the face
])
def test_distance(other: object, gap: float) -> None:
    a, b = np.array([FLAT], np.float64), np.array([other], np.float64)
    distance, at_a, at_b = triangle.distances(a, b)
    assert distance[0] == pytest.approx(gap)
    assert np.linalg.norm(at_a - at_b) == pytest.approx(gap)


def test_no_point_is_closer() -> None:
    """The plane across the closest points has one triangle on each side of it."""
    rng = np.random.default_rng(2)
    a, b = rng.normal(size=(2, 3000, 3, 3))
    b[::3, 2] = b[::3, 1]  # segments
    b[1::3, 1] = b[1::3, 0] + a[1::3, 1] - a[1::3, 0]  # parallel edges
    distance, at_a, at_b = triangle.distances(a, b)
    np.testing.assert_array_equal(distance == 0.0, triangle.intersects(a, b))
    np.testing.assert_allclose(np.linalg.norm(at_b - at_a, axis=1), distance, atol=1e-14)
    across = (at_b - at_a) / np.where(distance > 0.0, distance, 1.0)[:, None]
    assert np.einsum("nij,nj->ni", a - at_a[:, None], across).max() < 1e-9
    assert np.einsum("nij,nj->ni", b - at_b[:, None], across).min() > -1e-9
