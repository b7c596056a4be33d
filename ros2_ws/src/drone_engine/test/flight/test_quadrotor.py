"""The quadrotor: its rotors make the right forces, its loops fly it, and what it cannot do it gives up well."""

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine import Scene, SceneError, effects
from drone_engine.flight.control import lift, mix, rotor_drag
from drone_engine.flight.craft import Craft, numbers
from drone_engine.flight.quadrotor import row_of
from drone_engine.kernel import kernel
from drone_engine.scene.schema import Flight
from drone_engine.world import World

G = 9.80665
K, RATIO, MOST = 8.54858e-06, 0.016, 8.54858e-06 * 838.0**2  # the Iris of RotorS
LAG = "effects: {gravity: {}, motor_lag: {}}"
FLOOR = "floor: {model: floor, static: true, collision: {level: floor}}\n"
BARE = ("drone: {model: drone, mass: 1.4, pose: [0, 0, 1],\n"
        "        flight: {model: quadrotor, max_speed: 5, max_acceleration: 6}}\n")
ROTORS = """front_right: {model: rotor, parent: drone, pose: [0.2, -0.2, 0], rotor: {direction: 1}}
front_left: {model: rotor, parent: drone, pose: [0.2, 0.2, 0], rotor: {direction: -1}}
rear_left: {model: rotor, parent: drone, pose: [-0.2, 0.2, 0], rotor: {direction: 1}}
rear_right: {model: rotor, parent: drone, pose: [-0.2, -0.2, 0], rotor: {direction: -1}}
"""
DRONE = BARE + ROTORS
Make = Callable[..., World]
Command = tuple[float, float, float, float]
IRIS = Craft(*numbers(Flight(model="quadrotor"), 1.5, np.array([0.035, 0.046, 0.098]),
                      ((0.13, -0.22, 1), (-0.13, 0.20, 1), (0.13, 0.22, -1), (-0.13, -0.20, -1)), 1 / 240))


@kernel
def mixed(c, thrust, tx, ty, tz):
    return mix(c, thrust, tx, ty, tz)


@kernel
def lifted(c, qx, qy, qz, qw, n0, n1, n2, n3):
    return lift(c, qx, qy, qz, qw, n0, n1, n2, n3)


@kernel
def slowed(c, n0, n1, n2, n3, vx, vy, vz, dt):
    return rotor_drag(c, 0.0, 0.0, 0.0, 1.0, n0, n1, n2, n3, vx, vy, vz, dt)


def rates(rate: int, substeps: int, rest: str = LAG) -> str:
    return f"{rest}\nrates: {{physics: {rate}}}\ndynamics: {{substeps: {substeps}}}"


def fly(world: World, seconds: float, command: Command | None = None) -> np.ndarray:
    """Velocities after each step, (n, 3)."""
    seen = []
    for _ in range(round(seconds / world.dt)):
        world.step({"drone": command} if command else {})
        seen.append(world.state.velocity_w[world.model.drones.body[0]].copy())
    return np.array(seen)


def turned(world: World) -> np.ndarray:
    """Its rotors' rates, rad/s."""
    return world.state.memory["rotor_speed"][0]


def torques(thrusts: np.ndarray) -> np.ndarray:
    """Thrust and the torques about the body's axes, from where the Iris's rotors are."""
    x, y, s = np.array([[0.13, -0.13, 0.13, -0.13], [-0.22, 0.20, 0.22, -0.20], [1, 1, -1, -1]])
    return np.array([thrusts.sum(), (y * thrusts).sum(), -(x * thrusts).sum(), -RATIO * (s * thrusts).sum()])


