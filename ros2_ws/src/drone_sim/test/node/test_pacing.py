"""Simulated time follows the wall clock, and a stall makes it late, never jump."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drone_sim.node.pacing import MOST_AT_ONCE, Pacer, Share


@pytest.mark.parametrize(("rate", "factor"), [(30, 1.0), (30, 0.5), (240, 2.0), (1000, 1.0)])
def test_it_keeps_the_rate(rate: float, factor: float) -> None:
    pacer = Pacer(rate, factor)
    calls = round(10 * rate * factor)  # ten seconds, called once a period
    steps = sum(pacer.due(100.0 + i * pacer.period) for i in range(calls))
    assert steps == pytest.approx(10 * rate * factor, abs=1)
    assert pacer.lag == 0.0


def test_a_stall_is_lag_and_not_a_jump() -> None:
    pacer = Pacer(30, 1.0)
    assert pacer.due(0.0) == 1
    assert pacer.due(5.0) == MOST_AT_ONCE
    assert pacer.lag == pytest.approx(5.0 - MOST_AT_ONCE / 30, abs=1 / 30)
    assert pacer.due(5.0) == 0
    assert pacer.due(5.0 + 1.01 / 30) == 1


def test_a_pause_is_not_lag() -> None:
    pacer = Pacer(30, 1.0)
    pacer.due(0.0)
    pacer.restart()
    assert pacer.due(60.0) == 1
    assert pacer.lag == 0.0


@given(st.lists(st.floats(0, 3), max_size=50))
def test_steps_and_lag_add_up_to_the_time_that_passed(waits: list[float]) -> None:
    pacer, now = Pacer(30, 1.0), 0.0
    steps = pacer.due(now)
    for wait in waits:
        now += wait
        due = pacer.due(now)
        assert 0 <= due <= MOST_AT_ONCE
        steps += due
    assert abs(steps / 30 + pacer.lag - now) <= 1 / 30 + 1e-9


def test_what_takes_long_rests_long() -> None:
    share = Share(0.1)
    assert share.due(5.0)
    share.took(5.0, 5.02)
    assert not share.due(5.19)
    assert share.due(5.21)
