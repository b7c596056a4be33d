"""Pairs of oriented boxes: which of them touch, and where."""

import numpy as np
import pytest

from drone_engine.collision.box.obb import contacts, intersects
from drone_engine.math.rotation import matrix

Boxes = list[np.ndarray]
NAMES = ("center_a", "axes_a", "half_a", "center_b", "axes_b", "half_b")


def near(n: int, seed: int = 0) -> Boxes:
    """Pairs of random boxes, about half of which touch."""
    rng = np.random.default_rng(seed)
    quaternions = rng.normal(size=(2, n, 4))
    quaternions /= np.linalg.norm(quaternions, axis=-1, keepdims=True)
    axes = np.array([[np.array(matrix(*q)).reshape(3, 3).T for q in side] for side in quaternions]).reshape(2, n, 3, 3)
    half = rng.uniform(0.1, 1.0, (2, n, 3))
    center = rng.normal(size=(n, 3))
    way = rng.normal(size=(n, 3))
    way *= rng.uniform(0.6, 1.5, (n, 1)) * half.sum((0, 2))[:, None] / 3 / np.linalg.norm(way, axis=1, keepdims=True)
    return [center, axes[0], half[0], center + way, axes[1], half[1]]


def cubes(*offsets: tuple[float, float, float]) -> Boxes:
    """Unit cubes at the origin, and as many at the offsets."""
    n = len(offsets)
    axes, half = np.tile(np.eye(3), (n, 1, 1)), np.full((n, 3), 0.5)
    return [np.zeros((n, 3)), axes, half, np.array(offsets, np.float64), axes.copy(), half.copy()]


def inside(center: np.ndarray, axes: np.ndarray, half: np.ndarray, points: np.ndarray, slack: float) -> bool:
    return bool((np.abs((points - center) @ axes.T) <= half + slack).all())


def test_cubes_touch_and_do_not() -> None:
    boxes = cubes((0, 0, 0), (0.9, 0.9, 0.9), (1, 0, 0), (1, 1, 1), (1.0000001, 0, 0), (0, -1.0000001, 0), (3, 3, 3))
    assert intersects(*boxes).tolist() == [True, True, True, True, False, False, False]


@pytest.mark.parametrize("count", [0, 1, 2, 31, 32, 33, 64, 100])
def test_any_number_of_pairs_gives_what_each_gives_alone(count: int) -> None:
    boxes = near(count)
    answers = intersects(*boxes)
    assert answers.shape == (count,)
    assert answers.dtype == np.bool_
    assert answers.tolist() == [bool(intersects(*[array[k : k + 1] for array in boxes])[0]) for k in range(count)]


def test_memory_layout_and_type_do_not_matter() -> None:
    boxes = near(50)
    expected = intersects(*boxes)
    assert 10 < expected.sum() < 40
    np.testing.assert_array_equal(intersects(*[np.asfortranarray(array) for array in boxes]), expected)
    np.testing.assert_array_equal(intersects(*[array.tolist() for array in boxes]), expected)
    np.testing.assert_array_equal(intersects(*[np.repeat(array, 2, 0)[::2] for array in boxes]), expected)


def test_flat_boxes_cross_and_miss() -> None:
    plate, rod, point = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.zeros(3)
    axes, origin = np.eye(3), np.zeros(3)
    for half, offset, expected in ((rod, (0.5, 0.5, 0.2), True), (rod, (0.5, 0.5, 1.0), True),
                                   (rod, (0.5, 0.5, 1.5), False), (rod, (1.5, 0.5, 0.0), False),
                                   (point, (1.0, -1.0, 0.0), True), (point, (1.0, -1.0, 5e-324), False),
                                   (plate, (2.0, 0.0, 0.0), True), (plate, (2.0, 0.0, 1e-300), False)):
        boxes = [origin, axes, plate, np.array(offset), axes, half]
        assert intersects(*[array[None] for array in boxes]).tolist() == [expected]


def test_skewed_axes_are_used_as_given() -> None:
    """b is sheared: its corner at (2, 2) reaches beyond a box of the same axes made orthonormal."""
    sheared = np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    one = np.ones((1, 3))
    for offset, expected in ((2.9, True), (3.0, True), (3.0000001, False)):
        center = np.array([[offset, 2.0, 0.0]])
        answer = intersects(np.zeros((1, 3)), sheared[None], one, center, np.eye(3)[None], one)
        assert answer.tolist() == [expected]


