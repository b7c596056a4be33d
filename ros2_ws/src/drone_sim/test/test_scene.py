"""Scene files: what loads, and the one line that says why another does not."""

from collections.abc import Callable

import pytest

from drone_sim import effects
from drone_sim.scene import Scene, SceneError, load, parse

GOOD = """version: 1
effects: {gravity: {}}
objects:
  drone: {model: drone, pose: [0, 0, 1], mass: 1.4, flight: {}}
  rotor: {model: rotor, parent: drone, rotor: {direction: 1}}
  wall: {model: wall, static: true, poses: [[1, 2, 0], [3, 4, 0, 0, 0, 1.5]]}
cameras:
  chase: {parent: drone, pose: [-3, 0, 1], level: true}
"""

BROKEN = [
    ("mass: 1.4", "mass: -1.4", "objects.drone.mass: Input should be greater than 0, got '-1.4'"),
    ("mass: 1.4", "mass: .nan", "objects.drone.mass: Input should be a finite number, got 'nan'"),
    ("mass: 1.4", "mass: heavy", "objects.drone.mass: Input should be a valid number, got 'heavy'"),
    ("mass: 1.4", "mass: '1.4'", "objects.drone.mass: Input should be a valid number, got '1.4'"),
    ("mass: 1.4", "mas: 1.4", "objects.drone.mas: unknown key; allowed are collision, flight, friction"),
    ("mass: 1.4, ", "", "objects.drone: needs either 'mass' (it moves) or 'static: true' (it does not)"),
    ("flight: {}", "flight: {thrust: 1}", "objects.drone.flight.thrust: unknown key; allowed are cmd_vel, max_acc"),
    ("parent: drone, rotor", "parent: plane, rotor", "objects.rotor.parent: no object is called 'plane'"),
    ("parent: drone, rotor", "parent: wall_0, rotor", "objects.rotor.rotor: 'wall_0' does not fly"),
    ("parent: drone, rotor", "parent: rotor, rotor", "objects.rotor.parent: is its own ancestor"),
    ("[1, 2, 0]", "[1, 2]", "objects.wall_0.pose.2: Field required"),
    ("version: 1", "version: 2", "version: Input should be 1, got '2'"),
    ("version: 1\n", "", "version: Field required"),
    ("version: 1", "version: 1\nname: mine", "name: is not for the file to say"),
    ("cameras:", "objects:", "line 3: 'objects' stands here twice"),
    ("model: drone", "model: submarine", "objects.drone.model: no model 'submarine'; there are"),
    ("model: drone", "model: ../../secret", "objects.drone.model: '../../secret.obj' leads out of the models"),
    ("model: drone", "model: /etc/passwd", "objects.drone.model: '/etc/passwd.obj' leads out of the models"),
    ("cameras:\n", "cameras: &a {}\nlights: *a\nrender:\n", "YAML aliases are not allowed ('*a')"),
    ("objects:", "objects: [", "line "),
]


@pytest.fixture
def path(scene: Callable[..., Scene]) -> object:
    return scene("drone: {model: drone, mass: 1}").path


def test_a_good_scene_loads(path: object) -> None:
    scene = parse(GOOD, path)
    assert list(scene.objects) == ["drone", "rotor", "wall_0", "wall_1"]
    assert scene.objects["wall_1"].pose == (3, 4, 0, 0, 0, 1.5)
    assert scene.objects["drone"].pose == (0, 0, 1, 0, 0, 0)
    assert (scene.rates.physics, scene.rates.draw) == (30.0, 60.0)
    assert scene.render.features() == []


@pytest.mark.parametrize(("old", "new", "message"), BROKEN, ids=[message[:50] for _, _, message in BROKEN])
def test_a_broken_scene_is_refused_in_one_line(path: object, old: str, new: str, message: str) -> None:
    assert old in GOOD
    with pytest.raises(SceneError) as error:
        parse(GOOD.replace(old, new, 1), path)
    assert "\n" not in str(error.value)
    assert str(error.value).startswith(f"{path}: {message}")


def test_an_unknown_effect_names_those_that_exist(path: object) -> None:
    scene = parse(GOOD.replace("gravity: {}", "magnetism: {}"), path)
    with pytest.raises(SceneError, match=r"effects\.magnetism: unknown effect; there are gravity, drag"):
        effects.parameters(scene)


def test_an_effect_refuses_what_it_does_not_know(path: object) -> None:
    scene = parse(GOOD.replace("gravity: {}", "gravity: {accelleration: 9.8}"), path)
    with pytest.raises(SceneError, match=r"effects\.gravity\.accelleration: unknown key; allowed are acceleration"):
        effects.parameters(scene)


def test_a_huge_file_is_refused_unread(path: object) -> None:
    with pytest.raises(SceneError, match="larger than 1048576 bytes"):
        parse(GOOD + "# " + "x" * (1 << 20), path)


def test_a_scene_that_is_not_there_names_those_that_are() -> None:
    with pytest.raises(SceneError, match="no scene 'atlantis'; there are hangar, island"):
        load("atlantis")


def test_the_hash_follows_the_file_and_its_models(path: object) -> None:
    first = parse(GOOD, path).hash
    assert parse(GOOD, path).hash == first
    assert parse(GOOD.replace("1.4", "1.5"), path).hash != first
