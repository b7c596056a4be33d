"""`drone_engine explain` is right about what is on, what is off and why, and about the cost of stages."""

import io
import json
import re
import time
from collections.abc import Callable

import numpy as np
import pytest
from rich.console import Console

from drone_engine import Scene, effects
from drone_engine import __main__ as command
from drone_engine.explain.__main__ import explain, main
from drone_engine.explain.costs import compiled, measure
from drone_engine.explain.features import features
from drone_engine.program.profile import Laps, reading, times
from drone_engine.program.program import Program
from drone_engine.program.stage import in_python
from drone_engine.world import World

Make = Callable[..., World]
DRONE = ("drone: {model: drone, mass: 1.4, pose: [0, 0, 1], flight: {}}\n"
         "rotor: {model: rotor, parent: drone, pose: [0, 0, 0.1], rotor: {direction: 1}}\n")
CRATE = "crate: {model: crate, mass: 4, poses: [[1.5, 0, 1], [1.5, 0.1, 1.7]]}\n"


def told(world: World) -> dict[tuple[str, str], tuple[bool, str]]:
    return {(group, name): (on, why) for group, name, on, why in features(world)}


def test_every_effect_is_on_or_off_and_says_why(world: Make) -> None:
    found = told(world(CRATE, "effects: {gravity: {acceleration: 1.6}, ground_effect: {}, gusts: {}}"))
    assert {name for group, name in found if group == "effects"} == set(effects.EFFECTS)
    assert found["effects", "drag"] == (False, "not in the scene")
    assert found["effects", "gravity"] == (True, "acceleration 1.6")
    assert found["effects", "ground_effect"] == (False, "in the scene, but no drone in the scene has rotors")
    on, why = found["effects", "gusts"]
    assert on and why.endswith("nothing uses the velocity of the air: add drag or linear_drag")
    on, why = told(world(CRATE, "effects: {drag: {}, gusts: {}}"))["effects", "gusts"]
    assert on and "nothing uses" not in why


def test_flight_and_collision_are_explained(world: Make) -> None:
    bare, flying = told(world(CRATE, "effects: {}")), told(world(DRONE + CRATE, "effects: {}"))
    assert bare["flight", "direct"] == bare["flight", "quadrotor"] == (False, "no drone in the scene")
    assert bare["flight", "rotors"] == (False, "no object is a rotor")
    assert flying["flight", "direct"] == (True, "drone")
    assert flying["flight", "quadrotor"] == (False, "no drone uses it")
    assert flying["collision", "meshes"] == (False, "no mesh is read: no pair uses octree or triangle")
    fine = told(world(DRONE + CRATE, "collision: {level: triangle}"))
    assert fine["collision", "triangle"][0] and not fine["collision", "obb"][0]
    assert fine["collision", "meshes"] == (True, "drone, crate_0, crate_1")
    euler = told(world(CRATE, "dynamics: {integrator: semi_implicit_euler}"))
    assert euler["dynamics", "semi_implicit_euler"][0]
    assert euler["dynamics", "midpoint"] == (False, "the scene uses semi_implicit_euler")
    assert bare["dynamics", "sleep"] == (True, "bodies at rest are skipped until something touches them")
    assert told(world(CRATE, "dynamics: {sleep: false}"))["dynamics", "sleep"] == (False, "the scene has sleep: false")
    assert told(world(CRATE, "effects: {gusts: {}}"))["dynamics", "sleep"] == (False, "gusts may move bodies at rest")
    assert bare["picture", "water"] == (False, "not in the scene")


def test_clock_readings_between_stages_change_nothing(world: Make) -> None:
    plain = world(DRONE + CRATE, "effects: {gravity: {}, drag: {}}")
    timed = World(plain.scene, timed=True)
    plain.run(100)
    timed.run(100)
    assert timed.state.hash() == plain.state.hash()
    told: dict[bool, list[tuple[int, int, str]]] = {True: [], False: []}
    for which, built in ((True, timed), (False, plain)):
        built.compile(lambda *words, which=which: told[which].append(words))  # type: ignore[misc]
    assert told[True] == told[False]
    assert timed.stage_names() == plain.stage_names() == list(timed.stage_times())


def test_stages_take_as_long_as_the_steps_that_they_make_up(world: Make) -> None:
    timed = World(world(DRONE + CRATE, "effects: {gravity: {}}").scene, timed=True)
    timed.run(10)
    timed.stage_times()
    before = time.perf_counter()
    timed.run(200)
    wall = time.perf_counter() - before
    spent = timed.stage_times()
    assert all(us >= 0.0 for us in spent.values())
    assert 0.0 < sum(spent.values()) < 1e6 * wall / 200
    assert timed.stage_times() == {}  # nothing ran since


def test_laps_are_sorted_by_stage_and_nested_ones_are_taken_off() -> None:
    inner = Laps([in_python("b", lambda: time.sleep(0.004))])
    nested = Program(inner.stages)
    nested.compile()
    outer = Laps([in_python("a", lambda: time.sleep(0.002)), in_python("whole", lambda: nested.run(2))])
    program = Program(outer.stages)
    program.compile()
    program.run(3)
    spent = times(outer, "whole", [inner])
    assert list(spent) == ["a", "whole", "whole: b"]
    assert spent["a"] >= 2000.0 and spent["whole: b"] >= 8000.0 and spent["whole"] < spent["whole: b"]
    assert 0.0 < reading() < 1e5


def test_costs_name_stages_and_kernels(scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("drone_engine.explain.costs.BATCHES", 3)
    costs = measure(scene(DRONE, "effects: {gravity: {}, linear_drag: {}}"))
    names = [cost.stage for cost in costs.stages]
    assert names.index("motion") < names.index("motion: gravity") < names.index("motion: linear_drag")
    assert {cost.stage: cost.kernel for cost in costs.stages}["motion: gravity"] == "effects.gravity.pull"
    assert costs.real_time_factor == pytest.approx(1e6 / 30 / costs.step_us)
    assert {"pull"} == set(costs.kernels["effects.gravity"])
    assert "matrix" in costs.kernels["math.quaternion"]  # called by others
    assert "effects.drag" not in costs.kernels


def test_kernels_are_found_through_those_that_call_them(world: Make) -> None:
    there = compiled(world(CRATE, "effects: {gravity: {}, water: {}}"))
    assert {"submerged", "_cut_off", "_cut"} <= set(there["effects.submerged"])


def test_it_prints_for_people_and_for_programs(
        scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("drone_engine.explain.costs.BATCHES", 3)
    tiny = scene(CRATE, "effects: {gravity: {}}")
    console = Console(record=True, width=120, file=io.StringIO())
    explain(tiny, console)
    text = console.export_text()
    for words in ("gravity", "not in the scene", "effects.gravity.pull", "times real time", "kernels compiled"):
        assert words in text
    assert main([str(tiny.path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {"name": "drag", "group": "effects", "on": False, "why": "not in the scene"} in found["features"]
    assert found["step_us"] > 0.0 and np.isfinite(found["real_time_factor"])


def test_an_unknown_scene_is_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.argv", ["drone_engine", "explain", "atlantis"])
    assert command.main() == 1
    assert re.fullmatch(r"drone_engine explain: no scene 'atlantis'; there are .*\n", capsys.readouterr().err)
