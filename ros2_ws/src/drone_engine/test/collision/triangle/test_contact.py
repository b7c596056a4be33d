"""Contacts, distances and closest points of triangles that are known from elementary geometry."""

import numpy as np
import pytest

from drone_engine.collision.triangle import contact
from drone_engine.collision.triangle.intersection import intersects

FLAT = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]


def test_contact_of_a_corner_in_a_face() -> None:
    number, point, normal, depth = contact.contacts(
        np.array([FLAT, FLAT], np.float64), np.array([[[1, 1, 5], [1, 1, 6], [2, 1, 6]],
                                                      [[1, 1, -0.25], [1, 1, 1], [2, 1, 1]]], np.float64))
    assert number.tolist() == [1]
    np.testing.assert_allclose(point, [[1.1, 1, 0]])  # the middle of the cut from (1, 1, 0) to (1.2, 1, 0)
    np.testing.assert_allclose(normal, [[0, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(depth, [0.25])


def test_contact_normal_is_the_shorter_way_out() -> None:
    a = np.array([FLAT], np.float64)
    b = np.array([[[0.125, 1, -3], [0.125, 1, 3], [0.125, 2, 3]]])  # 3 m through a, but 0.125 m over its side
    _, _, normal, depth = contact.contacts(a, b)
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
    number, point, normal, depth = contact.contacts(first, second)
    assert number.tolist() == [0]
    assert np.linalg.norm(normal) == pytest.approx(1.0)
    assert 0.0 <= depth[0] <= 1.0
    for corners in (first, second):
        gap, _, _ = contact.distances(corners, np.repeat(point[:, None], 3, axis=1))
        assert gap[0] < 1e-12


@pytest.mark.parametrize("offset", [0.0, 1e4])
def test_contact_point_is_on_both_and_a_move_by_the_depth_separates_them(offset: float) -> None:
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, 3000, 3, 3)) + offset
    number, point, normal, depth = contact.contacts(a, b)
    assert len(number) > 300
    for corners in (a[number], b[number]):
        gap, _, _ = contact.distances(corners, np.repeat(point[:, None], 3, axis=1))
        assert gap.max() < 1e-9
    assert not intersects(a[number], b[number] + (normal * (depth[:, None] + 1e-9))[:, None]).any()
    back = contact.contacts(b, a)
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
    distance, at_a, at_b = contact.distances(a, b)
    assert distance[0] == pytest.approx(gap)
    assert np.linalg.norm(at_a - at_b) == pytest.approx(gap)


def test_no_points_are_closer_than_the_closest_points() -> None:
    """The planes through the closest points, perpendicular to their connection, have one triangle on each side."""
    rng = np.random.default_rng(2)
    a, b = rng.normal(size=(2, 3000, 3, 3))
    b[::3, 2] = b[::3, 1]  # segments
    b[1::3, 1] = b[1::3, 0] + a[1::3, 1] - a[1::3, 0]  # parallel edges
    distance, at_a, at_b = contact.distances(a, b)
    np.testing.assert_array_equal(distance == 0.0, intersects(a, b))
    np.testing.assert_allclose(np.linalg.norm(at_b - at_a, axis=1), distance, atol=1e-14)
    across = (at_b - at_a) / np.where(distance > 0.0, distance, 1.0)[:, None]
    assert np.einsum("nij,nj->ni", a - at_a[:, None], across).max() < 1e-9
    assert np.einsum("nij,nj->ni", b - at_b[:, None], across).min() > -1e-9
