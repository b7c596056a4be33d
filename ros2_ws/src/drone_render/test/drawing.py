"""Draws small scenes for the tests."""

from collections.abc import Callable

import moderngl
import numpy as np

from drone_engine import Scene
from drone_render.renderer import Renderer

Make = Callable[[str], Scene]


def draw(
    scene: Scene, graphics: moderngl.Context, camera: str = "front", time: float = 0.0, tolerance: float = 1.0
) -> np.ndarray:
    """The picture, (height, width, 3) uint8, of a scene at its start poses."""
    with Renderer(scene, graphics, tolerance) as renderer:
        return renderer.draw(camera, time=time)
