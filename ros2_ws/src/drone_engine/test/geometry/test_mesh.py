"""Models as arrays: what is read, and what is said about models that are not right."""

import logging
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from drone_engine.geometry import mesh

OBJ = """mtllib box.mtl
v 0 0 0
v 2 0 0
v 2 1 0
v 0 1 -3
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
usemtl wood
f 1/1/1 2/2/1 3/3/1
usemtl screen
f 1/1/1 3/3/1 4/4/1
"""
MTL = """newmtl wood
Kd 0.5 0.4 0.3
Ks 0.1 0.2 0.3
Ns 64
map_Kd wood.png
norm bumps.png
newmtl screen
Ke 0.2 0.4 0.9
"""


def write(folder: Path, obj: str = OBJ, mtl: str | None = MTL) -> Path:
    if mtl is not None:
        (folder / "box.mtl").write_text(mtl)
    for name in ("wood.png", "bumps.png"):
        Image.new("RGB", (2, 2)).save(folder / name)
    (folder / "box.obj").write_text(obj)
    return folder / "box.obj"


def test_every_material_is_a_part_with_what_its_mtl_says(tmp_path: Path) -> None:
    model = mesh.load(write(tmp_path))
    parts = {part.material.name: part for part in model.parts}
    assert parts["wood"].material == mesh.Material(
        "wood", (0.5, 0.4, 0.3), (0.1, 0.2, 0.3), 64.0, (0, 0, 0), tmp_path / "wood.png", tmp_path / "bumps.png"
    )
    assert parts["screen"].material.emission == (0.2, 0.4, 0.9)
    for part in model.parts:
        assert part.vertices.shape == (3, 3) and part.vertices.dtype == np.float32
        assert part.uv.shape == (3, 2)
        assert part.faces.shape == (1, 3) and part.faces.dtype == np.int32
        np.testing.assert_allclose(part.normals, [[0, 0, 1]] * 3)
    corner = parts["screen"]
    np.testing.assert_allclose(corner.uv[np.flatnonzero(corner.vertices[:, 2] == -3)], [[0, 1]])


def test_bounds_are_those_of_the_vertices(tmp_path: Path) -> None:
    low, high = mesh.bounds(write(tmp_path))
    np.testing.assert_array_equal(low, [0, 0, -3])
    np.testing.assert_array_equal(high, [2, 1, 0])
    assert low.dtype == np.float64


def test_a_file_that_has_changed_is_read_anew(tmp_path: Path) -> None:
    path = write(tmp_path)
    mesh.bounds(path)
    path.write_text(path.read_text().replace("-3", "-5"))
    os.utime(path, ns=(1, 1))
    assert mesh.bounds(path)[0][2] == -5


def test_numbers_of_vertices_may_count_backwards(tmp_path: Path) -> None:
    path = tmp_path / "two.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf 1 3 -1\n")
    np.testing.assert_array_equal(mesh.read_faces(path), [[0, 1, 2], [0, 2, 3]])


def test_a_model_without_normals_gets_them_from_its_faces(tmp_path: Path) -> None:
    (part,) = mesh.load(write(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).parts
    np.testing.assert_allclose(part.normals, [[0, 0, 1]] * 3, atol=1e-6)
    assert part.material == mesh.Material()


@pytest.mark.parametrize(
    ("obj", "said"),
    [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "has no faces"),
        ("", "has no"),
        ("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 2 is not finite"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "not readable as OBJ"),
    ],
)
def test_errors_name_the_file_and_what_is_wrong_in_one_line(tmp_path: Path, obj: str, said: str) -> None:
    with pytest.raises(mesh.MeshError) as caught:
        mesh.load(write(tmp_path, obj))
    assert "box.obj: " in str(caught.value) and said in str(caught.value) and "\n" not in str(caught.value)


def test_bounds_of_what_is_no_model_are_errors(tmp_path: Path) -> None:
    with pytest.raises(mesh.MeshError, match="vertex 1 is not finite"):
        mesh.bounds(write(tmp_path, "v inf 0 0\n"))
    with pytest.raises(mesh.MeshError, match="three numbers"):
        path = tmp_path / "words.obj"
        path.write_text("v a b c\n")
        mesh.bounds(path)
    with pytest.raises(mesh.MeshError, match="No such file"):
        mesh.bounds(tmp_path / "nowhere.obj")


def test_a_missing_library_or_texture_is_a_warning(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = write(tmp_path, mtl=None)
    with caplog.at_level(logging.WARNING):
        assert mesh.load(path).parts
    assert "box.mtl" in caplog.text
    caplog.clear()
    path = write(tmp_path, mtl=MTL.replace("wood.png", "gone.png"))
    with caplog.at_level(logging.WARNING):
        assert all(part.material.colour_map is None for part in mesh.load(path).parts)
    assert "box.mtl: line 5: no texture 'gone.png'; drawn without" in caplog.text


@pytest.mark.parametrize("damage", ["words", "cut off", "folder"])
def test_an_unreadable_texture_is_a_warning_too(tmp_path: Path, caplog: pytest.LogCaptureFixture, damage: str) -> None:
    path = write(tmp_path)
    texture = tmp_path / "wood.png"
    Image.new("RGB", (64, 64)).save(texture)
    assert all(part.material.colour_map for part in mesh.load(path).parts if part.material.name == "wood")
    data = texture.read_bytes()
    texture.unlink()
    if damage == "folder":
        texture.mkdir()
    else:
        texture.write_bytes(b"no picture" if damage == "words" else data[:-40])
    with caplog.at_level(logging.WARNING):
        (wood,) = (part.material for part in mesh.load(path).parts if part.material.name == "wood")
    assert wood.colour_map is None and wood.normal_map == tmp_path / "bumps.png"
    assert "box.mtl: line 5: " in caplog.text and "'wood.png'" in caplog.text and caplog.text.count("\n") == 1
