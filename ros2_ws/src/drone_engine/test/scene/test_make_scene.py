"""Scenes made from data in Python: the same validation, texts and results as for files."""

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from PIL import Image

from drone_engine import Fleet, Scene, SceneError, World, effects, make_scene, parse
from drone_engine.scene.picture import Camera
from reference.shapes import write_box

Load = Callable[..., Scene]
CONTENT: dict[str, Any] = {
    "version": 1,
    "rates": {"physics": 60},
    "effects": {"gravity": {"acceleration": 3.7}},
    "objects": {
        "drone": {"model": "drone", "pose": (0, 0, 1), "mass": 1.4, "flight": {}},
        "rotor": {"model": "rotor", "parent": "drone", "pose": [0, 0, 0.1], "rotor": {"direction": 1}},
        "wall": {"model": "wall", "static": True, "poses": [(1, 2, 0), (3, 4, 0, 0, 0, 1.5)]},
    },
    "cameras": {"chase": {"parent": "drone", "pose": [-3, 0, 1], "level": True}},
}


@pytest.fixture
def folder(scene: Load) -> Path:
    """A folder with models of boxes."""
    return scene("drone: {model: drone, mass: 1}").path.parents[1]


def changed(path: tuple[str, ...], value: Any) -> dict[str, Any]:
    """CONTENT with another value at a key path; None removes the key."""
    content = copy.deepcopy(CONTENT)
    part = content
    for key in path[:-1]:
        part = part.setdefault(key, {})
    if value is None:
        del part[path[-1]]
    else:
        part[path[-1]] = value
    return content


