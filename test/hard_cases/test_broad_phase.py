"""The grid finds exactly the pairs that brute force finds, for all distances, sizes and gaps."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.broad_phase import grid
from drone_engine.collision.broad_phase.grid import Grid
from reference.broad_phase import Boxes, brute_force, random_boxes


def check(low: Floats, high: Floats, movable: Booleans | None = None, broad: Grid | None = None) -> int:
    """Compares the pairs of the grid with those of brute force; returns their number."""
    movable = np.ones(len(low), bool) if movable is None else movable
    broad = Grid(high / 2 - low / 2) if broad is None else broad
    found = np.stack(broad.pairs(low, high, np.ones(len(low), bool), movable), axis=1)
    np.testing.assert_array_equal(found, brute_force(low, high, movable))
    return len(found)


@pytest.mark.parametrize("reach", [1, 10, 100, 1000])
def test_a_box_across_any_number_of_cells_is_paired_with_all_overlapping_boxes(reach: int) -> None:
    rng = np.random.default_rng(reach)
    center = rng.uniform(-1.1, 1.1, (400, 3)) * [reach, 2, 2]
    half = rng.uniform(0.2, 0.5, (400, 3))
    center[0], half[0] = 0.0, (reach, 0.3, 0.3)
    center[1], half[1] = 0.0, (reach, 2.0, 2.0)
    assert check(center - half, center + half) > 300


def test_no_pair_of_a_box_with_itself_and_each_pair_once() -> None:
    side = np.arange(6.0)
    low = np.stack(np.meshgrid(side, side, side), -1).reshape(-1, 3)
    assert check(low, low + 1.0) == ((3 * 6 - 2) ** 3 - 6**3) // 2  # each touches its neighbors, corners too


@pytest.mark.parametrize("octant", [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
def test_negative_cells(octant: tuple[int, int, int]) -> None:
    low, high = random_boxes(5, 300, (0.2, 1.0), crowd=3.0)
    shift = np.array(octant) * [2.0, 20.0, 200.0]
    assert check(low + shift, high + shift) > 100
    mirrored = np.array(octant) < 0
    assert check(np.where(mirrored, -high, low), np.where(mirrored, -low, high)) > 100


def test_a_millimeter_beside_a_kilometer() -> None:
    rng = np.random.default_rng(1)
    half = np.concatenate([np.full((300, 3), 0.0005), np.full((20, 3), 500.0), rng.uniform(0.001, 50, (80, 3))])
    center = np.concatenate([rng.uniform(-0.005, 0.005, (300, 3)), rng.uniform(-600, 600, (100, 3))])
    assert check(center - half, center + half) > 1000


def dust_between_giants(count: int) -> Boxes:
    """Half of the boxes 1 mm and barely touching, half 1 km and sparse, one of them around the small ones."""
    rng = np.random.default_rng(count)
    half = np.repeat([[0.0005], [500.0]], count // 2, axis=0) * np.ones(3)
    room = half * np.cbrt(count / 2)
    center = rng.uniform(-2, 2, (len(half), 3)) * room
    return center - half, center + half


def memory(broad: Grid) -> int:
    """Bytes of all arrays of the grid."""
    return sum(array.nbytes for array in vars(broad).values() if isinstance(array, np.ndarray))


@pytest.mark.parametrize("movable_share", [1.0, 0.5])
def test_a_millimeter_and_a_kilometer_cost_no_more_when_there_are_more(
        movable_share: float, monkeypatch: pytest.MonkeyPatch) -> None:
    tests = []
    find_pairs = grid.find_pairs

    def counting(*arguments: object) -> tuple[int, int, int]:
        answer: tuple[int, int, int] = find_pairs(*arguments)
        tests.append(answer[2])
        return answer

    monkeypatch.setattr(grid, "find_pairs", counting)
    for count in (1000, 4000):
        low, high = dust_between_giants(count)
        broad = Grid(high / 2 - low / 2)
        movable = np.random.default_rng(2).random(count) < movable_share
        assert check(low, high, movable, broad) > count / 4
        assert memory(broad) < 2000 * count
        assert tests[-1] < 40 * count


def test_every_size_from_a_micrometer_to_a_hundred_kilometers() -> None:
    for seed in range(3):
        low, high = random_boxes(seed, 500, (1e-6, 1e5))
        inside = np.random.default_rng(seed).uniform(0, 500, len(low)).astype(int)
        shift = low[inside] - low  # otherwise most small boxes would have no pair
        assert check(low + shift, high + shift) > 300


def stacks(gap: float) -> Boxes:
    """Boxes of random thickness stacked along each axis, touching, or one ulp closer (gap < 0) or farther."""
    rng = np.random.default_rng(3)
    lows, highs = [], []
    for axis in range(3):
        for turn in range(8):
            edges = np.cumsum(rng.choice([0.1, 0.7, 1.0, 1 / 3], 30)) - 9.01
            low, high = np.full((29, 3), 100.0 * (8 * axis + turn)), np.full((29, 3), 100.0 * (8 * axis + turn) + 1)
            low[:, axis], high[:, axis] = edges[:-1], edges[1:]
            if gap:
                low[1:, axis] = np.nextafter(low[1:, axis], gap * np.inf)
            lows.append(low)
            highs.append(high)
    return np.concatenate(lows), np.concatenate(highs)


@pytest.mark.parametrize(("gap", "pairs"), [(0, 24 * 28), (-1, 24 * 28), (1, 0)])
@pytest.mark.parametrize("scale", [1.0, 2.0**-30, 2.0**30])  # powers of two keep the gap
def test_touching_is_a_pair_and_a_gap_of_one_ulp_is_not(gap: int, pairs: int, scale: float) -> None:
    low, high = stacks(gap)
    assert check(low * scale, high * scale) == pairs


def test_touching_at_the_edge_of_a_cell() -> None:
    """Boxes as long as a cell, half, a third, twice: their faces coincide with cell edges up to rounding."""
    for share in (0.5, 1 / 3, 1.0, 2.0, 1 - 2**-53, 1 + 2**-52):
        broad = Grid(np.full((10, 3), 0.4))
        _, edges = broad.occupied_cells(np.zeros((1, 3)), np.full((1, 3), 0.8))
        faces = np.arange(-40, 41) * (edges[0] * share)
        low = np.zeros((80, 3))
        low[:, 0] = faces[:-1]
        high = low + 0.5
        high[:, 0] = faces[1:]
        assert check(low, high, broad=broad) == 79
        low[:, 0] = np.nextafter(low[:, 0], np.inf)
        assert check(low, high, broad=broad) == 0


@pytest.mark.parametrize("offset", [1e3, 1e6, -1e9, 1e12, -1e15, 1e18, 1e100, 1e300])
def test_huge_offsets(offset: float) -> None:
    low, high = random_boxes(7, 300, (0.2, 2.0))
    low += offset
    high += offset
    assert check(low, high) > 100
    origin = random_boxes(8, 100, (0.2, 2.0))
    assert check(np.concatenate([low, origin[0]]), np.concatenate([high, origin[1]])) > 100


def test_the_largest_and_the_smallest_numbers() -> None:
    largest, least = np.finfo(float).max, 5e-324
    low = np.array([[-largest] * 3, [0.0] * 3, [least] * 3, [-least] * 3, [largest] * 3, [-largest, 0, 0], [2.0] * 3])
    high = np.array([[largest] * 3, [0.0] * 3, [least] * 3, [0.0] * 3, [largest] * 3, [largest, 0, 0], [2.0] * 3])
    assert check(low, high) == 6 + 2 + 1
    assert check(low[1:4], high[1:4]) == 1
    assert check(low[1:2].repeat(50, 0), high[1:2].repeat(50, 0)) == 50 * 49 // 2


def test_points_plates_and_rods() -> None:
    rng = np.random.default_rng(4)
    half = rng.uniform(0, 3, (500, 3)) * rng.integers(0, 2, (500, 3))
    center = rng.integers(-6, 7, (500, 3)) / 2.0
    assert check(center - half, center + half) > 1000


def test_bodies_that_leave_their_initial_region_and_return() -> None:
    low, high = random_boxes(9, 300, (0.1, 1.0))
    half, middle = high / 2 - low / 2, low / 2 + high / 2
    broad = Grid(half)
    rng = np.random.default_rng(9)
    for distance in (0.0, 1.0, 1e3, 1e7, 1e14, 1.0, 0.0):
        moved = middle + rng.normal(size=middle.shape) * distance
        assert check(moved - half, moved + half, broad=broad) > (100 if distance == 0 else -1)


def test_bodies_that_outgrow_their_cells_and_shrink() -> None:
    low, high = random_boxes(10, 300, (0.1, 1.0), crowd=10.0)
    broad = Grid(high / 2 - low / 2)
    rng = np.random.default_rng(10)
    for growth in (0.0, 1.0, 30.0, 1e4, 1e8, 0.0, -0.02):
        reach = np.maximum(rng.uniform(0, 1, (300, 1)) ** 20 * growth, -0.05)
        check(low - reach, high + reach, broad=broad)


def test_cell_sizes_adapt_when_the_bounds_shrink(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(12)
    center = rng.uniform(-10, 10, (2000, 3))
    broad, tests = Grid(np.full((2000, 3), 1e6)), []
    find_pairs = grid.find_pairs
    monkeypatch.setattr(grid, "find_pairs", lambda *a: tests.append(answer := find_pairs(*a)) or answer)
    for _ in range(3):
        check(center - 0.3, center + 0.3, broad=broad)
    made = [count for _, _, count in tests]
    assert max(made) > 10 * made[-1] > 0


def test_static_bodies_are_binned_once_and_again_when_one_moved(monkeypatch: pytest.MonkeyPatch) -> None:
    low, high = random_boxes(11, 400, (0.1, 3.0))
    fixed = np.random.default_rng(11).random(400) < 0.8
    broad, filled, fill_table = Grid(high / 2 - low / 2), [], grid.fill_table
    monkeypatch.setattr(grid, "fill_table", lambda *arguments: filled.append(arguments) or fill_table(*arguments))
    for step in range(5):
        shift = np.where(fixed, 0.0, 0.1 * step)[:, None]
        assert check(low + shift, high + shift, ~fixed, broad) > 100
    assert len(filled) == 1
    one = np.flatnonzero(fixed)[7]
    low[one] -= 1.0
    check(low, high, ~fixed, broad)
    fixed[one] = False
    check(low, high, ~fixed, broad)
    assert len(filled) == 3


def test_a_full_buffer_loses_no_pair() -> None:
    """One small box, then up to 250 boxes that all share a point: each number of pairs fills a buffer once."""
    broad = Grid(np.full((1, 3), 0.5))
    for count in range(1, 250):
        low = np.random.default_rng(count).uniform(-1, 0, (count, 3))
        assert check(low, low + 1.0, broad=broad) == count * (count - 1) // 2


def coordinate(scale: float) -> st.SearchStrategy[float]:
    return st.one_of(st.integers(-3, 3).map(float), st.floats(-scale, scale))


@given(st.lists(st.tuples(st.lists(coordinate(9), min_size=6, max_size=6), st.booleans()), max_size=30),
       st.sampled_from([0.0, 1 / 3, 1e6, -1e15]), st.sampled_from([1.0, 1e-3, 1e3, 1e-300]))
@settings(max_examples=300, deadline=None)
def test_arbitrary_boxes(boxes: list[tuple[list[float], bool]], offset: float, scale: float) -> None:
    ends = (np.array([ends for ends, _ in boxes]).reshape(-1, 2, 3) + offset) * scale
    check(ends.min(axis=1), ends.max(axis=1), np.array([movable for _, movable in boxes], bool))


finite = st.floats(allow_nan=False, allow_infinity=False)


@given(st.lists(st.tuples(st.lists(st.one_of(finite, st.sampled_from([0.0, 1.0, -1.0])), min_size=6, max_size=6),
                          st.booleans()), max_size=20))
@settings(max_examples=300, deadline=None)
def test_arbitrary_numbers(boxes: list[tuple[list[float], bool]]) -> None:
    ends = np.array([ends for ends, _ in boxes]).reshape(-1, 2, 3)
    check(ends.min(axis=1), ends.max(axis=1), np.array([movable for _, movable in boxes], bool))


@given(st.lists(st.lists(st.tuples(coordinate(50), st.floats(1e-3, 30)), min_size=12, max_size=12), min_size=1,
                max_size=6), st.integers(0, 2**12 - 1))
@settings(max_examples=100, deadline=None)
def test_arbitrary_motion(steps: list[list[tuple[float, float]]], movable: int) -> None:
    """One grid sees twelve boxes move and change size, some of them static."""
    broad = Grid(np.ones((12, 3)))
    mask = np.array([movable >> i & 1 for i in range(12)], bool)
    for before, step in pairwise([steps[0], *steps]):
        center = np.array([(s if m else b)[0] for s, b, m in zip(step, before, mask, strict=True)])[:, None]
        half = np.array([(s if m else b)[1] for s, b, m in zip(step, before, mask, strict=True)])[:, None]
        check(center * [1, 0.5, 0] - half, center * [1, 0.5, 0] + half, mask, broad)
