"""Draws small scenes for the tests."""

from collections.abc import Callable

import moderngl
import numpy as np

from drone_engine import Scene
from drone_render.image import Picture
from drone_render.renderer import Renderer

Make = Callable[[str], Scene]


def draw(
    scene: Scene, graphics: moderngl.Context, camera: str = "front", time: float = 0.0, tolerance: float = 1.0
) -> np.ndarray:
    """The picture, (height, width, 3) uint8, of a scene as it starts."""
    width, height = scene.cameras[camera].size
    picture = Picture((width, height), camera)
    with Renderer(scene, graphics, tolerance) as renderer:
        renderer.draw(camera, renderer.hierarchy.start, time, picture)
    return np.frombuffer(picture.pixels(), np.uint8).reshape(height, width, 3)
