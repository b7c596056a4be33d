"""Small scenes to draw, and a graphics context that must end without an error."""

from collections.abc import Callable, Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest
import trimesh
from PIL import Image

from drone_engine import assets
from drone_engine.scene import loading as scene
from drone_render.gl import context

HEAD = "version: 1\n"


def write_model(folder: Path, name: str, shape: trimesh.Trimesh, material: str) -> None:
    """An OBJ of a shape, with uv from its x and z, and an MTL with the given lines."""
    lines = [f"mtllib {name}.mtl", "usemtl paint"]
    lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in shape.vertices]
    lines += [f"vt {x:.6f} {z:.6f}" for x, _, z in shape.vertices]
    lines += ["f " + " ".join(f"{i}/{i}" for i in face) for face in shape.faces + 1]
    (folder / f"{name}.obj").write_text("\n".join(lines) + "\n")
    (folder / f"{name}.mtl").write_text(f"newmtl paint\n{material}\n")


@pytest.fixture
def make_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], scene.Scene]:
    """Reads a scene from text; its models are ball, lamp (a ball that glows), floor, and crates with all maps: crate,
    whose colors vary too much to be packed with its normals, and gray_crate."""
    models, textures = tmp_path / "models", tmp_path / "textures"
    for folder in (models, textures):
        folder.mkdir()
    write_model(models, "ball", trimesh.creation.icosphere(3, 0.5), "Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 32")
    write_model(models, "lamp", trimesh.creation.icosphere(2, 0.05), "Kd 0 0 0\nKe 1 1 1")
    write_model(models, "floor", trimesh.creation.box((200, 200, 0.02)), "Kd 0.4 0.5 0.3")
    crate = trimesh.creation.box((1, 1, 1))
    crate.unmerge_vertices()  # for edges that look sharp
    maps = "Kd 1 1 1\nKs 0.3 0.3 0.3\nNs 64\nmap_Kd ../textures/noise.png\nnorm ../textures/bumps.png"
    write_model(models, "crate", crate, maps)
    write_model(models, "gray_crate", crate, maps.replace("noise", "gray"))
    grain = np.random.default_rng(1).integers(60, 200, (16, 16, 3), dtype=np.uint8)
    Image.fromarray(grain).save(textures / "noise.png")
    Image.fromarray(np.repeat(grain[..., :1], 3, axis=2)).save(textures / "gray.png")
    bumps = np.dstack([grain[..., :2], np.full((16, 16), 220, np.uint8)])
    Image.fromarray(bumps).save(textures / "bumps.png")
    Image.fromarray(np.dstack([np.full_like(grain, 255), grain[..., 0]])).save(textures / "clouds.png")
    monkeypatch.setattr(assets, "ASSETS", tmp_path)
    return lambda text: scene.parse(HEAD + text, tmp_path / "test.yaml")


@pytest.fixture
def graphics() -> Iterator[moderngl.Context]:
    """A context; an OpenGL error that is still pending when the test ends fails it."""
    made = context.create()
    yield made
    pending = made.error
    made.release()
    assert pending == "GL_NO_ERROR"
