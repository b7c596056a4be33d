"""Scenes: the schema of scene files, validation, and loading from YAML or from Python data."""

from drone_engine.scene.errors import SceneError
from drone_engine.scene.loading import load, make_scene, parse
from drone_engine.scene.schema import Scene

__all__ = ["Scene", "SceneError", "load", "make_scene", "parse"]
