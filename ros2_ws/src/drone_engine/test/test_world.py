"""A run repeats bit for bit, and what a scene does not name is not there."""

from collections.abc import Callable

import numpy as np
import pytest

from drone_engine import load
from drone_engine.world import World

Make = Callable[..., World]
BUSY = """floor: {model: floor, static: true, collision: {level: floor}}
drone: {model: drone, mass: 1.4, pose: [0, 0, 1], flight: {}}
rotor: {model: rotor, parent: drone, rotor: {direction: 1}}
crate: {model: crate, mass: 4, poses: [[1.5, 0, 0], [1.5, 0.1, 0.7], [1.6, 0, 1.5]]}
wall: {model: wall, static: true, pose: [4, 0, 0]}"""


def hashes(world: World, steps: int) -> list[str]:
    seen = []
    for i in range(steps):
        world.step({"drone": (3.0, 0.1, 0.0, 0.2)} if i % 40 < 25 else {})
        seen.append(world.state.hash())
    return seen


def test_two_runs_are_equal_bit_for_bit(world: Make) -> None:
    first = hashes(world(BUSY), 300)
    assert first == hashes(world(BUSY), 300)
    assert len(set(first)) == 300


def test_a_reset_is_a_fresh_start(world: Make) -> None:
    again = world(BUSY)
    first = hashes(again, 100)
    again.reset()
    assert hashes(again, 100) == first


def test_compiling_leaves_the_world_at_its_start(world: Make) -> None:
    compiled, fresh = world(BUSY), world(BUSY)
    told: list[str] = []
    compiled.compile(lambda done, total, name: told.append(f"{done}/{total} {name}"))
    assert told[0] == f"0/{len(told)} clear forces"
    assert told[-1] == f"{len(told) - 1}/{len(told)} clock"
    assert compiled.state.hash() == fresh.state.hash()
    assert hashes(compiled, 50) == hashes(fresh, 50)


def test_stages_are_what_the_scene_calls_for(world: Make) -> None:
    def stages(objects: str, rest: str) -> list[str]:
        return world(objects, rest).stage_names()

    crates, awake = "crate: {model: crate, mass: 1, poses: [[0, 0, 0], [2, 0, 0]]}", "dynamics: {sleep: false}\n"
    assert stages("crate: {model: crate, mass: 1}", "effects: {}") == ["motion", "motion: clear forces", "clock"]
    found = ["keep", "broad phase", "sweep", "contacts", "impacts", "warm start"]
    assert stages(crates, awake + "effects: {}") == [*found, "motion", "motion: clear forces", "catch", "clock"]
    assert stages(crates, "effects: {drag: {}, gravity: {}}") == [
        *found, "waking", "motion", "motion: clear forces", "motion: gravity", "motion: drag", "catch", "sleep",
        "clock"]
    assert stages(BUSY, awake + "effects: {}") == [
        "commands", "pilot", "direct", *found, "motion", "motion: clear forces", "motion: flight", "catch",
        "landing", "rotors", "clock"]


@pytest.mark.parametrize("nothing", ["drag: {density: 0}", "drag: {coefficient: 0}", "gravity: {acceleration: 0}"])
def test_an_effect_of_strength_zero_equals_its_absence(world: Make, nothing: str) -> None:
    assert hashes(world(BUSY, f"effects: {{{nothing}}}"), 100) == hashes(world(BUSY, "effects: {}"), 100)


def test_drag_slows_a_cube_as_the_closed_form_says(world: Make) -> None:
    glide = world("crate: {model: crate, mass: 2}",
                  "rates: {physics: 240}\neffects: {drag: {density: 1.2, coefficient: 1.0}}")
    glide.state.velocity_w[0, 0] = 10.0
    for _ in range(480):
        glide.step()
    rate = 0.5 * 1.2 * 0.36 / 2  # dv/dt = -rate v^2
    assert glide.state.velocity_w[0, 0] == pytest.approx(10 / (1 + rate * 10 * glide.time), rel=3e-3)


def test_the_island_runs_and_stays_finite() -> None:
    island = World(load("island"))
    start = island.object_poses()
    for i in range(900):
        island.step({"user_drone": (2.0, 0.5, 0.1, 0.3)} if i < 300 else {})
    assert np.isfinite(island.object_poses()).all()
    names = island.model.bodies.names
    for name in ("truck", "cottage", "palm_0", "rock_tall_0"):
        np.testing.assert_array_equal(island.pose(name), start[names.index(name)])
    person = names.index("person")
    assert np.linalg.norm(island.object_poses()[person, :3] - start[person, :3]) < 0.005



def test_a_pose_of_an_unknown_body_is_refused_in_one_line(world: Make) -> None:
    small = world("crate: {model: crate, mass: 1, pose: [0, 0, 2]}")
    np.testing.assert_allclose(small.pose("crate"), [0, 0, 2, 0, 0, 0, 1])
    with pytest.raises(ValueError, match=r"^no body is called 'crat'; there are crate$"):
        small.pose("crat")
