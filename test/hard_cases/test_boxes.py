"""The box level gives the exact answers on pairs that rounding gets wrong."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine.collision.box import obb
from reference.box_families import FAMILIES, QUARTERS, Pairs
from reference.box_oracle import all_boxes_touch, boxes_touch

COUNT = 3000  # pairs of a family; `make hard-cases` has the large counts


@pytest.mark.parametrize("name", FAMILIES)
def test_no_answer_differs_from_exact_arithmetic(name: str) -> None:
    pairs = FAMILIES[name](np.random.default_rng(1), COUNT)
    expected = all_boxes_touch(*pairs)
    assert 0.2 < expected.mean() < 0.9  # both answers are frequent
    wrong = np.flatnonzero(obb.intersects(*pairs) != expected)
    assert not len(wrong), f"{len(wrong)} wrong, the first: {[array[wrong[0]].tolist() for array in pairs]}"


@pytest.mark.parametrize("name", FAMILIES)
def test_swapping_the_boxes_changes_no_answer(name: str) -> None:
    pairs = FAMILIES[name](np.random.default_rng(2), COUNT)
    np.testing.assert_array_equal(obb.intersects(*pairs), obb.intersects(*pairs[3:], *pairs[:3]))


@pytest.mark.parametrize("name", ["parallel", "touching"])
def test_plain_floating_point_fails_on_the_hardest_families(name: str) -> None:
    """Also with an epsilon."""
    pairs = FAMILIES[name](np.random.default_rng(3), COUNT)
    exact = obb.intersects(*pairs)
    for epsilon in (0.0, 1e-6):
        assert np.mean(plain(*pairs, epsilon) != exact) > 0.02


def plain(center_a: np.ndarray, axes_a: np.ndarray, half_a: np.ndarray, center_b: np.ndarray, axes_b: np.ndarray,
          half_b: np.ndarray, epsilon: float) -> np.ndarray:
    axes, half = np.concatenate([axes_a, axes_b], 1), np.concatenate([half_a, half_b], 1)
    i, j = np.triu_indices(6, 1)
    normals = np.cross(axes[:, i], axes[:, j])
    reach = np.einsum("nik,nk->ni", np.abs(np.einsum("nic,nkc->nik", normals, axes)), half)
    return np.all(np.abs(np.einsum("nic,nc->ni", normals, center_b - center_a)) <= reach + epsilon, axis=1)


@pytest.mark.parametrize("quarter", [0, 9, 20, 47])
@pytest.mark.parametrize("kind", ["face", "edge", "vertex"])
def test_touch_is_a_hit_and_one_ulp_more_is_none(kind: str, quarter: int) -> None:
    half_a, half_b = np.array([0.5, 0.25, 1.0]), np.array([0.125, 2.0, 0.75])
    reach = half_a + np.abs(QUARTERS[quarter].T) @ half_b
    offset = reach * {"face": [1.0, 0.3, -0.4], "edge": [1.0, -1.0, 0.4], "vertex": [-1.0, 1.0, 1.0]}[kind]
    beyond = offset.copy()
    beyond[0] = np.nextafter(offset[0], 2 * offset[0])
    for center, expected in ((offset, True), (beyond, False)):
        answer = obb.intersects(np.zeros((1, 3)), np.eye(3)[None], half_a[None], center[None], QUARTERS[quarter][None],
                                half_b[None])
        assert answer.tolist() == [expected]


number = st.one_of(st.integers(-3, 3).map(float), st.sampled_from([0.5, 0.25, -0.0, 5e-324, 1e-300, 1e300, 1e-8]),
                   st.floats(-4, 4), st.floats(allow_nan=False, allow_infinity=False))
vector = st.tuples(number, number, number)
box = st.tuples(vector, st.one_of(st.tuples(vector, vector, vector), st.sampled_from(QUARTERS.tolist())), vector)


@given(box, box)
@settings(max_examples=400, deadline=None)
def test_arbitrary_boxes(a: tuple, b: tuple) -> None:
    arrays = [np.array(numbers, np.float64) for numbers in (*a, *b)]
    arrays[2], arrays[5] = np.abs(arrays[2]), np.abs(arrays[5])
    assert obb.intersects(*[array[None] for array in arrays])[0] == boxes_touch(*arrays)


@given(st.sampled_from(sorted(FAMILIES)), st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_arbitrary_seeds(name: str, seed: int) -> None:
    pairs: Pairs = FAMILIES[name](np.random.default_rng(seed), 20)
    np.testing.assert_array_equal(obb.intersects(*pairs), all_boxes_touch(*pairs))
