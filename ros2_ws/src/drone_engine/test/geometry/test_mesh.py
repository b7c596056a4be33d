"""Models as arrays: what is read, and the errors of models that cannot be used."""

import os
from pathlib import Path

import numpy as np
import pytest

from drone_engine.geometry import mesh
from drone_engine.geometry.materials import Material
from reference.models import write_model


def test_every_material_is_a_part_with_what_its_mtl_says(tmp_path: Path) -> None:
    model = mesh.load(write_model(tmp_path))
    parts = {part.material.name: part for part in model.parts}
    assert parts["wood"].material == Material(
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
    low, high = mesh.bounds(write_model(tmp_path))
    np.testing.assert_array_equal(low, [0, 0, -3])
    np.testing.assert_array_equal(high, [2, 1, 0])
    assert low.dtype == np.float64


def test_a_file_that_has_changed_is_read_anew(tmp_path: Path) -> None:
    path = write_model(tmp_path)
    mesh.bounds(path)
    path.write_text(path.read_text().replace("-3", "-5"))
    os.utime(path, ns=(1, 1))
    assert mesh.bounds(path)[0][2] == -5


def test_a_model_without_normals_gets_them_from_its_faces(tmp_path: Path) -> None:
    (part,) = mesh.load(write_model(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).parts
    np.testing.assert_allclose(part.normals, [[0, 0, 1]] * 3, atol=1e-6)
    assert part.material == Material()


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
        mesh.load(write_model(tmp_path, obj))
    assert "box.obj: " in str(caught.value) and said in str(caught.value) and "\n" not in str(caught.value)


def test_bounds_of_what_is_no_model_are_errors(tmp_path: Path) -> None:
    with pytest.raises(mesh.MeshError, match="vertex 1 is not finite"):
        mesh.bounds(write_model(tmp_path, "v inf 0 0\n"))
    with pytest.raises(mesh.MeshError, match="three numbers"):
        path = tmp_path / "words.obj"
        path.write_text("v a b c\n")
        mesh.bounds(path)
    with pytest.raises(mesh.MeshError, match="No such file"):
        mesh.bounds(tmp_path / "nowhere.obj")
