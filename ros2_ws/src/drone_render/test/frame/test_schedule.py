"""The moments that are drawn: exact stamps, none twice, films without gaps."""

import numpy as np
import pytest

from drone_render.frame.history import FrameTimes, History
from drone_render.frame.poses import ORIGIN
from drone_render.frame.schedule import Due, Schedule
from drone_sim.wire.cdr import SECOND

START = np.array([ORIGIN, ORIGIN])
NAMES = ("drone", "tree")


def poses(x: float) -> np.ndarray:
    return np.array([[x, 0, 0, 0, 0, 0, 1]])


def run(physics: float, draw: float, film: float | None, steps: int, slow: float = 0.0) -> tuple[Schedule, list[Due]]:
    """Feeds states one period apart; a picture takes `slow` s of wall time."""
    schedule = Schedule(NAMES, START, physics, draw, film)
    drawn: list[Due] = []
    now = busy = 0.0
    for n in range(1, steps + 1):
        now = n / physics
        schedule.push(round(n * SECOND / physics), ["drone"], poses(float(n)), now)
        while busy < now + 1 / physics and (due := schedule.pop(max(busy, now + 0.999 / physics))):
            drawn.append(due)
            busy = max(busy, now) + slow
    while due := schedule.pop(np.inf):
        drawn.append(due)
    return schedule, drawn


@pytest.mark.parametrize(("physics", "draw"), [(30, 60), (60, 30), (240, 60), (30, 24), (1000, 60), (7, 60)])
def test_every_stamp_is_drawn_once_and_in_order(physics: float, draw: float) -> None:
    _, drawn = run(physics, draw, None, int(2 * physics))
    stamps = [due.moment.stamp for due in drawn]
    first = 1 / physics
    expected = [round(k * SECOND / draw) for k in range(1, int(2 * draw) + 1) if k / draw > first + 1e-6]
    assert stamps == expected


def test_a_moment_lies_between_its_states() -> None:
    _, drawn = run(30, 60, None, 4)
    for due in drawn:
        x = due.moment.poses()[0, 0]
        assert x == pytest.approx(due.moment.stamp / SECOND * 30, abs=1e-6)


def test_pictures_are_spread_over_the_time_between_two_states() -> None:
    schedule = Schedule(NAMES, START, 30, 60)
    for n in (1, 2):
        schedule.push(round(n * SECOND / 30), ["drone"], poses(0), n / 30)
    first = schedule.pop(2 / 30)
    assert first is not None and schedule.pop(2 / 30 + 0.01) is None
    assert schedule.wait(2 / 30) == pytest.approx(1 / 60)
    assert schedule.pop(2 / 30 + 1 / 60 + 1e-9) is not None


def test_transforms_of_other_frames_do_not_change_the_period() -> None:
    """The node also receives the transforms of its own moving cameras."""
    schedule = Schedule(NAMES, START, 30, 60)
    for n in range(1, 61):
        schedule.push(round(n * SECOND / 30), ["drone"], poses(0), n / 30)
        for k in (0.2, 0.4, 0.6):
            schedule.push(round(n * SECOND / 30), ["chase"], poses(0), (n + k) / 30)
        while n < 60 and schedule.pop(np.inf):
            pass
    first, second = schedule.pop(np.inf), schedule.pop(np.inf)
    assert first is not None and second is not None
    assert first.moment.after is second.moment.after
    assert second.at - first.at == pytest.approx(0.5 / 30)


def test_live_pictures_that_are_late_are_dropped_and_counted() -> None:
    schedule, drawn = run(30, 60, None, 60, slow=0.05)
    assert schedule.dropped > 30
    assert schedule.dropped + len(drawn) == 118


def test_a_film_drops_no_picture() -> None:
    schedule, drawn = run(30, 60, 30, 60, slow=0.05)
    film = [due.moment.stamp for due in drawn if due.film]
    assert film == [round(k * SECOND / 30) for k in range(2, 61)]
    assert schedule.dropped > 0 and not all(due.live for due in drawn)
    live = [due.moment.stamp for due in drawn if due.live]
    assert max(np.diff(live)) < 0.25 * SECOND  # live pictures are rarer, but continue


def test_after_time_went_back_drawing_goes_on_from_there() -> None:
    schedule = Schedule(NAMES, START, 30, 60)
    for stamp in (10 * SECOND, SECOND, SECOND + SECOND // 30):
        schedule.push(stamp, ["drone"], poses(0), 0.0)
    due = schedule.pop(np.inf)
    assert due is not None and SECOND < due.moment.stamp <= SECOND + SECOND // 30


def test_a_leap_ahead_is_not_drawn_through() -> None:
    schedule = Schedule(NAMES, START, 30, 60)
    for stamp in (SECOND, 5000 * SECOND):
        schedule.push(stamp, ["drone"], poses(0), 0.0)
    assert schedule.pop(np.inf) is None and schedule.dropped == 0


def test_unknown_names_are_ignored() -> None:
    history = History(NAMES, START)
    assert history.push(5, ["chase"], poses(9)) is None
    assert history.latest.stamp == 0
    history.push(5, ["chase", "tree"], np.vstack([poses(9), poses(4)]))
    np.testing.assert_array_equal(history.latest.poses[:, 0], [0, 4])


def test_invalid_poses_are_ignored() -> None:
    history = History(NAMES, START)
    broken = np.vstack([poses(np.nan), poses(7)])
    history.push(5, ["drone", "tree"], broken)
    broken[1, 3:] = 0.0
    history.push(6, ["drone", "tree"], broken)
    np.testing.assert_array_equal(history.latest.poses[:, 0], [0, 7])


def test_stamps_are_whole_multiples_of_the_period() -> None:
    assert list(FrameTimes(60).between(0, SECOND // 20)) == [16666667, 33333333, 50000000]
    assert list(FrameTimes(60).between(33333334, 50000000)) == [50000000]  # a rounded stamp is not due twice
