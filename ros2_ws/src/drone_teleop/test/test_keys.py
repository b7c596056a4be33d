"""What keys mean and when they count as held; the clock is the test's."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drone_teleop.keys import ACTIONS, GROUND, HELP, MOVES, SPEED_RANGE, SPEEDS, Action, Hand, Held

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
    extra = {*ACTIONS, GROUND}
    assert not extra & {*MOVES, *SPEEDS, "k", "K"}


def test_the_help_names_every_key() -> None:
    words = HELP.replace("/", " ").replace(":", " ").split()
    assert {*MOVES, *SPEEDS, *ACTIONS, GROUND, "k", "K"} <= set(words)


@pytest.mark.parametrize("key", MOVES)
def test_a_moving_key_commands_its_direction_at_the_speeds(key: str) -> None:
    hand = Hand(speed=3.0, turn=0.5)
    assert hand.press(key, 0.0) is None
    x, y, z, yaw = MOVES[key]
    assert hand.velocity(0.0) == (3.0 * x, 3.0 * y, 3.0 * z, 0.5 * yaw)


def test_a_tap_counts_until_its_first_repeat_must_have_come_then_stops_once() -> None:
    hand = Hand(delay=0.6, timeout=0.15)
    assert hand.velocity(0.0) is None
    hand.press("i", 1.0)
    assert hand.velocity(1.59) == (2.0, 0.0, 0.0, 0.0)
    assert hand.velocity(1.6) == STOP
    assert hand.velocity(1.61) is None
    assert hand.velocity(9.0) is None


@pytest.mark.parametrize("first_repeat", [0.25, 0.5])
def test_a_held_key_counts_without_a_gap_and_stops_soon_after_it_is_let_go(first_repeat: float) -> None:
    held = Held(delay=0.6, timeout=0.15)
    events = [0.0, *(first_repeat + i / 30 for i in range(30))]
    for event, after in zip(events, [*events[1:], events[-1]], strict=True):
        held.press("i", event)
        assert held.at(after) == "i"
    assert held.at(events[-1] + 0.149) == "i"
    assert held.at(events[-1] + 0.151) is None


def test_a_second_tap_has_the_time_of_a_first() -> None:
    held = Held(delay=0.6, timeout=0.15)
    held.press("i", 0.0)
    held.press("i", 0.3)
    assert held.at(0.89) == "i"
    assert held.at(0.9) is None


def test_another_key_takes_over_at_once() -> None:
    hand = Hand()
    for now in (0.0, 0.03, 0.06):
        hand.press("i", now)
    hand.press("J", 0.09)
    assert hand.velocity(0.09) == (0.0, 2.0, 0.0, 0.0)
    assert hand.velocity(0.6) == (0.0, 2.0, 0.0, 0.0)  # a first press, which has the longer time


@pytest.mark.parametrize("key", ["k", "K", "5", "Esc", "\x1b[A", "é"])
def test_anything_else_stops_and_says_so_even_when_nothing_moved(key: str) -> None:
    hand = Hand()
    hand.press("i", 0.0)
    for now in (0.1, 0.2):
        hand.press(key, now)
        assert hand.velocity(now) == STOP
        assert hand.velocity(now) is None


def test_latched_keys_stay_until_another_key() -> None:
    hand = Hand(latch=True)
    hand.press("i", 0.0)
    assert hand.velocity(1e6) == (2.0, 0.0, 0.0, 0.0)
    hand.press("l", 1e6)
    assert hand.velocity(2e6) == (0.0, 0.0, 0.0, -1.0)
    hand.press("k", 2e6)
    assert hand.velocity(2e6) == STOP
    assert hand.velocity(2e6) is None


def test_speed_keys_change_by_a_tenth_and_do_not_let_go() -> None:
    hand = Hand(speed=2.0, turn=1.0)
    hand.press("i", 0.0)
    for key, speed, turn in (("q", 2.2, 1.1), ("x", 1.98, 1.1), ("c", 1.98, 0.99)):
        hand.press(key, 0.1)
        assert (hand.speed, hand.turn) == pytest.approx((speed, turn))
    assert hand.velocity(0.2) == pytest.approx((1.98, 0.0, 0.0, 0.0))


def test_the_ground_key_is_said_while_held_and_once_after() -> None:
    hand = Hand(delay=0.6, timeout=0.15, latch=True)
    assert hand.grounds(0.0) is None
    for now in (0.0, 0.03, 0.06):
        hand.press(GROUND, now)
    assert hand.grounds(0.06) is True
    assert hand.grounds(0.2) is True
    assert hand.grounds(0.22) is False
    assert hand.grounds(0.23) is None


def test_a_key_that_asks_once_needs_a_rest_between_its_events() -> None:
    hand = Hand(cooldown=0.25)
    assert hand.press("Tab", 0.0) is Action.CAMERA
    assert all(hand.press("Tab", 0.03 * i) is None for i in range(1, 40))
    assert hand.press("p", 1.2) is Action.PICTURE
    assert hand.press("Tab", 1.17 + 0.26) is Action.CAMERA


def test_release_lets_go_of_everything() -> None:
    hand = Hand(latch=True)
    hand.press("i", 0.0)
    hand.press(GROUND, 0.0)
    assert hand.velocity(0.0) != STOP
    assert hand.grounds(0.0)
    hand.release()
    assert hand.velocity(0.0) == STOP
    assert hand.grounds(0.0) is False


@given(st.lists(st.sampled_from([*MOVES, *SPEEDS, *ACTIONS, GROUND, "k"])))
def test_commands_stay_within_the_speeds_whatever_is_typed(typed: list[str]) -> None:
    hand = Hand()
    for i, key in enumerate(typed * 20):
        hand.press(key, 0.01 * i)
        velocity = hand.velocity(0.01 * i)
        assert velocity is None or max(map(abs, velocity)) <= SPEED_RANGE[1]
