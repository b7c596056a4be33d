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
    from drone_engine.geometry.mesh import MeshError
    from drone_engine.scene.schema import Scene, SceneError, load, parse
    from drone_engine.world import World

_WHERE = {
    "Fleet": "fleet", "MeshError": "geometry.mesh", "Scene": "scene.schema", "SceneError": "scene.schema",
    "World": "world", "load": "scene.schema", "parse": "scene.schema",
}

__all__ = ["Fleet", "MeshError", "Scene", "SceneError", "World", "__version__", "load", "parse"]


def __getattr__(name: str) -> Any:
    """Imports a public name when it is first used, so that reading a scene does not load the compiler."""
    if name not in _WHERE:
        raise AttributeError(f"module 'drone_engine' has no attribute '{name}'")
    return getattr(import_module(f"drone_engine.{_WHERE[name]}"), name)
