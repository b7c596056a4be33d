"""Pictures without ROS, from the command line."""

from pathlib import Path

import pytest
from PIL import Image

from drone_render import snapshot

from .drawing import Make

SCENE = """
objects: {ball: {model: ball, static: true}}
cameras: {front: {size: [64, 48], pose: [-3, 0, 0]}}
"""


@pytest.fixture
def path(make_scene: Make, tmp_path: Path) -> Path:
    make_scene(SCENE)
    (tmp_path / "ball.yaml").write_text("version: 1\n" + SCENE)
    return tmp_path / "ball.yaml"


def test_a_picture_has_the_size_that_is_asked_for(path: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "ball.png"
    for size, options in [((64, 48), []), ((16, 32), ["--size", "16", "32"])]:
        assert snapshot.main([str(path), "--out", str(out), *options]) == 0
        with Image.open(out) as image:
            assert image.size == size


@pytest.mark.parametrize("size", ["0 0", "-5 5", "1 1", "64 15", "4097 64", "20000 20000"])
def test_a_size_that_no_camera_may_have_is_refused_in_one_line(
    path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], size: str
) -> None:
    assert snapshot.main([str(path), "--out", str(tmp_path / "x.png"), "--size", *size.split()]) == 1
    said = capsys.readouterr().err
    assert said == f"snapshot: --size {size}: 'size': expected two numbers of pixels from 16 to 4096\n"
    assert not (tmp_path / "x.png").exists()
