"""A drone simulation engine: scenes, collision detection, dynamics, effects, flight. Needs no ROS.

    from drone_engine import World, load

    world = World(load("island"))
    world.run(300)
    print(world.pose("user_drone"))
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from drone_engine.version import __version__

if TYPE_CHECKING:
    from drone_engine.fleet import Fleet
    from drone_engine.geometry.obj import MeshError
    from drone_engine.scene.errors import SceneError
    from drone_engine.scene.loading import load, make_scene, parse
    from drone_engine.scene.schema import Scene
    from drone_engine.world import World

_MODULES = {
    "Fleet": "fleet", "MeshError": "geometry.obj", "Scene": "scene.schema", "SceneError": "scene.errors",
    "World": "world", "load": "scene.loading", "make_scene": "scene.loading", "parse": "scene.loading",
}

__all__ = ["Fleet", "MeshError", "Scene", "SceneError", "World", "__version__", "load", "make_scene", "parse"]


def __getattr__(name: str) -> Any:
    """Imports a public name on first use, so that reading a scene does not load the compiler."""
    if name not in _MODULES:
        raise AttributeError(f"module 'drone_engine' has no attribute '{name}'")
    return getattr(import_module(f"drone_engine.{_MODULES[name]}"), name)
