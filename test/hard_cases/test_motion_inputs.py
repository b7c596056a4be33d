"""Commands: non-finite values are rejected, extreme ones limited, and the last one in a step applies."""

import numpy as np
import pytest

from drone_engine.world import Command, World
from reference.box_world import Box, Setting, world_of

WORST = (float("nan"), float("inf"), -float("inf"))
EXTREME = (1e308, -1e308, 5e-324, -5e-324, -0.0)
AHEAD = (2.0, 0.0, 0.0, 0.0)


def drone() -> World:
    return world_of({"drone": Box((0.5, 0.5, 0.16), (0.0, 0.0, 20.0), 1.4, extra="flight: {cmd_vel: cmd_vel}")},
                    Setting(), floor=0.0)


def fly(world: World, seconds: float, *commands: Command) -> None:
    """Gives all commands before each step, in this order."""
    for _ in range(round(seconds / world.dt)):
        for command in commands:
            world.command("drone", command)
        world.step()


@pytest.mark.parametrize("place", range(4))
@pytest.mark.parametrize("bad", WORST)
def test_a_non_finite_command_is_rejected_and_the_previous_one_stays(bad: float, place: int) -> None:
    world, undisturbed = drone(), drone()
    broken = tuple(bad if k == place else 1.0 for k in range(4))
    for _ in range(30):
        world.command("drone", AHEAD)
        with pytest.raises(ValueError, match="finite"):
            world.command("drone", broken)
        world.step()
    fly(undisturbed, 1.0, AHEAD)
    assert world.state.hash() == undisturbed.state.hash()


@pytest.mark.parametrize("place", range(4))
@pytest.mark.parametrize("extreme", EXTREME)
def test_extreme_commands_are_limited_to_the_limits_of_the_drone(extreme: float, place: int) -> None:
    world = drone()
    command = tuple(extreme if k == place else 0.0 for k in range(4))
    for _ in range(60):
        world.step({"drone": command})
        state = world.state
        for array in (state.position_w, state.orientation_w, state.velocity_w, state.angular_velocity_w):
            assert np.isfinite(array).all()
        assert np.linalg.norm(state.velocity_w[0]) < 8.5
        assert np.linalg.norm(state.angular_velocity_w[0]) < 6.0


def test_the_last_of_many_commands_in_a_step_applies() -> None:
    flooded, plain = drone(), drone()
    noise = [tuple(row) for row in np.random.default_rng(2).uniform(-5, 5, (32, 4))]  # at 1 kHz, by two publishers
    fly(flooded, 1.0, *noise, AHEAD)
    fly(plain, 1.0, AHEAD)
    assert flooded.state.hash() == plain.state.hash()


def test_without_commands_for_half_a_second_it_stops_and_holds_its_position() -> None:
    world = drone()
    fly(world, 2.0, AHEAD)
    fly(world, 0.45)
    assert world.state.velocity_w[0, 0] == pytest.approx(2.0, abs=0.1)
    fly(world, 5.0)
    position = world.state.position_w[0].copy()
    fly(world, 60.0)
    assert np.linalg.norm(world.state.position_w[0] - position) < 0.01


def test_without_any_command_it_holds_where_it_started() -> None:
    world = drone()
    start = world.state.position_w[0].copy()
    fly(world, 60.0)
    assert np.linalg.norm(world.state.position_w[0] - start) < 0.01
