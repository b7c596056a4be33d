"""The fixtures `scene` and `world`: small scenes from text."""

from reference.fixtures import _folder, scene, world

__all__ = ["_folder", "scene", "world"]
