"""Copies of a scene fly as if each were alone, in blocks or as Worlds."""

from collections.abc import Callable

import numpy as np
import pytest

from drone_engine import Scene
from drone_engine.fleet import Fleet
from drone_engine.world import World

Load = Callable[..., Scene]
DRONE = """drone: {model: drone, mass: 1.4, pose: [0, 0, 1], flight: {model: quadrotor}}
front_right: {model: rotor, parent: drone, pose: [0.19, -0.19, 0], rotor: {direction: 1}}
front_left: {model: rotor, parent: drone, pose: [0.19, 0.19, 0], rotor: {direction: -1}}
rear_left: {model: rotor, parent: drone, pose: [-0.19, 0.19, 0], rotor: {direction: 1}}
rear_right: {model: rotor, parent: drone, pose: [-0.19, -0.19, 0], rotor: {direction: -1}}"""
SLOWED = DRONE.replace("model: quadrotor", "model: quadrotor, quadrotor: {rotor_drag: 8.0e-5}")
BARE = DRONE.splitlines()[0]
FLOOR = "\nfloor: {model: floor, static: true, collision: {level: floor}}"
ALL = "effects: {gravity: {}, drag: {}, motor_lag: {}}"


def settings(rate: int, substeps: int, integrator: str, effects: str = ALL) -> str:
    return f"{effects}\nrates: {{physics: {rate}}}\ndynamics: {{integrator: {integrator}, substeps: {substeps}}}"


def scatter(fleet: Fleet, fastest: float = 3.0) -> np.ndarray:
    """Gives all copies different states, some upside down; returns different commands."""
    random = np.random.default_rng(7)
    fleet.state.position_w[:] = random.normal(size=(fleet.copies, 3))
    fleet.state.velocity_w[:] = random.normal(size=(fleet.copies, 3))
    fleet.state.angular_velocity_w[:] = fastest * random.normal(size=(fleet.copies, 3))
    turns = random.normal(size=(fleet.copies, 4))
    fleet.state.orientation_w[:] = turns / np.linalg.norm(turns, axis=1, keepdims=True)
    return random.uniform(-4, 4, (fleet.copies, 4))


def check(fleet: Fleet, k: int, world: World) -> None:
    """Asserts that the state of copy k equals that of the world, bit for bit."""
    alone = fleet.world(k)
    for name, array in world.state.arrays().items():
        if name not in ("rotor_rate", "awake", "still"):  # follow from the others
            np.testing.assert_array_equal(alone.state.arrays()[name], array, err_msg=name)


@pytest.mark.parametrize(("objects", "text"), [
    (DRONE, settings(240, 1, "midpoint")), (DRONE, settings(30, 8, "midpoint")),
    (DRONE, settings(240, 1, "semi_implicit_euler")), (DRONE, settings(30, 8, "semi_implicit_euler")),
    (BARE, settings(240, 1, "midpoint", "effects: {gravity: {acceleration: 3}}")),
    (BARE, settings(100, 2, "semi_implicit_euler", "effects: {gravity: {}, drag: {}}")),
    (SLOWED, settings(100, 3, "midpoint")), (SLOWED, settings(100, 3, "semi_implicit_euler"))])
def test_every_copy_is_a_world_bit_for_bit(scene: Load, objects: str, text: str) -> None:
    tiny = scene(objects, text)
    fleet = Fleet(tiny, 19)  # a block, and three more
    assert fleet.in_blocks
    commands = scatter(fleet)
    worlds = [fleet.world(k) for k in range(fleet.copies)]
    fleet.run(60, commands)
    fleet.run(200)  # until the dead-man stops them, at the faster rates
    for k, world in enumerate(worlds):
        world.command("drone", tuple(commands[k]))
        world.run(260)
        check(fleet, k, world)


@pytest.mark.parametrize("integrator", ["midpoint", "semi_implicit_euler"])
def test_every_copy_is_a_world_when_it_rotates_fast(scene: Load, integrator: str) -> None:
    fleet = Fleet(scene(DRONE, settings(30, 1, integrator)), 17)
    commands = scatter(fleet, 100.0)
    worlds = [fleet.world(k) for k in range(fleet.copies)]
    fleet.run(40, commands)
    for k, world in enumerate(worlds):
        world.command("drone", tuple(commands[k]))
        world.run(40)
        check(fleet, k, world)
    assert np.isfinite(fleet.state.angular_velocity_w).all()


def test_a_scene_with_contacts_runs_as_worlds(scene: Load) -> None:
    tiny = scene(DRONE + FLOOR)
    fleet = Fleet(tiny, 3)
    assert not fleet.in_blocks
    assert "floor" in fleet.why_not
    fleet.state.position_w[:, 2] = [1.0, 2.0, 3.0]
    fleet.run(60, (0.0, 0.0, -2.0, 0.0))
    for k, height in enumerate([1.0, 2.0, 3.0]):
        world = World(tiny)
        world.state.position_w[0, 2] = height
        world.command("drone", (0.0, 0.0, -2.0, 0.0))
        world.run(60)
        check(fleet, k, world)
    assert fleet.state.position_w[0, 2] < 0.1 < fleet.state.position_w[2, 2]


