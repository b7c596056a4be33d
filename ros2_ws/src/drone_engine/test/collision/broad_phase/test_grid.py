"""The broad phase finds exactly the pairs that brute force finds, each once."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine.collision.broad_phase import cells
from drone_engine.collision.broad_phase.grid import Grid


def brute_force(low: np.ndarray, high: np.ndarray, solid: np.ndarray, movable: np.ndarray) -> list[tuple[int, int]]:
    return [(i, j) for i in range(len(low)) for j in range(i + 1, len(low))
            if solid[i] and solid[j] and (movable[i] or movable[j])
            and bool(np.all(low[i] <= high[j]) and np.all(low[j] <= high[i]))]


def check(center: np.ndarray, half: np.ndarray, solid: np.ndarray, movable: np.ndarray) -> int:
    low, high = center - half, center + half
    a, b = Grid(half[solid]).pairs(low, high, solid, movable)
    expected = brute_force(low, high, solid, movable)
    assert list(zip(a.tolist(), b.tolist(), strict=True)) == expected
    return len(expected)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("count", [0, 1, 2, 50, 400])
def test_random_boxes(count: int, scale: float) -> None:
    rng = np.random.default_rng(count)
    half = rng.uniform(0.1, 1.0, (count, 3)) * scale
    center = rng.uniform(-0.8, 0.8, (count, 3)) * max(count, 1) ** (1 / 3) * scale
    pairs = check(center, half, rng.random(count) < 0.9, rng.random(count) < 0.5)
    assert count < 50 or pairs > count / 4


@pytest.mark.parametrize(("gap", "reach"), [(0.0, 3), (0.01, 1)])
def test_a_lattice_of_cubes(gap: float, reach: int) -> None:
    """Cubes of 1 m that touch have up to 26 neighbours; with a gap between them none."""
    side = np.arange(7.0) * (1.0 + gap)
    low = np.stack(np.meshgrid(side, side, side), -1).reshape(-1, 3)
    every = np.ones(len(low), bool)
    a, b = Grid(np.full((len(low), 3), 0.5)).pairs(low, low + 1.0, every, every)
    assert len(a) == ((reach * 7 - (reach - 1)) ** 3 - 7**3) // 2
    assert bool(np.all(a < b))
    assert np.unique(a * len(low) + b).tolist() == (a * len(low) + b).tolist()


def test_returned_pairs_stay_valid_after_the_next_call() -> None:
    low, every = np.zeros((2, 3)), np.ones(2, bool)
    grid = Grid(np.ones((2, 3)))
    a, b = grid.pairs(low, low + 1.0, every, every)
    apart = np.array([[0.0], [5.0]])
    grid.pairs(low + apart, low + apart + 1.0, every, every)
    assert (a.tolist(), b.tolist()) == ([0], [1])


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("axis", range(3))
def test_bounds_that_are_not_finite_are_refused(number: float, axis: int) -> None:
    low, high, every = np.zeros((3, 3)), np.ones((3, 3)), np.ones(3, bool)
    grid = Grid(high)
    for bound in (low, high):
        bound[1, axis] = number
        with pytest.raises(ValueError, match="finite"):
            grid.pairs(low, high, every, every)
        bound[1, axis] = 0.5
    low[1, axis] = 0.6
    with pytest.raises(ValueError, match="low <= high"):
        grid.pairs(low, high, every, every)
    low[1, axis] = 0.5
    assert len(grid.pairs(low, high, every, every)[0]) == 3


def test_occupied_cells_cover_the_boxes() -> None:
    rng = np.random.default_rng(3)
    half = rng.uniform(0.1, 1.0, (50, 3)) * rng.choice([1.0, 100.0], (50, 1))
    center = rng.uniform(-200, 200, (50, 3))
    grid = Grid(half)
    corner, edge = grid.occupied_cells(center - half, center + half)
    assert len(np.unique(edge)) == 2
    assert len(np.unique(np.column_stack([corner, edge]), axis=0)) == len(edge)
    points = (center + rng.uniform(-1, 1, (100, 50, 3)) * half).reshape(-1, 1, 3)
    inside = ((points >= corner - 1e-9) & (points <= corner + edge[:, None] + 1e-9)).all(axis=2)
    assert bool(inside.any(axis=1).all())


def test_no_write_beyond_a_buffer_of_any_size() -> None:
    """40 cubes that all share a point, against themselves and as movers against themselves as statics."""
    low = np.random.default_rng(6).uniform(-1, 0, (40, 3))
    high, bodies, cells_per_meter = low + 1.0, np.arange(40, dtype=np.int32), np.array([0.5])
    stored_level = np.zeros(40, np.int32)
    start, unsorted, entry = np.zeros(65, np.int32), np.empty((320, 3), np.int64), np.empty((320, 3), np.int64)
    assert cells.fill_table(low, high, bodies, 40, stored_level, cells_per_meter, 0, start, np.empty(320, np.int32),
                            unsorted, entry) <= 320
    beyond = np.full(4000, -1)
    for size in range(1700):
        found, _ = cells.find_pairs_within(start, entry, beyond[:size])
        assert found in (-1, 40 * 39 // 2)
        assert bool((beyond[size:] == -1).all())
        beyond[:] = -1
        found, _ = cells.find_pairs_with(low, high, bodies, 40, stored_level, cells_per_meter, 0, start, entry,
                                         beyond[:size], 0)
        assert found in (-1, 40 * 40)
        assert bool((beyond[size:] == -1).all())
        beyond[:] = -1
    assert found == 40 * 40


def test_a_millimeter_beside_a_kilometer() -> None:
    rng = np.random.default_rng(1)
    half = np.concatenate([np.full((60, 3), 0.0005), np.full((3, 3), 500.0), rng.uniform(0.001, 50, (60, 3))])
    center = np.concatenate([rng.uniform(-0.002, 0.002, (60, 3)), rng.uniform(-600, 600, (63, 3))])
    every = np.ones(len(half), bool)
    assert check(center, half, every, every) > 200


numbers = st.floats(-20, 20)


@given(st.lists(st.tuples(numbers, numbers, numbers, st.floats(0, 9), st.floats(0, 9), st.floats(0, 9), st.booleans(),
                          st.booleans()), max_size=14))
@settings(max_examples=200, deadline=None)
def test_any_boxes(boxes: list[tuple[float, ...]]) -> None:
    table = np.array(boxes).reshape(-1, 8)
    check(table[:, :3], table[:, 3:6], table[:, 6] > 0, table[:, 7] > 0)
