"""No shot of a small cube gets through a thin plate; the long count is in `make hard-cases`."""

import pytest

from drone_engine.collision_level import OBB, OCTREE, TRIANGLE
from reference.plate_shots import shots_through

SHOTS = 500  # of each kind in every run of the tests


@pytest.mark.parametrize("level", [OBB, OCTREE, TRIANGLE])
def test_no_shot_gets_through(level: int) -> None:
    assert shots_through(SHOTS, level) == 0