def test_all_axes_in_one_plane() -> None:
    """Two parallelograms in a plane: what separates them is a line in it."""
    flat = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
    half = np.array([[1.0, 1.0, 0.0]])
    for offset, expected in (((2.0, 2.0, 0.0), True), ((2.1, 0.0, 0.0), False), ((0.0, 0.0, 0.1), False)):
        answer = intersects(np.zeros((1, 3)), flat[None], half, np.array([offset]), flat[None], half)
        assert answer.tolist() == [expected]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite_are_named(name: str, value: float) -> None:
    boxes = near(40)
    boxes[NAMES.index(name)][37, ..., 1] = value
    for function in (intersects, contacts):
        with pytest.raises(ValueError, match=rf"^{name}\[37\]: expected finite numbers, got [^\n]*$"):
            function(*boxes)


@pytest.mark.parametrize("name", ["half_a", "half_b"])
def test_a_negative_half_extent_is_named(name: str) -> None:
    boxes = near(40)
    boxes[NAMES.index(name)][5, 2] = -0.5
    boxes[3][5] += 1000.0  # far away or not
    with pytest.raises(ValueError, match=rf"^{name}\[5\]: expected half extents that are not negative, got [^\n]*$"):
        intersects(*boxes)


@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_shape_is_named(name: str) -> None:
    boxes = near(4)
    boxes[NAMES.index(name)] = np.zeros((4, 2))
    with pytest.raises(ValueError, match=rf"^{name}: expected an array of shape \(4, 3(, 3)?\), got \(4, 2\)$"):
        intersects(*boxes)


def test_contacts_are_midway_between_a_point_of_each_box() -> None:
    boxes = near(500)
    found = contacts(*boxes)
    np.testing.assert_array_equal(found.number, np.flatnonzero(intersects(*boxes)))
    assert set(np.diff(found.first).tolist()) >= {1, 2, 3, 4, 5, 6}
    for i, k in enumerate(found.number):
        own = slice(found.first[i], found.first[i + 1])
        a, b = [array[k] for array in boxes[:3]], [array[k] for array in boxes[3:]]
        assert np.linalg.norm(found.normal[i]) == pytest.approx(1.0)
        assert (found.separation[own] <= 1e-12).all()
        assert len(set(found.feature[own].tolist())) == len(found.feature[own])
        way = 0.5 * found.separation[own, None] * found.normal[i]
        assert inside(*a, found.point[own] - way, 1e-8) and inside(*b, found.point[own] + way, 1e-8)


def test_contacts_of_boxes_that_just_touch() -> None:
    found = contacts(*cubes((1, 0, 0), (0, -1, 0.25), (1, 1, 0), (-1, 1, 1), (1.0000001, 0, 0)))
    assert found.number.tolist() == [0, 1, 2, 3]
    assert found.first[1] == 4
    np.testing.assert_array_equal(found.separation, 0.0)
    np.testing.assert_array_equal(found.normal[:2], [[1, 0, 0], [0, -1, 0]])


def test_equal_boxes_on_each_other_have_four_corners() -> None:
    for turn in range(20):
        boxes = near(1, turn)
        boxes[4], boxes[5] = boxes[1].copy(), boxes[2].copy()
        boxes[3] = boxes[0] + 1.99 * boxes[2][:, [0]] * boxes[1][:, 0]
        assert contacts(*boxes).first.tolist() == [0, 4]


def test_swapping_reverses_the_normal_and_nothing_else() -> None:
    boxes = near(500, 3)
    quarter = near(500, 4)  # of equal size, and parallel: all faces tie
    quarter[4], quarter[5] = quarter[1][:, [1, 2, 0]], quarter[2][:, [1, 2, 0]]
    for pairs in (boxes, quarter):
        first, second = contacts(*pairs), contacts(*pairs[3:], *pairs[:3])
        np.testing.assert_array_equal(first.normal, -second.normal)
        for part in ("number", "first", "point", "separation"):
            np.testing.assert_array_equal(getattr(first, part), getattr(second, part))


def test_features_stay_while_boxes_move_a_little() -> None:
    boxes = near(300, 5)
    moved = [array.copy() for array in boxes]
    moved[3] += 1e-7
    one, two = contacts(*boxes), contacts(*moved)
    same = 0
    for i, k in enumerate(one.number):
        j = np.searchsorted(two.number, k)
        if j < len(two.number) and two.number[j] == k:
            before, after = slice(*one.first[i:i + 2]), slice(*two.first[j:j + 2])
            if one.feature[before].tolist() == two.feature[after].tolist():
                np.testing.assert_allclose(one.point[before], two.point[after], atol=1e-4)
                same += 1
    assert same >= len(one.number) - 2
