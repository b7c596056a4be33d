"""The fixtures `scene` and `world`, small scenes from text; and where message packages are installed."""

import os
import sys

from reference.fixtures import _folder, scene, world

__all__ = ["_folder", "scene", "world"]

os.environ.setdefault("AMENT_PREFIX_PATH", sys.prefix)