def plain(value: Any) -> Any:
    """Tuples as lists, as YAML has them."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    return [plain(inner) for inner in value] if isinstance(value, list | tuple) else value


def test_it_equals_the_scene_of_a_file_with_the_same_content(folder: Path) -> None:
    made = make_scene(CONTENT, "tiny", folder)
    read = parse(yaml.safe_dump(plain(CONTENT), sort_keys=False), folder / "scenes" / "tiny.yaml")
    for key in Scene.model_fields:
        if key not in ("path", "folder", "hash"):
            assert getattr(made, key) == getattr(read, key), key
    assert list(made.objects) == ["drone", "rotor", "wall_0", "wall_1"]
    assert [made.model_path(name) for name in made.objects] == [read.model_path(name) for name in read.objects]


@pytest.mark.parametrize(("path", "value"), [
    (("objects", "drone", "mass"), -1.4), (("objects", "drone", "mass"), "heavy"),
    (("objects", "drone", "mass"), float("nan")), (("objects", "drone", "mas"), 1.4),
    (("objects", "drone", "mass"), None),
    (("objects", "drone", "flight"), {"thrust": 1}), (("objects", "wall", "pose"), (0, 0, 0)),
    (("objects", "wall", "poses"), []), (("objects", "wall", "poses"), [(1, 2)]),
    (("objects", "wall_0"), {"model": "wall"}),
    (("objects", "world"), {"model": "wall", "static": True}), (("objects", "rotor", "parent"), "plane"),
    (("objects", "drone", "model"), "submarine"), (("objects", "drone", "model"), "../../secret"),
    (("cameras", "drone"), {}), (("cameras", "chase", "fov"), "wide"), (("cameras", "chase"), 3),
    (("render",), {"sky": {"clouds": "fog"}}), (("version",), 2), (("name",), "mine"), (("files",), {}),
    (("objects",), None), (("objects",), [1])])
def test_errors_have_the_texts_that_a_file_would_cause(folder: Path, path: tuple[str, ...], value: Any) -> None:
    content, file = changed(path, value), folder / "scenes" / "tiny.yaml"
    with pytest.raises(SceneError) as of_file:
        parse(yaml.safe_dump(plain(content), sort_keys=False), file)
    with pytest.raises(SceneError) as made:
        make_scene(content, "mine", folder)
    assert str(made.value).startswith("mine: ")
    assert str(made.value).removeprefix("mine: ") == str(of_file.value).removeprefix(f"{file}: ")


@pytest.mark.parametrize(("path", "value", "message"), [
    (("objects", "drone", "mass"), 1j, "mine: objects.drone.mass: expected a mapping, a sequence, a number, a string, "
     "a boolean or None, got complex"),
    (("objects", "drone", "pose"), {0, 1}, "mine: objects.drone.pose: expected a mapping, a sequence, .*got set"),
    (("objects", "drone", "mass"), np.array([1.4, 2]), r"mine: objects.drone.mass: .* number, got '\[1.4, 2.0\]'"),
    (("objects", "drone", "model"), "gone.obj", r"mine: objects.drone.model: .*gone.obj: No such file"),
    (("effects",), {3: {}}, "mine: effects: expected strings as keys, got 3"),
    (("description",), "a" + "\0", None)])
def test_values_that_no_file_can_hold_are_refused_by_key(folder: Path, path: tuple[str, ...], value: Any,
                                                         message: str | None) -> None:
    if message is None:
        assert make_scene(changed(path, value), "mine", folder).description == value
        return
    with pytest.raises(SceneError, match=message) as error:
        make_scene(changed(path, value), "mine", folder)
    assert "\n" not in str(error.value)


def test_data_that_contain_themselves_are_refused(folder: Path) -> None:
    content = copy.deepcopy(CONTENT)
    content["effects"]["gravity"]["self"] = content
    with pytest.raises(SceneError, match="nested in more than 32 levels"):
        make_scene(content, folder=folder)


@pytest.mark.parametrize(("arguments", "message"), [
    (([],), "scene: expected a mapping, got list"), ((CONTENT, "a/b"), "name: expected 1 to 100 characters without"),
    ((CONTENT, "mine", "nowhere"), "mine: folder: no folder 'nowhere'")])
def test_bad_arguments_are_refused(arguments: tuple[Any, ...], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        make_scene(*arguments)


def test_numbers_of_numpy_and_parts_of_the_schema_are_accepted(folder: Path) -> None:
    content = changed(("objects", "drone"), {"model": "drone", "pose": np.array([0.0, 0.0, 1.0]), "flight": {},
                                             "mass": np.float64(1.4)})
    content["seed"] = np.int64(3)
    content["cameras"] = {"chase": Camera(parent="drone", pose=(-3, 0, 1, 0, 0, 0), level=True)}
    made, plainly = make_scene(content, folder=folder), make_scene({**CONTENT, "seed": 3}, folder=folder)
    assert made.objects == plainly.objects and made.cameras == plainly.cameras and made.seed == 3


def test_models_and_textures_may_be_given_by_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "parts").mkdir()
    write_box(tmp_path / "parts" / "arm.obj", (1.0, 1.0, 1.0), 0.0)
    Image.new("RGBA", (4, 4)).save(tmp_path / "parts" / "fog.png")
    content = {"objects": {"near": {"model": "parts/arm.obj", "mass": 1}, "far": {"model": "crate", "mass": 1},
                           "by_path": {"model": tmp_path / "parts" / "arm.obj", "static": True, "poses": [(3, 0, 0)]}},
               "render": {"sky": {"clouds": "parts/fog.png", "stars": "stars"}}}
    made = make_scene(content, folder=tmp_path)
    assert made.model_path("near") == made.model_path("by_path_0") == tmp_path / "parts" / "arm.obj"
    assert made.model_path("far").name == "crate.obj"
    assert made.render.sky and made.render.sky.clouds == tmp_path / "parts" / "fog.png"
    monkeypatch.chdir(tmp_path)
    here = make_scene(content)
    monkeypatch.chdir("/")
    assert here.model_path("near") == tmp_path / "parts" / "arm.obj"
    assert World(here).model.bodies.half[0, 0] == 0.5


def test_the_hash_follows_the_data_and_the_models(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    write_box(tmp_path / "models" / "block.obj", (1.0, 1.0, 1.0), 0.0)
    content = {"objects": {"block": {"model": "block", "mass": 1}}}
    first = make_scene(content, folder=tmp_path).hash
    assert make_scene({"objects": {"block": {"mass": np.int64(1), "model": "block"}}}, folder=tmp_path).hash != ""
    assert make_scene(content, "other", tmp_path).hash == first
    assert make_scene({"objects": {"block": {"model": "block", "mass": 2}}}, folder=tmp_path).hash != first
    write_box(tmp_path / "models" / "block.obj", (1.0, 1.0, 2.0), 0.0)
    assert make_scene(content, folder=tmp_path).hash != first


def test_worlds_and_fleets_take_it_and_so_do_pickle_and_copy(scene: Load, folder: Path) -> None:
    crates = {"model": "crate", "mass": 3, "poses": [(0, 0, 1), (0.1, 0, 2)]}
    made = make_scene({"effects": {"gravity": {}}, "objects": {"crate": crates}}, folder=folder)
    read = scene("crate: {model: crate, mass: 3, poses: [[0, 0, 1], [0.1, 0, 2]]}")
    for each in (pickle.loads(pickle.dumps(made)), copy.deepcopy(made), made.model_copy()):
        assert each == made
        one, other = World(each), World(read)
        one.run(30)
        other.run(30)
        assert one.state.hash() == other.state.hash()
    with pytest.raises(SceneError, match=r"mine: effects\.gravity\.speed: unknown key"):
        effects.parameters(make_scene({**CONTENT, "effects": {"gravity": {"speed": 1}}}, "mine", folder))
    assert Fleet(make_scene(CONTENT, folder=folder), 2).worlds[1].scene.seed == 1


def test_errors_of_a_world_name_the_scene(tmp_path: Path) -> None:
    (tmp_path / "card.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    with pytest.raises(SceneError, match=r"^mine: objects\.card\.model: .*needs a volume"):
        World(make_scene({"objects": {"card": {"model": "card.obj", "mass": 1}}}, "mine", tmp_path))
