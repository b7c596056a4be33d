"""The broad phase finds exactly the pairs that brute force finds, each once."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_sim.collision.grid import Grid


def brute_force(low: np.ndarray, high: np.ndarray, solid: np.ndarray, movable: np.ndarray) -> list[tuple[int, int]]:
    return [(i, j) for i in range(len(low)) for j in range(i + 1, len(low))
            if solid[i] and solid[j] and (movable[i] or movable[j])
            and bool(np.all(low[i] <= high[j]) and np.all(low[j] <= high[i]))]


def check(centre: np.ndarray, half: np.ndarray, solid: np.ndarray, movable: np.ndarray) -> int:
    low, high = centre - half, centre + half
    a, b = Grid(half[solid]).pairs(low, high, solid, movable)
    expected = brute_force(low, high, solid, movable)
    assert list(zip(a.tolist(), b.tolist(), strict=True)) == expected
    return len(expected)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("count", [0, 1, 2, 50, 400])
def test_random_boxes(count: int, scale: float) -> None:
    rng = np.random.default_rng(count)
    half = rng.uniform(0.1, 1.0, (count, 3)) * scale
    centre = rng.uniform(-0.8, 0.8, (count, 3)) * max(count, 1) ** (1 / 3) * scale
    pairs = check(centre, half, rng.random(count) < 0.9, rng.random(count) < 0.5)
    assert count < 50 or pairs > count / 4


def test_a_millimetre_beside_a_kilometre() -> None:
    rng = np.random.default_rng(1)
    half = np.concatenate([np.full((60, 3), 0.0005), np.full((3, 3), 500.0), rng.uniform(0.001, 50, (60, 3))])
    centre = np.concatenate([rng.uniform(-0.002, 0.002, (60, 3)), rng.uniform(-600, 600, (63, 3))])
    everything = np.ones(len(half), bool)
    assert check(centre, half, everything, everything) > 200


numbers = st.floats(-20, 20)


@given(st.lists(st.tuples(numbers, numbers, numbers, st.floats(0, 9), st.floats(0, 9), st.floats(0, 9), st.booleans(),
                          st.booleans()), max_size=14))
@settings(max_examples=200, deadline=None)
def test_whatever_boxes(boxes: list[tuple[float, ...]]) -> None:
    table = np.array(boxes).reshape(-1, 8)
    check(table[:, :3], table[:, 3:6], table[:, 6] > 0, table[:, 7] > 0)
