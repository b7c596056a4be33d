"""Scene files: what loads, and the one line that says why another does not."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image

from drone_engine import Scene, SceneError, effects, load, parse
from drone_engine.assets import asset_path

GOOD = """version: 1
effects: {gravity: {}}
objects:
  drone: {model: drone, pose: [0, 0, 1], mass: 1.4, flight: {}}
  rotor: {model: rotor, parent: drone, rotor: {direction: 1}}
  wall: {model: wall, static: true, poses: [[1, 2, 0], [3, 4, 0, 0, 0, 1.5]]}
cameras:
  chase: {parent: drone, pose: [-3, 0, 1], level: true}
"""

LONG = "a" * 101
BROKEN = [
    ("mass: 1.4", "mass: -1.4", "objects.drone.mass: Input should be greater than or equal to 0.000001, got '-1.4'"),
    ("mass: 1.4", "mass: 1.0e-9", "objects.drone.mass: Input should be greater than or equal to 0.000001, got '1e-09'"),
    ("mass: 1.4", "mass: 1.0e+12", "objects.drone.mass: Input should be less than or equal to 1"),
    ("mass: 1.4", "mass: .nan", "objects.drone.mass: Input should be a finite number, got 'nan'"),
    ("mass: 1.4", "mass: heavy", "objects.drone.mass: Input should be a valid number, got 'heavy'"),
    ("mass: 1.4", "mass: '1.4'", "objects.drone.mass: Input should be a valid number, got '1.4'"),
    ("mass: 1.4", "mas: 1.4", "objects.drone.mas: unknown key; allowed are behavior, collision, flight"),
    ("mass: 1.4, ", "", "objects.drone: expected either 'mass' (it moves) or 'static: true' (it does not)"),
    ("flight: {}", "flight: {thrust: 1}", "objects.drone.flight.thrust: unknown key; allowed are cmd_vel, controller"),
    ("flight: {}", "flight: {cmd_vel: fly me}", "objects.drone.flight.cmd_vel: String should match pattern"),
    ("flight: {}", "flight: {cmd_vel: a//b}", "objects.drone.flight.cmd_vel: String should match pattern"),
    ("flight: {}", "flight: {cmd_vel: a/0}", "objects.drone.flight.cmd_vel: String should match pattern"),
    ("flight: {}", "flight: {cmd_vel: ''}", "objects.drone.flight.cmd_vel: String should match pattern"),
    ("flight: {}}", "collision: {level: floor}}", "objects.drone.collision.level: a 'floor' is static"),
    ("version: 1", "version: 1\ncollision: {level: floor}", "objects.drone.collision.level: a 'floor' is static"),
    ("wall:", f"{LONG}:", f"objects.{LONG}_0.[key]: String should have at most 100 characters"),
    ("chase:", f"{LONG}:", f"cameras.{LONG}.[key]: String should have at most 100 characters"),
    ("cameras:", f"lights: {{{LONG}: {{}}}}\ncameras:", f"lights.{LONG}.[key]: String should have at most 100 char"),
    ("drone: {m", "world: {m", "objects.world: 'world' is the root frame"),
    ("chase:", "world:", "cameras.world: 'world' is the root frame"),
    ("cameras:", "lights: {world: {}}\ncameras:", "lights.world: 'world' is the root frame"),
    ("chase:", "drone:", "cameras.drone: another frame is called 'drone'"),
    ("rotor: {m", "chase_optical: {m", "cameras.chase: another frame is called 'chase_optical'"),
    ("static: true, p", "static: true, pose: [0, 0, 0], p", "objects.wall: expected either"),
    ("static: true, poses: [[1, 2, 0], [3, 4, 0, 0, 0, 1.5]]", "static: true, poses: []", "objects.wall.poses: ex"),
    ("static: true, poses: [[1, 2, 0], [3, 4, 0, 0, 0, 1.5]]", "static: true, poses: 3", "objects.wall.poses: ex"),
    ("rotor: {m", "wall_0: {m", "objects.wall_0: defined twice, once by"),
    ("cameras:", "  wall_1: {model: wall, static: true}\ncameras:", "objects.wall_1: defined twice"),
    ("version: 1", "version: 1\ndescription: 2024-13-45", "line 2: not a valid timestamp: '2024-13-45'"),
    ("version: 1", "version: 1\nseed: " + "9" * 5000, "line 2: not a valid int: '999"),
    ("version: 1", "version: 1\nseed: 0x" + "f" * 5000, "Exceeds the limit"),
    ("version: 1", "version: 1\nseed: !!int ''", "line 2: not a valid int: ''"),
    ("version: 1", "version: 1\nseed: !!bool maybe", "line 2: not a valid bool: 'maybe'"),
    ("version: 1", "version: 1\nseed: 1" + ":0" * 300 + ".5", "line 2: not a valid float: '1:0"),
    ("version: 1", "version: 1\n2024-12-25: 1", "keys must be str"),
    ("version: 1", "version: 1\ndescription: \x01", "unacceptable character #x0001"),
    ("version: 1", "version: 1\ndescription: " + "[" * 400 + "]" * 400, "line 2: nested in more than 32 levels"),
    ("version: 1", "version: 1\ndescription: " + "[" * 200_000 + "]" * 200_000, "line 2: nested in more than 32"),
    ("version: 1", "version: 1\nrender: {sky: {parent: plane}}", "render.sky.parent: no object is called 'plane'"),
    ("version: 1", "version: 1\nrender: {sky: {clouds: fog}}", "render.sky.clouds: no texture 'fog'; there are "),
    ("version: 1", "version: 1\nrender: {sky: {stars: fog.jpg}}", "render.sky.stars: no texture 'fog'; there are "),
    ("version: 1", "version: 1\nrender: {sky: {colours: ../a.png}}", "render.sky.colours: '../a.png' leads out"),
    ("pose: [-3, 0, 1], level: true", f"poses: [{'[0, 0, 1], ' * 65}]", "cameras: expected at most 64, got 65"),
    ("chase: {parent: drone, pose: [-3, 0, 1], level: true}", "chase:", "cameras.chase: Input should be an object, g"),
    ("cameras:\n", "lights: {\n", "line 8: "),
    ("parent: drone, rotor", "parent: plane, rotor", "objects.rotor.parent: no object is called 'plane'"),
    ("parent: drone, rotor", "parent: wall_0, rotor", "objects.rotor.rotor: 'wall_0' does not fly"),
    ("parent: drone, rotor", "parent: rotor, rotor", "objects.rotor.parent: is its own ancestor"),
    ("[1, 2, 0]", "[1, 2]", "objects.wall_0.pose.2: expected more numbers"),
    ("version: 1", "version: 2", "version: Input should be 1, got '2'"),
    ("version: 1\n", "", "version: Field required"),
    ("version: 1", "version: 1\nname: mine", "name: must not be set in a scene"),
    ("cameras:", "objects:", "line 7: key 'objects' appears twice"),
    ("model: drone", "model: submarine", "objects.drone.model: no model 'submarine'; there are"),
    ("model: drone", "model: ../../secret", "objects.drone.model: '../../secret.obj' leads out of the models"),
    ("model: drone", "model: /etc/passwd", "objects.drone.model: '/etc/passwd.obj' leads out of the models"),
    ("cameras:\n", "cameras: &a {}\nlights: *a\nrender:\n", "line 8: YAML aliases are not allowed ('*a')"),
    ("objects:", "objects: [", "line "),
]


@pytest.fixture
def path(scene: Callable[..., Scene]) -> Path:
    return scene("drone: {model: drone, mass: 1}").path


def test_a_good_scene_loads(path: Path) -> None:
    scene = parse(GOOD, path)
    assert list(scene.objects) == ["drone", "rotor", "wall_0", "wall_1"]
    assert scene.objects["wall_1"].pose == (3, 4, 0, 0, 0, 1.5)
    assert scene.objects["drone"].pose == (0, 0, 1, 0, 0, 0)
    assert (scene.rates.physics, scene.rates.draw) == (30.0, 60.0)
    assert scene.render.features() == []


@pytest.mark.parametrize(("old", "new", "message"), BROKEN, ids=[message[:50] for _, _, message in BROKEN])
def test_a_broken_scene_is_refused_in_one_line(path: Path, old: str, new: str, message: str) -> None:
    assert old in GOOD
    with pytest.raises(SceneError) as error:
        parse(GOOD.replace(old, new, 1), path)
    assert "\n" not in str(error.value)
    assert str(error.value).startswith(f"{path}: {message}")


@pytest.mark.parametrize("topic", ["cmd_vel", "/cmd_vel", "ai_drone/cmd_vel", "/_A/b9"])
def test_a_drone_listens_to_any_ros_topic(path: Path, topic: str) -> None:
    flight = parse(GOOD.replace("flight: {}", f"flight: {{cmd_vel: {topic}}}"), path).objects["drone"].flight
    assert flight and flight.cmd_vel == topic


def test_a_light_may_have_the_name_of_its_object(path: Path) -> None:
    assert "drone" in parse(GOOD.replace("cameras:", "lights: {drone: {parent: drone}}\ncameras:"), path).lights


def test_an_unknown_effect_names_those_that_exist(path: Path) -> None:
    scene = parse(GOOD.replace("gravity: {}", "magnetism: {}"), path)
    with pytest.raises(SceneError, match=r"effects\.magnetism: unknown effect; there are .*gravity, drag"):
        effects.parameters(scene)


def test_an_effect_refuses_what_it_does_not_know(path: Path) -> None:
    scene = parse(GOOD.replace("gravity: {}", "gravity: {accelleration: 9.8}"), path)
    with pytest.raises(SceneError, match=r"effects\.gravity\.accelleration: unknown key; allowed are acceleration"):
        effects.parameters(scene)


def test_a_huge_file_is_refused_unread(path: Path) -> None:
    with pytest.raises(SceneError, match="expected at most 1048576 bytes"):
        parse(GOOD + "# " + "x" * (1 << 20), path)


def test_a_scene_that_is_not_there_names_those_that_are() -> None:
    with pytest.raises(SceneError, match="no scene 'atlantis'; there are crates, hangar, island, lagoon, ring"):
        load("atlantis")


def test_the_hash_follows_the_file_and_its_models(path: Path) -> None:
    first = parse(GOOD, path).hash
    assert parse(GOOD, path).hash == first
    assert parse(GOOD.replace("1.4", "1.5"), path).hash != first


def test_a_texture_of_the_sky_may_lie_beside_the_scene(path: Path) -> None:
    sky = "version: 1\nrender: {sky: {clouds: fog, stars: stars.png}}"
    textures = path.parent.parent / "textures"
    textures.mkdir()
    try:
        (textures / "fog.png").write_text("no image")
        with pytest.raises(SceneError, match=r"render\.sky\.clouds: .*textures/fog\.png is not readable: not an image"):
            parse(GOOD.replace("version: 1", sky), path)
        Image.new("RGBA", (4, 4)).save(textures / "fog.png")
        found = parse(GOOD.replace("version: 1", sky), path).render.sky
    finally:
        shutil.rmtree(textures)
    assert found and found.clouds == textures / "fog.png" and found.colours is None
    assert found.stars == asset_path("textures", "stars.png")


def test_cameras_can_be_added(path: Path) -> None:
    base = parse(GOOD.replace("chase:", "top: {}\n  chase:"), path)
    more = base.with_cameras("side: {parent: drone, pose: [0, 2, 0], size: [64, 48]}\ntop: {pose: [0, 0, 9]}")
    assert set(more.cameras) == {*base.cameras, "side", "top"} and more.hash == base.hash
    assert more.cameras["side"].pose == (0, 2, 0, 0, 0, 0) and more.objects == base.objects
    for text, problem in [
        ("side: {parent: plane}", "cameras.side.parent: no object is called 'plane'"),
        ("side: {fov: wide}", "cameras.side.fov: Input should be a valid number"),
        ("drone: {}", "cameras.drone: another frame is called 'drone'"),
        ("- side", "cameras: expected one or more by name, such as 'side: {pose: [0, 0, 2]}', got \"['side']\""),
        ("side", "cameras: expected one or more by name, such as 'side: {pose: [0, 0, 2]}', got 'side'"),
        ("", "cameras: expected one or more by name, such as 'side: {pose: [0, 0, 2]}', got nothing"),
        ("{}", "cameras: expected one or more by name, such as 'side: {pose: [0, 0, 2]}', got nothing"),
        ("side:", "cameras.side: Input should be an object, got nothing"),
        ("side: {colour: 1}", "cameras.side.colour: unknown key; allowed are far, fov, level"),
        ("side: {", "line 1: did not find expected"),
        ("side: {}\ntop: {}\nside: {}", "line 3: key 'side' appears twice"),
        ("side: {poses: [" + "[0, 0, 1], " * 64 + "]}", "cameras: expected at most 64, got 66"),
    ]:
        with pytest.raises(SceneError) as caught:
            base.with_cameras(text)
        assert "\n" not in str(caught.value)
        assert str(caught.value).startswith(problem)
