"""Draws scenes off-screen: pictures, depth and labels of each camera, and films. Needs no ROS; render_node does.

    from drone_engine import World, load
    from drone_render import Renderer

    scene = load("island")
    world = World(scene)
    world.run(300)
    with Renderer(scene) as renderer:
        picture = renderer.draw("chase", world)  # (height, width, 3) uint8
        depth, labels = renderer.measure("chase", world)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from drone_engine.version import __version__

if TYPE_CHECKING:
    from drone_render.film import Film, FilmError
    from drone_render.frame.frame import Frame
    from drone_render.frame.lines import Lines
    from drone_render.gl.context import ContextError
    from drone_render.passes import PassContext, RenderPass
    from drone_render.renderer import Measurement, Renderer

_MODULES = {
    "ContextError": "gl.context", "Film": "film", "FilmError": "film", "Frame": "frame.frame", "Lines": "frame.lines",
    "Measurement": "renderer", "PassContext": "passes", "RenderPass": "passes", "Renderer": "renderer",
}

__all__ = [
    "ContextError", "Film", "FilmError", "Frame", "Lines", "Measurement", "PassContext", "RenderPass", "Renderer",
    "__version__",
]


def __getattr__(name: str) -> Any:
    """Imports a public name when it is first used."""
    if name not in _MODULES:
        raise AttributeError(f"module 'drone_render' has no attribute '{name}'")
    return getattr(import_module(f"drone_render.{_MODULES[name]}"), name)
