"""Draws the cameras of one scene."""

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

from drone_engine import Scene
from drone_engine.arrays import Floats
from drone_engine.geometry import mesh
from drone_render.arrays import Bytes, Float32s, Labels
from drone_render.frame import daylight, view
from drone_render.frame.frame import Frame
from drone_render.frame.hierarchy import Hierarchy
from drone_render.frame.lighting import Lighting
from drone_render.frame.lines import Lines
from drone_render.gl import context as contexts
from drone_render.gl.context import Context
from drone_render.gl.depth import DepthPass
from drone_render.gl.device import Device
from drone_render.gl.edges import EdgePass
from drone_render.gl.overlay import LinePass
from drone_render.gl.shore import Shore, survey
from drone_render.gl.sky import SkyColors, SkyPass
from drone_render.gl.solid import TOLERANCE, SolidPass
from drone_render.gl.uniforms import packed
from drone_render.gl.water import WaterPass
from drone_render.passes import UserPasses

if TYPE_CHECKING:
    from drone_render.frame.hierarchy import State


class Measurement(NamedTuple):
    """Depth and labels of a picture, the top row first."""

    depth: Float32s  # (height, width) m along the optical axis, inf where there is no object
    labels: Labels  # (height, width) number of the object, from 1 in the scene's order; 0 where there is none