def test_writing_the_state_wakes_a_copy(scene: Load) -> None:
    fleet = Fleet(scene("floor: {model: floor, static: true, collision: {level: floor}}\n"
                        "drone: {model: drone, mass: 1.4, pose: [0, 0, 0.1], flight: {}}", "effects: {gravity: {}}"), 1)
    fleet.run(90, (0.0, 0.0, -1.0, 0.0))
    fleet.run(150)
    assert not fleet.worlds[0].state.is_awake[fleet.worlds[0].model.drones.body[0]]
    fleet.state.position_w[0] = 0.0, 0.0, 5.0
    fleet.state.velocity_w[0] = 3.0, 0.0, 0.0
    fleet.run(15)
    assert fleet.state.position_w[0, 0] > 0.1


@pytest.mark.parametrize(("objects", "text", "why"), [
    (DRONE.replace("model: quadrotor", "model: direct"), "effects: {gravity: {}}", "flight model"),
    (DRONE + "\nother: {model: drone, mass: 1, pose: [5, 0, 1], flight: {cmd_vel: a}}", "effects: {gravity: {}}",
     "more than one")])
def test_the_reason_for_worlds_is_given(scene: Load, objects: str, text: str, why: str) -> None:
    assert why in Fleet(scene(objects, text), 2).why_not


def test_seeds_are_the_copies_own(scene: Load) -> None:
    tiny = scene(DRONE + FLOOR, "effects: {gravity: {}}\nseed: 5")
    assert [world.scene.seed for world in Fleet(tiny, 3).worlds] == [5, 6, 7]
    assert [world.scene.seed for world in Fleet(tiny, 2, seeds=[9, 9]).worlds] == [9, 9]


def test_random_numbers_are_the_copies_own(scene: Load) -> None:
    windy = scene(DRONE, "effects: {gravity: {}, drag: {}, wind: {mean: [3, 0, 0]}, gusts: {}}")
    fleet = Fleet(windy, 3, seeds=[4, 5, 4])
    assert "'wind'" in fleet.why_not
    fleet.run(60)
    np.testing.assert_array_equal(fleet.state.position_w[0], fleet.state.position_w[2])
    assert np.abs(fleet.state.position_w[0] - fleet.state.position_w[1]).max() > 0.001


def test_a_reset_is_a_fresh_start(scene: Load) -> None:
    fleet = Fleet(scene(DRONE), 4)
    fleet.run(30, (1.0, 0.0, 0.0, 0.5))
    first = [array.copy() for array in fleet.state]
    fleet.reset()
    assert fleet.time == 0.0
    fleet.run(30, (1.0, 0.0, 0.0, 0.5))
    for array, before in zip(fleet.state, first, strict=True):
        np.testing.assert_array_equal(array, before)


def test_commands_may_differ_and_end(scene: Load) -> None:
    fleet = Fleet(scene(DRONE), 2)
    for _ in range(6):
        fleet.run(15, [(2.0, 0.0, 0.0, 0.0), (0.0, -1.0, 0.0, 0.0)])
    np.testing.assert_allclose(fleet.state.velocity_w, [[2, 0, 0], [0, -1, 0]], atol=0.05)
    fleet.run(120)
    assert np.abs(fleet.state.velocity_w).max() < 0.01


@pytest.mark.parametrize("bad", [(1.0, 2.0), (0.0, 0.0, 0.0, float("nan")), np.zeros((3, 4))])
def test_invalid_commands_are_refused(scene: Load, bad: object) -> None:
    fleet = Fleet(scene(DRONE), 2)
    before = fleet.state.command_b.copy()
    with pytest.raises(ValueError, match="expected four finite numbers, or 2 times four"):
        fleet.run(1, bad)  # type: ignore[arg-type]
    np.testing.assert_array_equal(fleet.state.command_b, before)
    assert fleet.time == 0.0


def test_invalid_fleets_are_refused(scene: Load) -> None:
    with pytest.raises(ValueError, match="copies: expected at least 1, got 0"):
        Fleet(scene(DRONE), 0)
    with pytest.raises(ValueError, match="seeds: expected 2 integers of at least 0"):
        Fleet(scene(DRONE), 2, seeds=[1])
    with pytest.raises(ValueError, match="no drone is called 'dron'; there are drone"):
        Fleet(scene(DRONE), 2, drone="dron")
    with pytest.raises(ValueError, match="no drone is called ''; there are none"):
        Fleet(scene("crate: {model: crate, mass: 1}"), 2)
