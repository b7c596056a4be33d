"""The text of OBJ files."""

from pathlib import Path

import numpy as np

from drone_engine.geometry.obj import Obj


def test_numbers_of_vertices_may_count_backwards(tmp_path: Path) -> None:
    path = tmp_path / "two.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf 1 3 -1\n")
    np.testing.assert_array_equal(Obj.read(path).faces, [[0, 1, 2], [0, 2, 3]])


def test_polygons_are_fans_and_broken_faces_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "five.obj"
    path.write_text("mtllib a.mtl\nusemtl wood\n" + "v 0 0 0\n" * 5 + "f 1/2/3 2 3 4//1 5\nf a b c\nmtllib b.mtl\n")
    obj = Obj.read(path)
    np.testing.assert_array_equal(obj.faces, [[0, 1, 2], [0, 2, 3], [0, 3, 4]])
    assert (obj.libraries, obj.materials, obj.has_normals) == (["a.mtl", "b.mtl"], {"wood"}, False)
