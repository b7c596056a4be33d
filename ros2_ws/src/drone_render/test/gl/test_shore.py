"""The map of shallow water."""

import moderngl
import numpy as np
import pytest

from drone_engine.geometry import mesh
from drone_render.gl.device import Device
from drone_render.gl.shore import survey

from ..drawing import Make


@pytest.mark.parametrize("level", [0.0, 4000.0])
def test_water_is_clear_where_land_is_near(level: float, make_scene: Make, graphics: moderngl.Context) -> None:
    device = Device(graphics)
    model = mesh.load(make_scene("objects: {floor: {model: crate, mass: 1}}").model_path("floor"))
    far, near = np.eye(4), np.eye(4)
    far[:3, 3], near[:3, 3] = (-10, 0, level - 9), (10, 0, level - 0.4)
    shore = survey(device, [(model, far), (model, near)], level)
    assert shore is not None and shore.square[:2] == (0, 0)
    clear = np.frombuffer(shore.texture.read(), np.uint8).reshape(shore.texture.size)
    device.release()
    middle = len(clear) // 2
    assert clear[middle].nonzero()[0].min() > middle  # the block at x = 10 alone; the other lies too deep
    assert clear.max() == 255
