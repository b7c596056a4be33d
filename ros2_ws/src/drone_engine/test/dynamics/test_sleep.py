"""Islands fall asleep and wake as a whole, with the contacts that they had."""

from collections.abc import Callable

import numpy as np

from drone_engine.collision.events import Phase
from drone_engine.world import World

FLOOR = "floor: {model: floor, static: true, collision: {level: floor}}\n"
Make = Callable[..., World]


def run(world: World, seconds: float) -> None:
    """Steps a world."""
    world.run(round(seconds / world.dt))


def awake(world: World) -> set[str]:
    """Names of the bodies that are awake."""
    return {name for name, moves in zip(world.model.bodies.names, world.state.is_awake, strict=True) if moves}


def test_what_rests_falls_asleep_and_is_still_in_contact(world: Make) -> None:
    rest = world(FLOOR + "crate: {model: crate, mass: 5, poses: [[0, 0, 0], [0, 0, 0.6]]}")
    run(rest, 0.3)
    assert awake(rest) == {"crate_0", "crate_1"}
    run(rest, 5.0)
    assert not awake(rest)
    poses = rest.state.position_w.copy()
    run(rest, 1.0)
    np.testing.assert_array_equal(rest.state.position_w, poses)
    assert {event.phase for event in rest.events} == {Phase.PERSIST}


def test_an_island_wakes_as_a_whole_and_another_sleeps_on(world: Make) -> None:
    hit = world(FLOOR + "crate: {model: crate, mass: 5, poses: [[0, 0, 0], [0, 0, 0.6], [9, 0, 0]]}\n"
                        "ball: {model: crate, mass: 1, pose: [0, 0, 40]}")
    run(hit, 2.0)
    assert awake(hit) == {"ball"}
    while hit.time < 4.0 and awake(hit) == {"ball"}:
        hit.step()
    assert awake(hit) == {"ball", "crate_0", "crate_1"}


def test_what_floats_without_support_stays_awake(world: Make) -> None:
    still = world("crate: {model: crate, mass: 5, pose: [0, 0, 5]}\n" + FLOOR, "effects: {}")
    run(still, 3.0)
    assert awake(still) == {"crate"}


def test_an_island_continues_as_it_fell_asleep(world: Make) -> None:
    slept, never = (world(FLOOR + "crate: {model: crate, mass: 5, poses: [[0, 0, 0], [0, 0, 0.6], [0, 0, 1.2]]}",
                          f"effects: {{gravity: {{}}}}\ndynamics: {{sleep: {sleep}}}") for sleep in ("true", "false"))
    run(slept, 5.0)
    assert not awake(slept)
    slept.sleep.wake(np.array([1]))
    assert awake(slept) == {"crate_0", "crate_1", "crate_2"}
    run(slept, 0.2)
    run(never, 5.2)
    np.testing.assert_allclose(slept.state.position_w, never.state.position_w, atol=1e-5)
    assert np.abs(slept.state.velocity_w).max() < 1e-3
