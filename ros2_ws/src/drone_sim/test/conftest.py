"""Tiny scenes for the tests, with models made of one box each."""

from collections.abc import Callable
from pathlib import Path

import pytest

from drone_sim.scene import Scene, load
from drone_sim.world import World

BOXES = {  # name: size in m, height of the middle over the model's origin
    "crate": ((0.6, 0.6, 0.6), 0.3),
    "wall": ((1.0, 6.0, 4.0), 2.0),
    "floor": ((40.0, 40.0, 0.02), 0.0),
    "drone": ((0.5, 0.5, 0.16), 0.0),
    "rotor": ((0.2, 0.02, 0.01), 0.0),
}


def write_box(path: Path, size: tuple[float, float, float], middle: float) -> None:
    """An OBJ file of twelve triangles."""
    x, y, z = (side / 2 for side in size)
    corners = [(sx * x, sy * y, sz * z + middle) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    quads = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {a!r} {b!r} {c!r}" for a, b, c in corners]
    lines += [f"f {a} {b} {c}\nf {a} {c} {d}" for a, b, c, d in quads]
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture(scope="session")
def _folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("assets")
    (folder / "models").mkdir()
    (folder / "scenes").mkdir()
    for name, (size, middle) in BOXES.items():
        write_box(folder / "models" / f"{name}.obj", size, middle)
    return folder


@pytest.fixture
def scene(_folder: Path) -> Callable[..., Scene]:
    """Loads a scene from the text of its objects, and of whatever else it says."""

    def make(objects: str, rest: str = "effects: {gravity: {}}") -> Scene:
        path = _folder / "scenes" / "tiny.yaml"
        path.write_text(f"version: 1\n{rest}\nobjects:\n" + "".join(f"  {line}\n" for line in objects.splitlines()))
        return load(path)

    return make


@pytest.fixture
def world(scene: Callable[..., Scene]) -> Callable[..., World]:
    """The same, running."""

    def make(objects: str, rest: str = "effects: {gravity: {}}") -> World:
        return World(scene(objects, rest))

    return make
