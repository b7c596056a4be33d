"""Fixtures of the tests: small scenes from text, with models made of one box each."""

from collections.abc import Callable
from pathlib import Path

import pytest

from drone_engine import Scene, load
from drone_engine.world import World
from reference.shapes import write_box

BOXES = {  # name: size in m, height of the center above the model's origin
    "crate": ((0.6, 0.6, 0.6), 0.3),
    "wall": ((1.0, 6.0, 4.0), 2.0),
    "floor": ((40.0, 40.0, 0.02), 0.0),
    "drone": ((0.5, 0.5, 0.16), 0.0),
    "rotor": ((0.2, 0.02, 0.01), 0.0),
}


@pytest.fixture(scope="session")
def _folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("assets")
    (folder / "models").mkdir()
    (folder / "scenes").mkdir()
    for name, (size, center_z) in BOXES.items():
        write_box(folder / "models" / f"{name}.obj", size, center_z)
    return folder


@pytest.fixture
def scene(_folder: Path) -> Callable[..., Scene]:
    """Loads a scene from the YAML lines of its objects and the rest of its text."""

    def make(objects: str, rest: str = "effects: {gravity: {}}") -> Scene:
        path = _folder / "scenes" / "tiny.yaml"
        path.write_text(f"version: 1\n{rest}\nobjects:\n" + "".join(f"  {line}\n" for line in objects.splitlines()))
        return load(path)

    return make


@pytest.fixture
def world(scene: Callable[..., Scene]) -> Callable[..., World]:
    """Makes a world of such a scene."""

    def make(objects: str, rest: str = "effects: {gravity: {}}") -> World:
        return World(scene(objects, rest))

    return make
