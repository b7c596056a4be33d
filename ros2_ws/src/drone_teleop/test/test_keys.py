"""The meaning of keys and when they count as held; the tests set the time."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drone_teleop.keys import ACTIONS, HELP, HOLD, MOVES, SPEED_RANGE, SPEEDS, Action, Controls, HeldKey

STOP = (0.0, 0.0, 0.0, 0.0)

# The documented table of teleop_twist_keyboard: x, y, z, yaw; then factors of the linear and the angular speed.
DOCUMENTED_MOVES = """
i 1 0 0 0 | o 1 0 0 -1 | j 0 0 0 1 | l 0 0 0 -1 | u 1 0 0 1 | , -1 0 0 0 | . -1 0 0 1 | m -1 0 0 -1
I 1 0 0 0 | O 1 -1 0 0 | J 0 1 0 0 | L 0 -1 0 0 | U 1 1 0 0 | < -1 0 0 0 | > -1 -1 0 0 | M -1 1 0 0
t 0 0 1 0 | b 0 0 -1 0"""
DOCUMENTED_SPEEDS = "q 1.1 1.1 | z .9 .9 | w 1.1 1 | x .9 1 | e 1 1.1 | c 1 .9"


def rows(table: str) -> dict[str, tuple[float, ...]]:
    cells = (row.split() for row in table.strip().replace("\n", "|").split("|"))
    return {key: tuple(map(float, values)) for key, *values in cells}


def test_the_table_is_teleop_twist_keyboards() -> None:
    assert rows(DOCUMENTED_MOVES) == MOVES
    assert rows(DOCUMENTED_SPEEDS) == SPEEDS


def test_no_other_key_takes_one_of_the_table_or_of_its_stops() -> None:
    extra = {*ACTIONS, HOLD}
    assert not extra & {*MOVES, *SPEEDS, "k", "K"}


def test_the_help_names_every_key() -> None:
    words = HELP.replace("/", " ").replace(":", " ").split()
    assert {*MOVES, *SPEEDS, *ACTIONS, HOLD, "k", "K"} <= set(words)


@pytest.mark.parametrize("key", MOVES)
def test_a_moving_key_commands_its_direction_at_the_speeds(key: str) -> None:
    controls = Controls(speed=3.0, turn=0.5)
    assert controls.press(key, 0.0) is None
    x, y, z, yaw = MOVES[key]
    assert controls.velocity(0.0) == (3.0 * x, 3.0 * y, 3.0 * z, 0.5 * yaw)


def test_a_tap_counts_until_its_first_repeat_must_have_come_then_stops_once() -> None:
    controls = Controls(delay=0.6, timeout=0.15)
    assert controls.velocity(0.0) is None
    controls.press("i", 1.0)
    assert controls.velocity(1.59) == (2.0, 0.0, 0.0, 0.0)
    assert controls.velocity(1.6) == STOP
    assert controls.velocity(1.61) is None
    assert controls.velocity(9.0) is None


@pytest.mark.parametrize("first_repeat", [0.25, 0.5])
def test_a_held_key_counts_without_a_gap_and_stops_soon_after_it_is_let_go(first_repeat: float) -> None:
    held = HeldKey(delay=0.6, timeout=0.15)
    events = [0.0, *(first_repeat + i / 30 for i in range(30))]
    for event, after in zip(events, [*events[1:], events[-1]], strict=True):
        held.press("i", event)
        assert held.at(after) == "i"
    assert held.at(events[-1] + 0.149) == "i"
    assert held.at(events[-1] + 0.151) is None


def test_a_second_tap_has_the_time_of_a_first() -> None:
    held = HeldKey(delay=0.6, timeout=0.15)
    held.press("i", 0.0)
    held.press("i", 0.3)
    assert held.at(0.89) == "i"
    assert held.at(0.9) is None


def test_another_key_takes_over_at_once() -> None:
    controls = Controls()
    for now in (0.0, 0.03, 0.06):
        controls.press("i", now)
    controls.press("J", 0.09)
    assert controls.velocity(0.09) == (0.0, 2.0, 0.0, 0.0)
    assert controls.velocity(0.6) == (0.0, 2.0, 0.0, 0.0)  # a first press, which has the longer time


@pytest.mark.parametrize("key", ["k", "K", "5", "Esc", "\x1b[A", "é"])
def test_anything_else_stops_and_says_so_even_when_nothing_moved(key: str) -> None:
    controls = Controls()
    controls.press("i", 0.0)
    for now in (0.1, 0.2):
        controls.press(key, now)
        assert controls.velocity(now) == STOP
        assert controls.velocity(now) is None


def test_latched_keys_stay_until_another_key() -> None:
    controls = Controls(latch=True)
    controls.press("i", 0.0)
    assert controls.velocity(1e6) == (2.0, 0.0, 0.0, 0.0)
    controls.press("l", 1e6)
    assert controls.velocity(2e6) == (0.0, 0.0, 0.0, -1.0)
    controls.press("k", 2e6)
    assert controls.velocity(2e6) == STOP
    assert controls.velocity(2e6) is None


def test_speed_keys_change_by_a_tenth_and_do_not_let_go() -> None:
    controls = Controls(speed=2.0, turn=1.0)
    controls.press("i", 0.0)
    for key, speed, turn in (("q", 2.2, 1.1), ("x", 1.98, 1.1), ("c", 1.98, 0.99)):
        controls.press(key, 0.1)
        assert (controls.speed, controls.turn) == pytest.approx((speed, turn))
    assert controls.velocity(0.2) == pytest.approx((1.98, 0.0, 0.0, 0.0))


def test_the_ground_key_is_said_while_held_and_once_after() -> None:
    controls = Controls(delay=0.6, timeout=0.15, latch=True)
    assert controls.hold(0.0) is None
    for now in (0.0, 0.03, 0.06):
        controls.press(HOLD, now)
    assert controls.hold(0.06) is True
    assert controls.hold(0.2) is True
    assert controls.hold(0.22) is False
    assert controls.hold(0.23) is None


def test_a_key_that_asks_once_needs_a_rest_between_its_events() -> None:
    controls = Controls(cooldown=0.25)
    assert controls.press("Tab", 0.0) is Action.CAMERA
    assert all(controls.press("Tab", 0.03 * i) is None for i in range(1, 40))
    assert controls.press("p", 1.2) is Action.IMAGE
    assert controls.press("Tab", 1.17 + 0.26) is Action.CAMERA


def test_release_lets_go_of_everything() -> None:
    controls = Controls(latch=True)
    controls.press("i", 0.0)
    controls.press(HOLD, 0.0)
    assert controls.velocity(0.0) != STOP
    assert controls.hold(0.0)
    controls.release()
    assert controls.velocity(0.0) == STOP
    assert controls.hold(0.0) is False


@given(st.lists(st.sampled_from([*MOVES, *SPEEDS, *ACTIONS, HOLD, "k"])))
def test_commands_stay_within_the_speeds_whatever_is_typed(typed: list[str]) -> None:
    controls = Controls()
    for i, key in enumerate(typed * 20):
        controls.press(key, 0.01 * i)
        velocity = controls.velocity(0.01 * i)
        assert velocity is None or max(map(abs, velocity)) <= SPEED_RANGE[1]
