"""A fixture that runs a case of motion and compares what it reaches with its limits."""

from collections.abc import Callable

import pytest

from reference.box_world import Setting
from reference.motion.cases import CASES
from reference.motion.outcome import Outcome


@pytest.fixture
def hold() -> Callable[..., None]:
    """Runs a case, as a whole or by a shorter `run`; a known failure that has ceased to be one is an error, too."""

    def check(name: str, setting: Setting, run: Callable[[Setting], Outcome] | None = None) -> None:
        failures = (run or CASES[name].run)(setting).failures
        if known := CASES[name].known_failures.get(setting):
            assert failures, f"holds now, so it is no longer known that {known}"
            pytest.xfail(f"{known}: {failures}")
        assert failures == []

    return check
