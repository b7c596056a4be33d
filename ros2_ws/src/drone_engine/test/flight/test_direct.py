"""Drones obey commands, stop after the dead-man, hold, land, and lose against what stands in the way."""

from collections.abc import Callable

import numpy as np
import pytest

from drone_engine.context import Context
from drone_engine.flight import direct
from drone_engine.program.program import Program
from drone_engine.scene.fields import Strict
from drone_engine.world import World

FLOOR = "floor: {model: floor, static: true, collision: {level: floor}}\n"
DRONE = ("drone: {model: drone, mass: 1.4, pose: [0, 0, 1], flight: {max_speed: 5, max_acceleration: 8}}\n"
         "rotor: {model: rotor, parent: drone, rotor: {direction: -1, speed: 50}}\n")
Make = Callable[..., World]
Command = tuple[float, float, float, float]
AHEAD: Command = (2.0, 0.0, 0.0, 0.0)


def fly(world: World, seconds: float, command: Command | None = None) -> None:
    for _ in range(round(seconds / world.dt)):
        world.step({"drone": command} if command else {})


def speed(world: World) -> float:
    return float(np.linalg.norm(world.state.velocity_w[world.model.drones.body[0]]))


def test_without_a_command_it_hovers_where_it_is(world: Make) -> None:
    hover = world(FLOOR + DRONE)
    fly(hover, 10.0)
    np.testing.assert_allclose(hover.pose("drone"), [0, 0, 1, 0, 0, 0, 1], atol=1e-6)
    assert hover.state.landed[0] == 0


@pytest.mark.parametrize(("command", "direction"), [
    ((2, 0, 0, 0), (1, 0, 0)), ((-2, 0, 0, 0), (-1, 0, 0)), ((0, 2, 0, 0), (0, 1, 0)), ((0, 0, 2, 0), (0, 0, 1))])
def test_it_flies_at_the_commanded_velocity(world: Make, command: Command, direction: tuple[int, int, int]) -> None:
    flight = world(DRONE)
    fly(flight, 3.0, command)
    np.testing.assert_allclose(flight.state.velocity_w[0], 2.0 * np.array(direction), atol=0.02)


def test_commands_are_in_the_body_frame_and_yaw_turns_it(world: Make) -> None:
    flight = world(DRONE.replace("[0, 0, 1]", "[0, 0, 1, 0, 0, 1.5707963]"))
    fly(flight, 2.0, AHEAD)
    np.testing.assert_allclose(flight.state.velocity_w[0], [0, 2, 0], atol=0.02)
    fly(flight, 2.0, (0.0, 0.0, 0.0, 1.0))
    assert flight.state.angular_velocity_w[0, 2] == pytest.approx(1.0, abs=0.02)


def test_the_dead_man_stops_it_and_it_holds(world: Make) -> None:
    flight = world(DRONE)
    fly(flight, 1.0, AHEAD)
    fly(flight, 0.4)
    assert speed(flight) == pytest.approx(2.0, abs=0.1)  # 0.5 s have not passed
    fly(flight, 3.0)
    assert speed(flight) < 0.01
    held = flight.pose("drone")
    fly(flight, 5.0)
    np.testing.assert_allclose(flight.pose("drone")[:3], held[:3], atol=0.01)


def test_limits_hold_for_any_finite_command(world: Make) -> None:
    flight = world(DRONE)
    last = 0.0
    for _ in range(90):
        flight.step({"drone": (1e308, -1e308, 0.0, 0.0)})
        assert (speed(flight) - last) / flight.dt < 8.0 * 1.01
        last = speed(flight)
    assert speed(flight) == pytest.approx(5.0, abs=0.1)
    fly(flight, 3.0, (0.0, 0.0, 0.0, 1e308))
    assert flight.state.angular_velocity_w[0, 2] == pytest.approx(2.5, abs=0.1)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -float("inf")])
def test_what_is_not_finite_never_reaches_the_state(world: Make, bad: float) -> None:
    flight, twin = world(DRONE), world(DRONE)
    for k in range(4):
        command = [0.0] * 4
        command[k] = bad
        with pytest.raises(ValueError, match="four finite numbers"):
            flight.step({"drone": tuple(command)})
    assert flight.state.hash() == twin.state.hash()


def test_an_unknown_drone_is_named(world: Make) -> None:
    with pytest.raises(ValueError, match="no drone is called 'dron'; there are drone"):
        world(DRONE).step({"dron": AHEAD})


def test_it_lands_stops_its_rotors_and_takes_off_again(world: Make) -> None:
    flight = world(FLOOR + DRONE)
    assert flight.state.rotor_rate[0] == -50.0
    fly(flight, 4.0, (0.0, 0.0, -0.8, 0.0))
    assert flight.state.landed[0] == 1
    assert flight.pose("drone")[2] == pytest.approx(0.08, abs=0.002)
    fly(flight, 3.0, (0.0, 0.0, -0.8, 0.0))
    assert flight.state.rotor_rate[0] == 0.0
    fly(flight, 1.0, (0.0, 0.0, 1.0, 0.0))
    assert flight.state.landed[0] == 0
    assert flight.pose("drone")[2] > 0.5
    assert flight.state.rotor_rate[0] < -40.0


def test_a_command_does_not_beat_a_wall(world: Make) -> None:
    flight = world(DRONE + "wall: {model: wall, static: true, pose: [3, 0, 0]}")
    fly(flight, 10.0, (5.0, 0.0, 0.0, 0.0))
    assert flight.pose("drone")[0] < 2.5 - 0.25 + 0.005
    assert speed(flight) < 0.02


def test_it_pushes_what_can_move_and_is_pushed_back(world: Make) -> None:
    flight = world(DRONE + "crate: {model: crate, mass: 3, pose: [3, 0, 0.7]}", "effects: {}")
    slowest = 5.0
    for _ in range(90):
        flight.step({"drone": (3.0, 0.0, 0.0, 0.0)})
        if flight.time > 0.8:
            slowest = min(slowest, flight.state.velocity_w[0, 0])
    assert flight.pose("crate")[0] > 3.5
    assert slowest < 2.0


def test_where_nothing_can_touch_nothing_is_looked_for(world: Make) -> None:
    alone, over_ground = ([stage.name for stage in world(text).program.stages] for text in (DRONE, FLOOR + DRONE))
    looked_for = [name for name in over_ground if name not in alone]
    assert {"broad phase", "contacts", "landing"} <= set(looked_for)


@pytest.mark.parametrize("asking", ["ground_effect", "downwash"])
def test_each_rotor_has_its_share_of_the_lift_where_an_effect_asks_for_it(world: Make, asking: str) -> None:
    two = world(DRONE + DRONE.splitlines()[1].replace("rotor:", "other:", 1))
    context = Context(two.model, two.state, two.forces, two.dt, 8, 0, {asking: Strict()})
    stages = direct.build(context, np.array([0]), np.zeros((1, 4)), 9.80665).step
    program = Program(stages)
    program.compile()
    program.run(1)
    np.testing.assert_allclose(two.forces.thrust, [1.4 * 9.80665 / 2] * 2)
    two.step()
    assert "thrust" not in [stage.name for stage in two.program.stages]
