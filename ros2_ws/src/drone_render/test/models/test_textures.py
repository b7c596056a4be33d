"""A color map and a normal map in one texture."""

from pathlib import Path

import numpy as np
from PIL import Image

from drone_render.models.textures import pack


def save(path: Path, values: np.ndarray) -> Path:
    Image.fromarray(np.rint(values).astype(np.uint8)).save(path)
    return path


def test_a_packed_map_decodes_to_its_colors_and_normals(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    mix = rng.random((32, 32, 2))
    colors = 20 + mix[..., :1] * [120, 60, 30] + mix[..., 1:] * [20, 40, 60]  # of two hues
    normals = np.dstack([rng.uniform(-0.5, 0.5, (32, 32, 2)), np.ones((32, 32))])
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    packed = pack(save(tmp_path / "colors.png", colors), save(tmp_path / "normals.png", 127.5 + 127.5 * normals))
    assert packed is not None and packed.size == (32, 32)
    data = np.frombuffer(packed.data, np.uint8).reshape(32, 32, 4)[::-1] / 255  # its first row is the bottom
    back = packed.ramp[0] + data[..., :1] * packed.ramp[1] + data[..., 1:2] * packed.ramp[2]
    assert np.abs(255 * back - colors).max() < 2.0
    slopes = packed.steepness * (2 * data[..., 2:] - 1)
    assert np.abs(slopes - normals[..., :2] / normals[..., 2:]).max() < 0.015
    assert 0.45 < packed.steepness < 0.55


def test_colors_of_many_hues_are_not_packed(tmp_path: Path) -> None:
    colors = np.random.default_rng(3).uniform(0, 255, (32, 32, 3))
    normals = np.full((32, 32, 3), [127.5, 127.5, 255])
    gray = np.repeat(colors[..., :1], 3, axis=2)
    flat = save(tmp_path / "normals.png", normals)
    assert pack(save(tmp_path / "colors.png", colors), flat) is None
    assert pack(save(tmp_path / "gray.png", gray), flat) is not None
    assert pack(save(tmp_path / "small.png", gray[:16]), flat) is None  # sizes differ
