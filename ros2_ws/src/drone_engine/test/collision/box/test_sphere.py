"""Contacts of spheres, against geometry."""

import numpy as np
import pytest

from drone_engine.collision.box import sphere


def test_the_contact_is_on_the_line_of_the_centers() -> None:
    hit, normal, point, separation = sphere.contacts([[0, 0, 0]], [1.0], [[0, 0, 2.5]], [2.0])
    assert hit.tolist() == [True]
    np.testing.assert_allclose(normal, [[0, 0, 1]])
    np.testing.assert_allclose(point, [[0, 0, 0.75]])
    np.testing.assert_allclose(separation, [-0.5])


def test_spheres_that_are_apart_have_a_separation() -> None:
    hit, normal, point, separation = sphere.contacts([[1, 2, 3]], [1.0], [[4, 6, 3]], [2.0])
    assert hit.tolist() == [False]
    np.testing.assert_allclose(normal, [[0.6, 0.8, 0]])
    np.testing.assert_allclose(separation, [2.0])
    np.testing.assert_allclose(point, [[2.2, 3.6, 3]])


def test_swapping_reverses_the_normal() -> None:
    rng = np.random.default_rng(5)
    (a, b), (ra, rb) = rng.normal(size=(2, 100, 3)), rng.random((2, 100))
    first, second = sphere.contacts(a, ra, b, rb), sphere.contacts(b, rb, a, ra)
    np.testing.assert_array_equal(first[0], second[0])
    np.testing.assert_array_equal(first[1], -second[1])
    np.testing.assert_allclose(first[2], second[2], atol=1e-15)
    np.testing.assert_array_equal(first[3], second[3])


def test_concentric_spheres_have_a_normal() -> None:
    _, normal, _, separation = sphere.contacts([[1, 1, 1]], [0.0], [[1, 1, 1]], [2.0])
    assert np.linalg.norm(normal) == 1.0
    assert separation.tolist() == [-2.0]


def test_no_spheres_give_an_empty_answer() -> None:
    assert sphere.intersects(np.empty((0, 3)), [], np.empty((0, 3)), []).shape == (0,)


@pytest.mark.parametrize(("name", "value"), [("center_a", np.nan), ("radius_a", -1.0), ("center_b", np.inf),
                                             ("radius_b", np.nan), ("radius_b", np.inf)])
def test_an_invalid_sphere_is_named(name: str, value: float) -> None:
    spheres = {"center_a": np.zeros((3, 3)), "radius_a": np.ones(3), "center_b": np.ones((3, 3)),
               "radius_b": np.ones(3)}
    spheres[name][1] = value
    with pytest.raises(ValueError, match=rf"^{name}\[1\]: expected [^\n]*$"):
        sphere.intersects(**spheres)


def test_a_wrong_shape_is_named() -> None:
    with pytest.raises(ValueError, match=r"^radius_b: expected an array of shape \(2,\), got \(3,\)$"):
        sphere.intersects(np.zeros((2, 3)), np.ones(2), np.ones((2, 3)), np.ones(3))
