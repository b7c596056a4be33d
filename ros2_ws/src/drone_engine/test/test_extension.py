"""Extensions from a user's own package: effects, flight models, controllers and behaviors that a scene names."""

import math
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from drone_engine.behavior import BehaviorError
from drone_engine.fleet import Fleet
from drone_engine.kernel_cache import dependencies
from drone_engine.scene.errors import SceneError
from drone_engine.scene.loading import make_scene
from drone_engine.scene.schema import Scene
from drone_engine.world import World

EXAMPLES = Path(__file__).parents[4] / "examples"
G = 9.80665


@pytest.fixture(autouse=True)
def _imported_afresh() -> Iterator[None]:
    """Forgets the modules that a test imports from a scene's folder."""
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if name.partition(".")[0] in ("my_drone", "mine"):
            del sys.modules[name]


@pytest.fixture
def make(scene: Callable[..., Scene], tmp_path: Path) -> Callable[..., Scene]:
    """Makes a scene of objects, in a folder with the example package and, if a text is given, a module `mine`."""
    models = scene("crate: {model: crate, mass: 1}").path.parents[1] / "models"

    def made(objects: dict[str, object], text: str = "", **rest: object) -> Scene:
        if text:
            (tmp_path / "mine.py").write_text(text)
        for name, target in (("my_drone", EXAMPLES / "my_drone"), ("models", models)):
            if not (tmp_path / name).exists():
                (tmp_path / name).symlink_to(target)
        return make_scene({"effects": {}, "objects": objects, **rest}, name="mine_scene", folder=tmp_path)

    return made


Make = Callable[..., Scene]
CRATE = {"model": "crate", "mass": 4.0, "pose": [0.5, 0, -0.3]}
DRONE = {"model": "drone", "mass": 1.4, "pose": [0, 0, 2]}


def test_an_effect_acts_in_a_world_and_in_a_fleet(make: Make) -> None:
    swing = World(make({"crate": CRATE}, effects={"my_drone.spring": {"stiffness": 9.0}}))
    swing.run(90)
    assert swing.pose("crate")[0] == pytest.approx(0.5 * math.cos(math.sqrt(9 / 4) * 3.0), abs=1e-4)
    scene = make({"drone": {**DRONE, "flight": {"model": "quadrotor"}}},
                 effects={"gravity": {}, "my_drone.spring": {"stiffness": 0.1}})
    fleet, alone = Fleet(scene, 2), World(scene)
    assert "my_drone.spring" in fleet.why_not
    fleet.run(30, (1.0, 0.0, 0.0, 0.0))
    alone.command("drone", (1.0, 0.0, 0.0, 0.0))
    alone.run(30)
    np.testing.assert_array_equal(fleet.state.position_w[0], alone.state.position_w[0])


def test_a_scene_without_it_is_bit_for_bit_the_same(make: Make) -> None:
    with_it = World(make({"crate": CRATE}, effects={"gravity": {}, "my_drone.spring": {"stiffness": 0.0}}))
    without = World(make({"crate": CRATE}, effects={"gravity": {}}))
    for world in (with_it, without):
        world.run(40)
    assert with_it.state.hash() == without.state.hash()


def test_a_flight_model_carries_its_drone(make: Make) -> None:
    flight = {"model": "my_drone.balloon", "parameters": {"response": 0.5}}
    world = World(make({"drone": {**DRONE, "flight": flight}}, effects={"gravity": {}}))
    world.command("drone", (1.0, 0.0, 0.0, 0.0))
    world.run(14)  # within the time that a command is valid
    assert world.state.velocity_w[0, 0] == pytest.approx(1.0 - math.exp(-14 / 30 / 0.5), abs=2e-3)
    assert world.pose("drone")[2] == pytest.approx(2.0, abs=1e-6)


def test_a_controller_commands_its_drone(make: Make) -> None:
    drone = {**DRONE, "flight": {"controller": {"my_drone.follow": {"target": "crate", "distance": 2.0}}}}
    world = World(make({"drone": drone, "crate": {"model": "crate", "static": True, "pose": [6, 0, 0.7]}},
                       effects={"gravity": {}}))
    world.run(300)
    assert world.pose("drone")[0] == pytest.approx(4.0, abs=0.1)


def test_a_behavior_moves_its_object_and_keeps_numbers_in_the_state(make: Make) -> None:
    objects = {
        "drone": {**DRONE, "pose": [2, 0, 1], "flight": {}, "behavior": {"my_drone.laps": {}}},
        "door": {**CRATE, "mass": 40.0, "pose": [2, 0, 4], "behavior": {"my_drone.door": {"opens_for": "drone"}}},
    }
    world = World(make(objects, effects={"gravity": {}}))
    for _ in range(90):
        world.step({"drone": (0.5, 0.0, 0.0, 0.25)})
    assert world.pose("door")[2] == pytest.approx(6.0, abs=0.05)
    assert world.state.memory["drone.laps"][0] > 0.01
    first = world.state.hash()
    world.reset()
    assert world.state.memory["drone.laps"][0] == 0.0
    for _ in range(90):
        world.step({"drone": (0.5, 0.0, 0.0, 0.25)})
    assert world.state.hash() == first


