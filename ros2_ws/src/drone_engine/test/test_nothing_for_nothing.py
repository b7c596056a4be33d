"""Only what a scene calls for is there: without an effect, a run is that of a program that does not have it."""

import math
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from drone_engine import effects
from drone_engine.kernel import reached
from drone_engine.program.stage import Stage
from drone_engine.world import World

Make = Callable[..., World]
BUSY = """floor: {model: floor, static: true, collision: {level: floor}}
drone: {model: drone, mass: 1.4, pose: [0, 0, 0.6], flight: {}}
rotor: {model: rotor, parent: drone, pose: [0, 0, 0.1], rotor: {direction: 1}}
other: {model: drone, mass: 1.4, pose: [0.3, 0, 2], flight: {model: quadrotor}}
front_left: {model: rotor, parent: other, pose: [0.2, 0.2, 0.1], rotor: {direction: -1}}
front_right: {model: rotor, parent: other, pose: [0.2, -0.2, 0.1], rotor: {direction: 1}}
rear_left: {model: rotor, parent: other, pose: [-0.2, 0.2, 0.1], rotor: {direction: 1}}
rear_right: {model: rotor, parent: other, pose: [-0.2, -0.2, 0.1], rotor: {direction: -1}}
crate: {model: crate, mass: 4, poses: [[1.5, 0, 0], [1.5, 0.1, 0.7]]}"""
NOTHING = {  # how an effect says that it is too weak to do anything
    "wind": "{mean: [0, 0, 0]}", "gusts": "{wind_6m: 0}", "gravity": "{acceleration: 0}", "drag": "{coefficient: 0}",
    "linear_drag": "{rate: [0, 0, 0]}", "water": "{level: -1000}",
}
DOCS = Path(__file__).parents[4] / "docs" / "effects.md"
OTHERS = "every other effect"


def named(*names: str) -> str:
    return f"seed: 5\neffects: {{{', '.join(f'{name}: {{}}' for name in names)}}}"


def flown(world: World, steps: int = 60) -> list[str]:
    seen = []
    for i in range(steps):
        world.step({"drone": (2.0, 0.1, 0.2, 0.2)} if i % 40 < 25 else {})
        seen.append(world.state.hash())
    return seen


def stages(world: World) -> list[Stage]:
    return [*world.substep_program.stages, *world.force_program.stages, *world.program.stages]


def modules(world: World) -> set[str]:
    """Where the kernels of a world's stages come from, and those that they call."""
    return {kernel.py_func.__module__ for stage in stages(world) if stage.kernel for kernel in reached(stage.kernel)}


def position(world: World) -> bytes:
    """Where everything is after a while, bit for bit."""
    world.run(60)
    return world.state.position_w.tobytes()


@pytest.fixture(params=effects.EFFECTS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def without(name: str, monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """Takes the effect out of the program: out of its table, and its module beyond import."""
    def take() -> None:
        module = effects.EFFECTS[name]
        monkeypatch.delitem(effects.EFFECTS, name)
        monkeypatch.setitem(sys.modules, module, None)  # importing it fails

    return take


@pytest.mark.parametrize("rest", ["no other effect", OTHERS])
def test_a_scene_without_it_runs_as_in_a_program_without_it(
        world: Make, name: str, without: Callable[[], None], rest: str) -> None:
    scene = named(*(other for other in effects.EFFECTS if other != name) if rest == OTHERS else ())
    before = world(BUSY, scene)
    seen = flown(before)
    without()
    after = world(BUSY, scene)
    assert flown(after) == seen
    assert [stage.name for stage in stages(after)] == [stage.name for stage in stages(before)]


def test_nothing_of_it_is_built_for_a_scene_without_it(world: Make, name: str) -> None:
    module = effects.EFFECTS[name]
    bare = world(BUSY, named())
    present = world(BUSY, named(*effects.EFFECTS))
    assert module in modules(present)
    for scene in (bare, world(BUSY, named(*(other for other in effects.EFFECTS if other != name)))):
        assert module not in modules(scene)
        assert name not in {stage.name for stage in stages(scene)}
        assert not any(re.match(rf"{name}\b", key) for key in scene.state.memory)
    assert bare.forces.air_velocity.size == 0


def test_it_does_something_where_it_is_named(world: Make, name: str) -> None:
    rest = [other for other in effects.EFFECTS if other != name]
    assert position(world(BUSY, named(*effects.EFFECTS))) != position(world(BUSY, named(*rest)))


@pytest.mark.parametrize("name", NOTHING, indirect=True)
def test_too_weak_to_act_it_equals_its_absence(world: Make, name: str) -> None:
    others = ", ".join(f"{other}: {{}}" for other in ("gravity", "drag") if other != name)
    head = f"seed: 5\ndynamics: {{sleep: false}}\neffects: {{{others}"
    weak, absent = world(BUSY, f"{head}, {name}: {NOTHING[name]}}}"), world(BUSY, f"{head}}}")
    weak.state.memory.pop(name, None)  # what it remembers is all that may differ
    assert flown(weak) == flown(absent)


def test_a_reset_is_a_fresh_start_with_all_of_them(world: Make) -> None:
    again = world(BUSY, named(*effects.EFFECTS))
    first = flown(again)
    again.reset()
    assert flown(again) == first


def test_a_fresh_program_imports_no_effect_that_the_scene_does_not_name(world: Make) -> None:
    path = world(BUSY, named("drag")).scene.path
    text = ("import sys; from drone_engine.scene.loading import load; from drone_engine.world import World\n"
            f"World(load({str(path)!r}))\n"
            "print(*(name for name in sys.modules if name.startswith('drone_engine.effects.')))")
    result = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    own = set(effects.EFFECTS.values())
    assert own & set(result.stdout.split()) == {effects.EFFECTS["drag"]}


def test_the_effect_of_the_documentation_is_its_own_file_and_one_line(
        world: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = re.findall(r"```python\n(.*?)```", DOCS.read_text(), re.DOTALL)[-1]
    (tmp_path / "spring_of_the_documentation.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(effects.EFFECTS, "spring", "spring_of_the_documentation")
    swing = world("crate: {model: crate, mass: 4, pose: [0.5, 0, -0.3]}", "effects: {spring: {stiffness: 9}}")
    swing.run(90)
    assert swing.pose("crate")[0] == pytest.approx(0.5 * math.cos(math.sqrt(9 / 4) * 3.0), abs=1e-4)


def test_every_effect_is_documented_with_its_parameters() -> None:
    sections = dict(re.findall(r"^## `(\w+)`(.*?)(?=^## |\Z)", DOCS.read_text(), re.MULTILINE | re.DOTALL))
    assert list(sections) == list(effects.EFFECTS)
    for name, section in sections.items():
        for parameter in effects.effect(name).Parameters.model_fields:
            assert f"| `{parameter}` |" in section, f"{name}.{parameter}"
        assert f"](effects/{name}.png)" in section and (DOCS.parent / "effects" / f"{name}.png").exists()
