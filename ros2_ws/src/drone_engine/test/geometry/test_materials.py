"""Materials of MTL files: what is missing or broken is a warning."""

import logging
from pathlib import Path

import pytest
from PIL import Image

from drone_engine.geometry import mesh
from reference.models import MTL, write_model


def test_a_missing_library_or_texture_is_a_warning(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = write_model(tmp_path, mtl=None)
    with caplog.at_level(logging.WARNING):
        assert mesh.load(path).parts
    assert "box.mtl" in caplog.text
    caplog.clear()
    path = write_model(tmp_path, mtl=MTL.replace("wood.png", "gone.png"))
    with caplog.at_level(logging.WARNING):
        assert all(part.material.color_map is None for part in mesh.load(path).parts)
    assert "box.mtl: line 5: no texture 'gone.png'; drawn without" in caplog.text


@pytest.mark.parametrize("damage", ["words", "cut off", "folder"])
def test_an_unreadable_texture_is_a_warning_too(tmp_path: Path, caplog: pytest.LogCaptureFixture, damage: str) -> None:
    path = write_model(tmp_path)
    texture = tmp_path / "wood.png"
    Image.new("RGB", (64, 64)).save(texture)
    assert all(part.material.color_map for part in mesh.load(path).parts if part.material.name == "wood")
    data = texture.read_bytes()
    texture.unlink()
    if damage == "folder":
        texture.mkdir()
    else:
        texture.write_bytes(b"no picture" if damage == "words" else data[:-40])
    with caplog.at_level(logging.WARNING):
        (wood,) = (part.material for part in mesh.load(path).parts if part.material.name == "wood")
    assert wood.color_map is None and wood.normal_map == tmp_path / "bumps.png"
    assert "box.mtl: line 5: " in caplog.text and "'wood.png'" in caplog.text and caplog.text.count("\n") == 1