class Renderer:
    """A scene on the graphics device. Use it as a context manager, or call `release`.

    context: an OpenGL context to share; by default the renderer creates its own. tolerance: error of the levels of
    detail in pixels; at 0 every triangle is drawn. Raises ContextError without OpenGL, and SceneError, MeshError or
    ValueError for models and textures that cannot be used.

    A state is a World of this scene, poses (7,) by name (the other objects are where the scene file has them), poses
    (n, 7) of all objects in the scene's order, each in its parent's frame, or None: all objects as in the scene file.
    """

    def __init__(self, scene: Scene, context: Context | None = None, tolerance: float = TOLERANCE) -> None:
        self.scene = scene
        self._tolerance = tolerance
        self.hierarchy = Hierarchy(scene)
        self._owns_context, self._released = context is None, False
        self._context = contexts.create() if context is None else context
        self._finish = contexts.finisher()
        self._device = Device(self._context)
        self._lighting = Lighting(self.hierarchy)
        self._passes: UserPasses | None = None
        self._depth: DepthPass | None = None
        self._overlay: LinePass | None = None
        self._shows_overlay = False
        try:
            with self._context:
                self._edges = None if scene.render.antialiasing is None else EdgePass(self._device)
                self._load()
                self._warm_up()
        except BaseException:
            self.release()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def release(self) -> None:
        """Frees everything on the device, and the context if the renderer created it; the renderer cannot draw then."""
        if self._released:
            return
        self._released = True
        with self._context:
            if self._passes is not None:
                self._passes.release()
            self._device.release()
        if self._owns_context:
            self._context.release()

    @property
    def programs(self) -> Iterable[str]:
        """The fragment shaders in use, as compiled."""
        return [variant.sources()[1] for variant in self._device.programs]

    def draw(self, camera: str, state: "State" = None, time: float | None = None) -> Bytes:
        """Picture (height, width, 3) of a camera, the top row first; state: see the class.

        time: simulated time in s, which moves clouds, waves and orbits; by default a World's own, else 0. Raises
        ValueError for an unknown camera and for poses that do not fit the scene.
        """
        width, height = self._size(camera)
        pixels = np.empty((height, width, 3), np.uint8)
        self.draw_into(pixels, camera, self.hierarchy.poses(state), _time(state, time))
        return pixels

    def measure(self, camera: str, state: "State" = None, time: float | None = None) -> Measurement:
        """Depth and labels of a camera, in full detail; arguments and errors as in `draw`."""
        width, height = self._size(camera)
        depth, labels = np.empty((height, width), np.float32), np.empty((height, width), np.uint16)
        self.measure_into(depth, labels, camera, self.hierarchy.poses(state), _time(state, time))
        return Measurement(depth, labels)

    def draw_into(self, pixels: Bytes, camera: str, poses: Floats, time: float) -> Floats:
        """Draws a picture into `pixels`, contiguous (height, width, 3); returns the camera's matrix (4, 4).

        poses: (n, 7) of all objects in the scene's order, each in its parent's frame; time in s.
        """
        frame = self._frame(camera, poses, time)
        with self._context:
            target = self._targets[frame.size]
            self._device.begin(target, self._background)
            self._solid.draw(frame)
            if self._passes is not None:
                self._passes.draw_opaque(frame, target)
            if self._water is not None:
                self._water.draw(frame)
            if self._sky is not None:
                self._sky.draw(frame, self._sky_center(frame))
            if self._passes is not None:
                self._passes.draw_blended(frame, target)
            if self._overlay is not None and self._shows_overlay:
                self._overlay.draw(frame)
            if self._edges is not None:
                self._finish()  # the pass reads the picture, and would wait for it without letting other threads run
                target = self._edges.draw(frame.size)
            self._finish()
            target.read_into(pixels, components=3, alignment=1)
        return frame.camera

    def measure_into(self, depth: Float32s, labels: Labels, camera: str, poses: Floats, time: float) -> Floats:
        """Draws depth and labels into arrays (height, width); otherwise as `draw_into`."""
        frame = self._frame(camera, poses, time)
        with self._context:
            if self._depth is None:
                self._depth = DepthPass(self._device)
            self._depth.begin(frame.size, packed(frame.view_projection.T))
            self._solid.draw_depth(frame, self._depth)
            if self._water is not None:
                self._water.draw_depth(frame, self._depth)
            self._finish()
            self._depth.read(frame.size, depth, labels)
        return frame.camera

    def show(self, lines: Lines | None) -> None:
        """Sets lines and spheres to draw over all further pictures; None removes them."""
        self._shows_overlay = lines is not None
        if lines is not None:
            with self._context:
                if self._overlay is None:
                    self._overlay = LinePass(self._device)
                self._overlay.show(lines)

    def set_cameras(self, scene: Scene) -> None:
        """Takes over the cameras of a scene that is otherwise equal to the renderer's."""
        self.scene = self.hierarchy.scene = scene
        with self._context:
            self._make_targets()

    def _size(self, camera: str) -> tuple[int, int]:
        if camera not in self.scene.cameras:
            raise ValueError(f"no camera '{camera}' in the scene '{self.scene.name}'; there are "
                             f"{', '.join(self.scene.cameras) or 'none'}")
        return self.scene.cameras[camera].size

    def _load(self) -> None:
        """Uploads the models, and builds the passes that the scene needs."""
        scene, render = self.scene, daylight.dimmed(self.scene.render)
        loaded = {path: mesh.load(path) for path in {scene.model_path(name) for name in self.hierarchy.names}}
        self._models = [loaded[scene.model_path(name)] for name in self.hierarchy.names]
        self._is_water = np.array(
            [thing.shading == "water" and render.water is not None for thing in scene.objects.values()], dtype=bool
        )
        solid = {row: model for row, model in enumerate(self._models) if not self._is_water[row]}
        self._solid = SolidPass(self._device, render, solid, self._lighting, self._tolerance)
        has_sun = self._lighting.sun is not None
        colors = None if render.sky is None else SkyColors.of(self._device, render.sky, render.daylight)
        self._water = None
        if render.water is not None and self._is_water.any():
            water = {row: model for row, model in enumerate(self._models) if self._is_water[row]}
            self._water = WaterPass(self._device, render, render.water, water, colors, has_sun, self._survey())
        self._sky = None
        if render.sky is not None and colors is not None:
            self._sky = SkyPass(self._device, render, render.sky, colors, has_sun)
        if scene.render.passes:
            self._passes = UserPasses(scene, self.hierarchy, self._device)
        self._background = render.ambient
        self._targets: dict[tuple[int, int], contexts.Framebuffer] = {}
        self._make_targets()

    def _make_targets(self) -> None:
        """Creates a framebuffer for each size of the cameras."""
        for camera in self.scene.cameras.values():
            if camera.size not in self._targets:
                self._targets[camera.size] = (
                    self._device.target(camera.size) if self._edges is None else self._edges.target(camera.size)
                )

    def _survey(self) -> Shore | None:
        """The shore map of the static solid objects, at the lowest water level."""
        world = self.hierarchy.world(self.hierarchy.start)
        things = list(self.scene.objects.values())
        land = [
            (self._models[row], world[row])
            for row, thing in enumerate(things)
            if thing.static and not self._is_water[row]
        ]
        waters = np.flatnonzero(self._is_water)
        level = min(float(world[row, 2, 3] + self._models[row].high[2]) for row in waters)
        return survey(self._device, land, level)

    def _warm_up(self) -> None:
        """Draws everything once: the driver compiles each program at its first use, which is slow."""
        first = next(iter(self.scene.cameras.values()), None)
        if first is None:
            return
        self._device.begin(self._targets[first.size], self._background)
        self._solid.warm_up()
        for name in self.scene.cameras:
            self.draw(name)

    def _frame(self, name: str, poses: Floats, time: float) -> Frame:
        camera = self.scene.cameras[name]
        world = self.hierarchy.world(poses)
        matrix = self.hierarchy.camera(name, world, time)
        to_eye, to_clip = view.view(matrix), view.projection(camera)
        half = math.tan(camera.fov / 2)
        half_tangents = half, half * camera.size[1] / camera.size[0]
        return Frame(
            name, camera.size, camera.near, time, world, matrix, to_eye, to_clip, to_clip @ to_eye, half_tangents,
            2 * half / camera.size[0], self._lighting.sun,
        )  # fmt: skip

    def _sky_center(self, frame: Frame) -> Floats:
        """Center (3,) of the sky's domes in the world."""
        sky = self.scene.render.sky
        return frame.eye if sky is None or sky.parent is None else self.hierarchy.matrix(frame.world, sky.parent)[:3, 3]


def _time(state: "State", time: float | None) -> float:
    """The given time in s, or that of the state if it is a World, else 0."""
    return float(getattr(state, "time", 0.0)) if time is None else time
