"""Who touches whom, where, and how deep: of a scene that runs, and by itself.

    from drone_engine.collision import OBB, Shape, contacts, intersects
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drone_engine.collision.mesh.shape import Shape
    from drone_engine.collision.queries import Contacts, contacts, intersects, manifolds
    from drone_engine.collision_level import OBB, OCTREE, SPHERE, TRIANGLE

__all__ = ["OBB", "OCTREE", "SPHERE", "TRIANGLE", "Contacts", "Shape", "contacts", "intersects", "manifolds"]


def __getattr__(name: str) -> Any:
    """What is asked for is imported then: a scene of boxes needs no meshes."""
    if name not in __all__:
        raise AttributeError(f"module 'drone_engine.collision' has no attribute '{name}'")
    return getattr(import_module("drone_engine.collision.queries"), name)
