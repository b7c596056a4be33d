"""Coloring of contact constraints and their distribution to lanes."""

import numpy as np
import pytest

from drone_engine.dynamics.contact_table import LANES, POINTS
from drone_engine.dynamics.grouping import COLORS, HALF, assign_colors, assign_lanes

BODIES = 40  # of which the first does not move


def random_contacts(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """pair (count, 2), points (count,), inverse_mass (BODIES,): a third of the contacts with the body at rest."""
    rng = np.random.default_rng(count)
    pair = np.array([np.sort(rng.choice(BODIES, 2, replace=False)) for _ in range(count)])
    pair[::3, 0] = 0
    inverse_mass = np.ones(BODIES)
    inverse_mass[0] = 0.0
    return pair, rng.integers(1, 2 * POINTS + 1, count), inverse_mass


@pytest.mark.parametrize("count", [1, 60, 3000])
def test_constraints_of_a_group_share_no_moving_body(count: int) -> None:
    pair, points, inverse_mass = random_contacts(count)
    used, size, color = np.zeros((BODIES, 2), np.int64), np.empty(COLORS, np.int64), np.empty((count, 2), np.int64)
    assign_colors(count, pair, points, inverse_mass, used, size, color)
    assert not used.any()
    np.testing.assert_array_equal(size, np.bincount(color[color >= 0], minlength=COLORS))

    constraint = np.empty((2 * count, LANES), np.int64)
    groups = assign_lanes(count, color, size, np.empty(COLORS, np.int64), constraint)
    expected = sorted([*(2 * np.arange(count)), *(2 * np.flatnonzero(points > POINTS) + 1)])
    assert sorted(constraint[:groups][constraint[:groups] >= 0]) == expected
    for group in constraint[:groups]:
        numbers = group[group >= 0]
        bodies = pair[numbers >> 1].ravel()
        moving = bodies[inverse_mass[bodies] > 0.0]
        assert len(set(moving)) == len(moving)


def test_constraints_with_one_moving_body_come_last() -> None:
    pair, points, inverse_mass = random_contacts(60)
    color, size = np.empty((60, 2), np.int64), np.empty(COLORS, np.int64)
    assign_colors(60, pair, points, inverse_mass, np.zeros((BODIES, 2), np.int64), size, color)
    np.testing.assert_array_equal(color[:, 0] >= HALF, pair[:, 0] == 0)


def test_without_room_nothing_is_written() -> None:
    pair, points, inverse_mass = random_contacts(60)
    color, size = np.empty((60, 2), np.int64), np.empty(COLORS, np.int64)
    assign_colors(60, pair, points, inverse_mass, np.zeros((BODIES, 2), np.int64), size, color)
    constraint = np.full((1, LANES), 7)
    assert assign_lanes(60, color, size, np.empty(COLORS, np.int64), constraint) > 1
    assert (constraint == 7).all()
