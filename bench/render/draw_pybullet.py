"""PyBullet in bench.render: getCameraImage with its EGL plugin or its TinyRenderer; it has one light."""

import importlib.util
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pybullet

from bench.render import scene as scenery
from bench.render.scene import Bytes


class Drawer:
    """Draws color and depth; PyBullet always computes both."""

    def __init__(self, mode: str) -> None:
        pybullet.connect(pybullet.DIRECT)
        self._kind = pybullet.ER_TINY_RENDERER
        if mode == "egl":
            self._kind = pybullet.ER_BULLET_HARDWARE_OPENGL
            plugin = importlib.util.find_spec("eglRenderer")
            if plugin is None or plugin.origin is None or pybullet.loadPlugin(plugin.origin, "_eglRendererPlugin") < 0:
                raise RuntimeError("its EGL plugin does not load")
        self.about = f"1 light, color and depth, {'EGL' if mode == 'egl' else 'its own rasterizer'}"
        with tempfile.TemporaryDirectory() as folder:
            self._add(Path(folder), scenery.hill(), None, (0.0, 0.0, 0.0), 1.0)
            for k, (position, scale) in enumerate(scenery.balls()):
                self._add(Path(folder), scenery.ball(), k, position, scale)

    def _add(self, folder: Path, mesh: scenery.Mesh, number: int | None, position: tuple[float, float, float],
             scale: float) -> None:
        model, texture = folder / f"{number}.obj", folder / f"{number}.png"
        model.write_text(scenery.obj(mesh))
        scenery.save(scenery.colors(number), texture)
        shape = pybullet.createVisualShape(pybullet.GEOM_MESH, fileName=str(model), meshScale=[scale] * 3)
        body = pybullet.createMultiBody(0, -1, shape, basePosition=position)
        pybullet.changeVisualShape(body, -1, textureUniqueId=pybullet.loadTexture(str(texture)), rgbaColor=[1] * 4)

    def size(self, width: int, height: int) -> Callable[[float], Bytes]:
        """Prepares for pictures of this size; returns the function that draws picture k, (height, width, 3)."""
        lens = pybullet.computeProjectionMatrixFOV(scenery.HEIGHT_OF_VIEW, width / height, scenery.NEAR, scenery.FAR)

        def frame(number: float) -> Bytes:
            view = pybullet.computeViewMatrix(scenery.eye(number).tolist(), [0, 0, 0], [0, 0, 1])
            image = pybullet.getCameraImage(width, height, view, lens, shadow=0, renderer=self._kind,
                                            lightDirection=scenery.SUN.tolist(),
                                            flags=pybullet.ER_NO_SEGMENTATION_MASK)
            return np.asarray(image[2], np.uint8).reshape(height, width, 4)[..., :3]

        return frame
