"""Makes the oracles and families beside the tests importable; holds cases of motion to their numbers."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench"))
sys.path.insert(0, str(Path(__file__).parent))

from box_world import Setting
from motion_cases import CASES
from motion_outcome import Outcome


@pytest.fixture
def hold() -> Callable[..., None]:
    """Runs a case, as a whole or by a shorter `run`; a known failure that has ceased to be one is an error, too."""

    def check(name: str, setting: Setting, run: Callable[[Setting], Outcome] | None = None) -> None:
        failures = (run or CASES[name].run)(setting).failures
        if known := CASES[name].known.get(setting):
            assert failures, f"holds now, so it is no longer known that {known}"
            pytest.xfail(f"{known}: {failures}")
        assert failures == []

    return check