PUSHER = '''
from drone_engine.scene.fields import Strict


class Parameters(Strict):
    force: float = 1.0


class Behavior:
    def __init__(self, parameters, thing):
        self.p, self.thing = parameters, thing

    def step(self):
        {body}
'''


def test_a_push_is_a_force_for_the_whole_step(make: Make) -> None:
    text = PUSHER.format(body="self.thing.push(force=[self.p.force, 0, 0])")
    world = World(make({"crate": {**CRATE, "behavior": {"mine": {"force": 8.0}}}}, text))
    world.run(30)
    assert world.state.velocity_w[0, 0] == pytest.approx(8.0 / 4.0 * 1.0)


@pytest.mark.parametrize(("body", "message"), [
    ("1 / 0", r"mine_scene: objects\.crate\.behavior\.mine: ZeroDivisionError: division by zero"),
    ("self.thing.push(force=[float('nan'), 0, 0])", r"ValueError: force: expected three finite numbers"),
    ("self.thing.move([1, 2])", r"ValueError: velocity: expected three finite numbers"),
    ("self.thing.pose_of('moon')", r"ValueError: no object is called 'moon'; there are crate"),
    ("self.thing.command([1, 0, 0, 0])", r"ValueError: no drone is called 'crate'"),
])
def test_an_error_of_a_behavior_names_scene_and_key_and_changes_nothing(make: Make, body: str, message: str) -> None:
    world = World(make({"crate": {**CRATE, "behavior": {"mine": {}}}}, PUSHER.format(body=body)))
    before = world.state.hash()
    with pytest.raises(BehaviorError, match=message):
        world.run(1)
    assert world.state.hash() == before


@pytest.mark.parametrize(("change", "message"), [
    ({"effects": {"nowhere.spring": {}}}, r"effects\.nowhere\.spring: no module 'nowhere'"),
    ({"effects": {"my_drone.nothing": {}}}, r"effects\.my_drone\.nothing: no module 'my_drone\.nothing'"),
    ({"effects": {"my_drone.spring": {"stiffness": "soft"}}}, r"effects\.my_drone\.spring\.stiffness: Input should be"),
    ({"effects": {"my_drone.spring": {"stiffnes": 1.0}}}, r"unknown key; allowed are stiffness"),
    ({"effects": {"my_drone.laps": {}}}, r"effects\.my_drone\.laps: 'my_drone\.laps' has no 'build'"),
    ({"effects": {"mine": {}}}, r"effects\.mine: unknown effect; there are wind"),
])
def test_a_wrong_effect_is_an_error_in_one_line(make: Make, change: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError, match=message) as error:
        World(make({"crate": CRATE}, **change))
    assert "\n" not in str(error.value)
    assert str(error.value).startswith("mine_scene: ")


@pytest.mark.parametrize(("thing", "message"), [
    ({"flight": {"model": "my_drone.helicopter"}}, r"objects\.drone\.flight\.model: 'my_drone\.helicopter': no module"),
    ({"flight": {"model": "rocket"}}, r"flight\.model: 'rocket': unknown flight model; there are direct, quadrotor"),
    ({"flight": {"model": "direct", "parameters": {"response": 1.0}}}, "'parameters' are of a flight model of"),
    ({"flight": {"model": "my_drone.balloon", "parameters": {"response": -1.0}}},
     r"objects\.drone\.flight\.parameters\.response: Input should be"),
    ({"flight": {"controller": {"my_drone.follow": {}}}}, r"controller\.my_drone\.follow\.target: Field required"),
    ({"behavior": {"my_drone.door": {"opens_for": "drone", "speed": 0.0}}}, r"behavior\.my_drone\.door\.speed: Input"),
])
def test_a_wrong_part_of_an_object_is_an_error_in_one_line(make: Make, thing: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError, match=message) as error:
        World(make({"drone": {**DRONE, **thing}}))
    assert "\n" not in str(error.value)


def test_a_module_that_fails_while_it_is_imported_is_an_error_in_one_line(make: Make) -> None:
    with pytest.raises(SceneError, match=r"cannot be imported: RuntimeError: broken"):
        World(make({"crate": {**CRATE, "behavior": {"mine": {}}}}, "raise RuntimeError('broken\\nin two lines')"))


def test_an_edit_in_a_module_of_the_user_compiles_its_kernels_again(tmp_path: Path,
                                                                     monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "__init__.py").write_text("")
    (tmp_path / "mine" / "constants.py").write_text("FACTOR = 2.0\n")
    (tmp_path / "mine" / "effect.py").write_text(
        "from drone_engine.kernel import kernel\nfrom mine.constants import FACTOR\n\n"
        "@kernel\ndef scale(x):\n    return FACTOR * x\n")
    monkeypatch.syspath_prepend(tmp_path)
    import mine.effect  # type: ignore[import-not-found]

    assert mine.effect.scale(3.0) == 6.0
    files = {path.name for path in dependencies(tmp_path / "mine" / "effect.py")}
    assert {"effect.py", "constants.py", "kernel.py"} <= files