def test_it_hovers_with_rotors_that_carry_a_quarter_each(world: Make) -> None:
    hover = world(DRONE, LAG)
    rate = math.sqrt(1.4 * G / (4 * K))
    np.testing.assert_allclose(turned(hover), rate, rtol=1e-12)
    fly(hover, 10.0)
    np.testing.assert_allclose(turned(hover), rate, rtol=1e-9)
    np.testing.assert_allclose(hover.pose("drone"), [0, 0, 1, 0, 0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(hover.forces.thrust, 1.4 * G / 4, rtol=1e-9)
    np.testing.assert_allclose(hover.state.rotor_rate, rate * np.array([1, -1, 1, -1]), rtol=1e-9)


def test_where_the_scene_has_no_rotors_the_published_ones_carry_it(world: Make) -> None:
    hover = world(BARE, LAG)
    thrusts = K * turned(hover) ** 2
    np.testing.assert_allclose(torques(thrusts), [1.4 * G, 0, 0, 0], atol=1e-12)
    fly(hover, 5.0)
    np.testing.assert_allclose(hover.pose("drone"), [0, 0, 1, 0, 0, 0, 1], atol=1e-9)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_thrust_and_torque_are_those_of_the_rotors(axis: int) -> None:
    speeds = np.array([500.0, 600.0, 650.0, 420.0])
    total, roll, pitch, yaw = torques(K * speeds**2)
    level = lifted(IRIS, 0.0, 0.0, 0.0, 1.0, *speeds)
    np.testing.assert_allclose(level, [*(K * speeds**2), 0, 0, total, roll, pitch, yaw], atol=1e-12)
    quarter = [0.0, 0.0, 0.0, math.sqrt(0.5)]
    quarter[axis] = math.sqrt(0.5)  # a quarter turn about this axis
    force = [(0, -total, 0), (total, 0, 0), (0, 0, total)][axis]
    torque = [(roll, -yaw, pitch), (yaw, pitch, -roll), (-pitch, roll, yaw)][axis]
    np.testing.assert_allclose(lifted(IRIS, *quarter, *speeds)[4:], [*force, *torque], atol=1e-12)


@settings(deadline=None)
@given(thrust=st.floats(0.0, 30.0), roll=st.floats(-0.6, 0.6), pitch=st.floats(-0.35, 0.35), yaw=st.floats(-0.3, 0.3))
def test_mixing_keeps_the_attitude(thrust: float, roll: float, pitch: float, yaw: float) -> None:
    thrusts = np.array(mixed(IRIS, thrust, roll, pitch, yaw))
    least = K * 100.0**2
    assert thrusts.min() >= least - 1e-12
    assert thrusts.max() <= MOST + 1e-12
    total, *turns = torques(thrusts)
    np.testing.assert_allclose(turns[:2], [roll, pitch], atol=1e-9)
    assert min(0.0, yaw) - 1e-9 <= turns[2] <= max(0.0, yaw) + 1e-9
    if abs(turns[2] - yaw) > 1e-9:  # it is given up only where a rotor can do no more
        assert min(thrusts.min() - least, MOST - thrusts.max()) < 1e-9
    little = float(np.clip(yaw, -IRIS.little_yaw, IRIS.little_yaw))
    assert abs(turns[2]) >= abs(little) - 1e-9
    straight = np.array(mixed(IRIS, thrust, roll, pitch, little))  # and no thrust is given up for more than that
    assert total == pytest.approx(straight.sum(), abs=1e-9)
    if abs(total - thrust) > 1e-9:
        assert min(straight.min() - least, MOST - straight.max()) < 1e-9


@pytest.mark.parametrize("thrust", [0.0, 15.0, 100.0])
@pytest.mark.parametrize("torque", [(0.0, 0.0, 0.0), (5.0, 0.0, 0.0), (0.0, -5.0, 0.0), (5.0, 5.0, 0.0)])
def test_mixing_what_rotors_cannot_do_and_no_yaw_gives_numbers(thrust: float, torque: tuple[float, ...]) -> None:
    assert np.isfinite(mixed(IRIS, thrust, *torque)).all()


def test_more_torque_than_there_is_keeps_its_direction() -> None:
    thrusts = np.array(mixed(IRIS, 15.0, 3.0, 1.5, 0.2))
    _, roll, pitch, yaw = torques(thrusts)
    assert roll > 0.8
    assert pitch / roll == pytest.approx(0.5, abs=0.1)
    assert 0.0 <= yaw <= IRIS.little_yaw


@pytest.mark.parametrize("rest", [LAG, "effects: {gravity: {}}"], ids=["lag", "none"])
@pytest.mark.parametrize(("rate", "substeps"), [(240, 1), (30, 8), (1000, 1), (60, 2)])
@pytest.mark.parametrize(("command", "axis"), [((2, 0, 0, 0), 0), ((0, -2, 0, 0), 1), ((0, 0, 2, 0), 2)])
def test_a_step_of_the_command_settles(world: Make, rest: str, rate: int, substeps: int, command: Command,
                                       axis: int) -> None:
    flight = world(DRONE, rates(rate, substeps, rest))
    share = fly(flight, 3.0, command)[:, axis] / command[axis]
    assert share.max() < 1.02
    assert np.abs(share[round(1.8 * rate):] - 1.0).max() < 0.02
    assert np.argmax(share > 0.9) / rate < 1.0
    if axis < 2:
        assert flight.pose("drone")[2] == pytest.approx(1.0, abs=0.1)


def test_thirty_steps_of_eight_fly_as_two_hundred_and_forty(world: Make) -> None:
    fine, coarse = world(DRONE, rates(240, 1)), world(DRONE, rates(30, 8))
    fly(fine, 2.0, (2.0, 1.0, 0.3, 0.0))
    fly(coarse, 2.0, (2.0, 1.0, 0.3, 0.0))
    np.testing.assert_allclose(coarse.pose("drone"), fine.pose("drone"), atol=3e-3)


def test_commands_turn_with_the_heading(world: Make) -> None:
    flight = world(DRONE.replace("[0, 0, 1]", "[0, 0, 1, 0, 0, 1.5707963]"), LAG)
    assert np.allclose(fly(flight, 2.5, (2.0, 0.0, 0.0, 0.0))[-1], [0, 2, 0], atol=0.02)
    fly(flight, 2.5, (0.0, 0.0, 0.0, 1.0))
    assert flight.state.angular_velocity_w[0, 2] == pytest.approx(1.0, abs=0.02)


def test_limits_hold_for_any_finite_command(world: Make) -> None:
    flight = world(DRONE, rates(240, 1))
    speeds = fly(flight, 3.0, (1e308, -1e308, 0.0, 0.0))
    assert np.linalg.norm(speeds, axis=1).max() < 5.0 * 1.01
    assert np.linalg.norm(speeds[-1]) == pytest.approx(5.0, abs=0.05)
    assert np.linalg.norm(np.diff(speeds, axis=0), axis=1).max() * 240 < 6.0 * 1.1
    fly(flight, 3.0, (0.0, 0.0, 0.0, 1e308))
    assert flight.state.angular_velocity_w[0, 2] == pytest.approx(2.5, abs=0.05)


def test_the_dead_man_stops_it_and_it_holds(world: Make) -> None:
    flight = world(DRONE, LAG)
    fly(flight, 1.5, (2.0, 0.0, 0.0, 0.0))
    assert fly(flight, 0.4)[-1, 0] == pytest.approx(2.0, abs=0.1)  # 0.5 s have not passed
    fly(flight, 3.0)
    held = flight.pose("drone")
    fly(flight, 5.0)
    np.testing.assert_allclose(flight.pose("drone")[:3], held[:3], atol=0.01)
    assert np.abs(fly(flight, 0.1)).max() < 0.001


def test_what_pushes_it_is_found_out_and_met(world: Make) -> None:
    """Without that, a steady drag of 1 m/s^2 would leave an error of 1/3 m/s, and wind move the place that is held."""
    dragged = world(DRONE, "effects: {gravity: {}, drag: {}, motor_lag: {}}")
    np.testing.assert_allclose(fly(dragged, 6.0, (4.0, 0.0, 0.0, 0.0))[-1], [4, 0, 0], atol=0.02)
    stubborn = DRONE.replace("model: quadrotor", "model: quadrotor, quadrotor: {gains: {disturbance: 0}}")
    assert fly(world(stubborn, "effects: {gravity: {}, drag: {}}"), 6.0, (4.0, 0.0, 0.0, 0.0))[-1, 0] < 3.8


def test_it_holds_its_place_in_wind(world: Make) -> None:
    windy = world(DRONE, "effects: {gravity: {}, drag: {}, motor_lag: {}, wind: {mean: [4, 1, 0]}}")
    fly(windy, 12.0)  # blown off at first, it comes back to the place where it first stood still
    place = windy.pose("drone")[:3]
    fly(windy, 5.0)
    np.testing.assert_allclose(windy.pose("drone")[:3], place, atol=0.02)
    np.testing.assert_allclose(windy.pose("drone")[:3], windy.state.hold_w[0], atol=0.02)


def test_it_lands_stops_its_rotors_and_takes_off_again(world: Make) -> None:
    flight = world(FLOOR + DRONE, LAG)
    fly(flight, 4.0, (0.0, 0.0, -0.8, 0.0))
    assert flight.state.landed[0] == 1
    assert flight.pose("drone")[2] == pytest.approx(0.08, abs=0.002)
    fly(flight, 1.0)
    np.testing.assert_array_equal(turned(flight), 0.0)
    np.testing.assert_array_equal(flight.state.rotor_rate, 0.0)
    fly(flight, 1.5, (0.0, 0.0, 1.0, 0.0))
    assert flight.state.landed[0] == 0
    assert flight.pose("drone")[2] > 0.5
    assert turned(flight).min() > 500.0


def test_a_command_does_not_beat_a_wall(world: Make) -> None:
    flight = world(DRONE + "wall: {model: wall, static: true, pose: [3, 0, 0]}", LAG)
    fly(flight, 10.0, (1.0, 0.0, 0.0, 0.0))
    assert flight.pose("drone")[0] < 2.5 - 0.2
    assert np.linalg.norm(fly(flight, 0.1, (1.0, 0.0, 0.0, 0.0))[-1]) < 0.1


def test_upside_down_it_turns_over_and_stops(world: Make) -> None:
    flight = world(DRONE.replace("[0, 0, 1]", "[0, 0, 30, 3.14159265358979, 0, 0]"), LAG)
    fly(flight, 10.0)
    q = flight.pose("drone")[3:]
    assert 1.0 - 2.0 * (q[0] ** 2 + q[1] ** 2) > 0.9999  # the z axis points up
    assert np.abs(fly(flight, 0.1)).max() < 0.1
    assert flight.pose("drone")[2] > 20.0


@pytest.mark.parametrize("spin", [(20.0, 0.0, 0.0), (0.0, -20.0, 0.0), (8.0, -8.0, 5.0), (0.0, 0.0, -5.0)])
@pytest.mark.parametrize("roll", [0.0, 1.5, 3.0])
def test_a_wild_spin_is_braked(world: Make, spin: tuple[float, float, float], roll: float) -> None:
    """Even one about the z axis, which the rotors can hardly brake: without care it goes on for ever, tilted."""
    flight = world(DRONE.replace("[0, 0, 1]", f"[0, 0, 200, {roll}, 0, 0]"), rates(240, 1))
    flight.state.angular_velocity_w[0] = spin
    fly(flight, 25.0)
    assert np.abs(flight.state.angular_velocity_w[0]).max() < 0.1
    assert np.abs(fly(flight, 0.1)).max() < 1.01  # at rest, or on its way back to where it was first


def test_motor_lag_is_an_exponential(world: Make) -> None:
    down = world(DRONE, rates(240, 1))
    down.state.landed[0] = 1  # in the air, so that they run down and nothing else turns them
    start = turned(down).copy()
    for i in range(1, 12):
        down.step()
        np.testing.assert_allclose(turned(down), start * math.exp(-i / 240 / 0.025), rtol=1e-12)
    band = "quadrotor: {min_rate: 699.9999, max_rate: 700}"  # so that 700 rad/s is all that they can be told
    up = world(DRONE.replace("model: quadrotor", f"model: quadrotor, {band}"), rates(50, 4))
    turned(up)[:] = 0.0
    for i in range(1, 6):
        up.step()
        np.testing.assert_allclose(turned(up), 700.0 * (1 - math.exp(-i / 50 / 0.0125)), atol=2e-4)


def test_the_lag_within_a_step_is_that_of_many_steps(world: Make) -> None:
    """The rates at an instant are exact, so that falling with rotors running down converges as the scheme does."""
    heights = []
    for substeps in (8, 16, 64):
        fall = world(DRONE, rates(30, substeps))
        fall.state.landed[0] = 1
        fall.run(6)
        heights.append(fall.state.position_w[0, 2])
    assert abs(heights[0] - heights[2]) / abs(heights[1] - heights[2]) == pytest.approx(4.0, abs=0.5)  # second order


def test_without_motor_lag_it_is_as_if_that_did_not_exist(world: Make, scene: Callable[..., Scene],
                                                          monkeypatch: pytest.MonkeyPatch) -> None:
    def hashes(flight: World) -> list[str]:
        return [flight.step({"drone": (1.0, 0.5, 0.2, 0.3)}) or flight.state.hash() for _ in range(60)]

    plain = world(DRONE)
    programs = (plain.program, plain.force_program, plain.substep_program)
    stages = [stage.name for program in programs for stage in program.stages]
    assert "motor_lag" not in stages
    assert "motor_lag" in [stage.name for stage in world(DRONE, LAG).substep_program.stages]
    before = hashes(plain)
    monkeypatch.delitem(effects.EFFECTS, "motor_lag")
    monkeypatch.setitem(sys.modules, "drone_engine.effects.motor_lag", None)
    assert hashes(world(DRONE)) == before
    with pytest.raises(SceneError, match="motor_lag: unknown effect"):
        world(DRONE, LAG)


def test_the_rotors_drag_is_what_their_rates_and_speed_make_it(world: Make) -> None:
    c = IRIS._replace(rotor_drag=8.06428e-5)
    np.testing.assert_allclose(slowed(c, 600.0, 610.0, 620.0, 630.0, 3.0, -2.0, 5.0, 0.01),
                               -8.06428e-5 * 2460.0 * np.array([3.0, -2.0, 0.0]), rtol=1e-12)
    np.testing.assert_allclose(slowed(c, 600.0, 600.0, 600.0, 600.0, 3.0, 0.0, 0.0, 100.0)[0],
                               -effects.STABLE * 1.5 * 3.0 / 100.0)
    through_air = world(DRONE.replace("model: quadrotor", "model: quadrotor, quadrotor: {rotor_drag: 8.06428e-5}"), LAG)
    flown = fly(through_air, 5.0, (4.0, 0.0, 0.0, 0.0))[-1, 0]
    push = through_air.state.memory["expected_velocity_and_push"][0, 3]
    assert push == pytest.approx(-8.06428e-5 * turned(through_air).sum() * flown / 1.4, rel=0.05)
    assert "rotor drag" not in [stage.name for stage in world(DRONE, LAG).force_program.stages]


def test_both_models_fly_in_one_scene_and_only_the_quadrotors_rotors_are_its_own(world: Make) -> None:
    other = ("other: {model: drone, mass: 2, pose: [5, 5, 1], flight: {cmd_vel: b}}\n"
             "spinner: {model: rotor, parent: other, rotor: {direction: -1, speed: 50}}\n")
    both, alone = world(other + DRONE, LAG), world(DRONE, LAG)
    for _ in range(60):
        both.step({"other": (1.0, 0.0, 0.0, 0.0), "drone": (0.0, 1.0, 0.0, 0.0)})
        alone.step({"drone": (0.0, 1.0, 0.0, 0.0)})
    np.testing.assert_array_equal(both.pose("drone"), alone.pose("drone"))
    assert both.state.velocity_w[0, 0] == pytest.approx(1.0, abs=0.05)
    assert both.state.rotor_rate[0] == -50.0
    np.testing.assert_array_equal(np.abs(both.state.rotor_rate[1:]), turned(both))


@pytest.mark.parametrize(("flight", "error"), [
    ("{quadrotor: {}}", "objects.drone.flight: 'quadrotor' needs 'model: quadrotor'"),
    ("{model: quadrotor, quadrotor: {min_rate: 900}}",
     "objects.drone.flight.quadrotor: min_rate: expected less than max_rate, 838, got 900"),
    ("{model: quadrotor, quadrotor: {max_rate: -1}}",
     "objects.drone.flight.quadrotor.max_rate: Input should be greater than 0"),
    ("{model: quadrotor, quadrotor: {thrust: 1}}",
     "objects.drone.flight.quadrotor.thrust: unknown key; allowed are arms"),
    ("{model: helicopter}",
     "objects.drone.flight.model: 'helicopter': unknown flight model; there are direct, quadrotor"),
    ("{model: quadrotor, quadrotor: {arms: [[1, 0, 1], [2, 0, 1], [3, 0, -1], [4, 0, -1]]}}",
     "objects.drone.flight: its four rotors cannot rotate it about every axis"),
    ("{model: quadrotor, quadrotor: {arms: [[3, 1, 1], [1, -1, 1], [1, 1, -1], [3, -1, -1]]}}",
     "objects.drone.flight: its centre of mass is not between its four rotors")])
def test_what_cannot_fly_is_one_line(world: Make, flight: str, error: str) -> None:
    with pytest.raises(SceneError) as caught:
        world(f"drone: {{model: drone, mass: 1, flight: {flight}}}")
    line = str(caught.value)
    assert error in line
    assert "tiny.yaml: " in line
    assert "\n" not in line


def test_the_same_airframe_for_the_same_scene(world: Make) -> None:
    row = row_of(world(DRONE).model, 0, 1 / 240, Path("tiny.yaml"))
    c = Craft(*row)
    assert (c.mass, c.thrust_coefficient, c.x0, c.y0, c.s0) == (1.4, K, 0.2, -0.2, 1.0)
    assert (c.rate_gain, c.attitude_gain, c.velocity_gain) == (20.0, 8.0, 3.0)
    coarse = Craft(*row_of(world(DRONE).model, 0, 1 / 30, Path("tiny.yaml")))
    assert coarse.rate_gain == pytest.approx(0.35 * 30)  # no more than the sub-step can follow
