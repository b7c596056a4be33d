"""This project's renderer in bench.render: lit per pixel, with normal maps, sun and three lamps, from scene files."""

import math
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from bench.render import scene as scenery
from bench.render.scene import Bytes
from drone_engine.scene import loading as scenes
from drone_render.gl import context
from drone_render.renderer import Renderer

PAINT = "newmtl paint\nKd 1 1 1\nKs {0} {0} {0}\nNs {1}\nmap_Kd ../textures/{2}.png\nnorm ../textures/{2}_normal.png\n"
SCENE = """
version: 1
render: {{ambient: [{ambient}, {ambient}, {ambient}], normal_mapping: {{}}, specular: {{}}{antialiasing}}}
objects:
{objects}
lights:
  sun: {{pose: [{sun}], intensity: {sun_share}}}
{lamps}
cameras:
  eye: {{near: {near}, far: {far}, orbit: {{radius: {radius}, height: {altitude}, period: {period}}}}}
"""


def write(folder: Path, antialiasing: bool = False) -> Path:
    """Writes the scene, its models and textures into the folder; returns the path of the scene."""
    for kind in ("scenes", "models", "textures"):
        (folder / kind).mkdir(exist_ok=True)
    meshes: list[tuple[str, scenery.Mesh, float, int | None]] = [("hill", scenery.hill(), 1.0, None)]
    meshes += [(f"ball_{k}", scenery.ball(), ball.scale, k) for k, ball in enumerate(scenery.balls())]
    for name, mesh, scale, number in meshes:
        (folder / "models" / f"{name}.obj").write_text(scenery.obj(mesh, f"{name}.mtl", scale))
        paint = PAINT.format(scenery.SPECULAR, scenery.SHININESS, name)
        (folder / "models" / f"{name}.mtl").write_text(paint)
        scenery.save(scenery.colors(number), folder / "textures" / f"{name}.png")
        scenery.save(scenery.bumps(number), folder / "textures" / f"{name}_normal.png")
    objects = ["  hill: {model: hill, static: true}"]
    objects += [f"  ball_{k}: {{model: ball_{k}, static: true, pose: {list(map(float, ball.position))}}}"
                for k, ball in enumerate(scenery.balls())]
    lamps = [f"  lamp_{i}: {{pose: {list(place)}, intensity: {scenery.LAMP_SHARE}, reach: {scenery.REACH}}}"
             for i, place in enumerate(scenery.LAMPS)]
    path = folder / "scenes" / "hill.yaml"
    path.write_text(SCENE.format(
        antialiasing=", antialiasing: {}" if antialiasing else "", ambient=scenery.AMBIENT, objects="\n".join(objects),
        sun=", ".join(str(x) for x in 1000 * scenery.SUN), sun_share=scenery.SUN_SHARE, lamps="\n".join(lamps),
        near=scenery.NEAR, far=scenery.FAR, radius=scenery.RADIUS, altitude=scenery.ALTITUDE,
        period=2 * math.pi / scenery.STEP))
    return path


class Drawer:
    """Draws with the same calls as the node."""

    def __init__(self, mode: str = "") -> None:
        self.about = "per pixel, 4 lights, normal maps, levels of detail" + (", smooth edges" if mode else "")
        self._folder = tempfile.TemporaryDirectory()
        self._scene = scenes.load(write(Path(self._folder.name), antialiasing=mode == "smooth"))
        self._graphics = context.create()
        self._renderer: Renderer | None = None

    def size(self, width: int, height: int) -> Callable[[float], Bytes]:
        """Prepares for pictures of this size; returns the function that draws picture k, (height, width, 3)."""
        if self._renderer is not None:
            self._renderer.release()
        across = 2 * math.atan(math.tan(math.radians(scenery.HEIGHT_OF_VIEW) / 2) * width / height)
        camera = self._scene.cameras["eye"].model_copy(update={"size": (width, height), "fov": across})
        scene = self._scene.model_copy(update={"cameras": {"eye": camera}})
        renderer = self._renderer = Renderer(scene, self._graphics)
        rows = np.empty((height, width, 3), np.uint8)

        def frame(number: float) -> Bytes:
            renderer.draw_into(rows, "eye", renderer.hierarchy.start, number)
            return rows

        return frame
