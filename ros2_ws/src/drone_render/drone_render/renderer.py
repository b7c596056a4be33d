"""Draws the cameras of one scene."""

import math
from collections.abc import Iterable
from typing import Self

import moderngl
import numpy as np

from drone_engine import Scene
from drone_engine.geometry import mesh
from drone_render import daylight, view
from drone_render.context import Device, packed, waiter
from drone_render.edges import EdgePass
from drone_render.frame import Frame
from drone_render.hierarchy import Hierarchy, Lighting
from drone_render.image import Picture
from drone_render.lines import Lines
from drone_render.overlay import LinePass
from drone_render.ranges import RangePass
from drone_render.shore import Shore, survey
from drone_render.sky import SkyColours, SkyPass
from drone_render.solid import TOLERANCE, SolidPass
from drone_render.view import Array
from drone_render.water import WaterPass


class Renderer:
    """A scene on the graphics device. Use it as a context manager, or call `release`.

    tolerance: pixels that surfaces may be off by where far things have fewer triangles; at 0 none is off at all.
    Raises SceneError, MeshError or ValueError for models and textures that are not as they should be.
    """

    def __init__(self, scene: Scene, context: moderngl.Context, tolerance: float = TOLERANCE) -> None:
        self.scene = scene
        self._tolerance = tolerance
        self.hierarchy = Hierarchy(scene)
        self._context = context
        self._wait = waiter()
        self._device = Device(context)
        self._lighting = Lighting(self.hierarchy)
        self._targets: dict[tuple[int, int], moderngl.Framebuffer] = {}
        self._ranges: RangePass | None = None
        self._overlay: LinePass | None = None  # as it was last
        self._lines: LinePass | None = None  # if it is shown
        self._edges = None if scene.render.antialiasing is None else EdgePass(self._device)
        try:
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
        """Gives everything back to the device; the context stays."""
        self._device.release()

    @property
    def programs(self) -> Iterable[str]:
        """The fragment shaders in use, as they were compiled."""
        return [variant.sources()[1] for variant in self._device.programs]

    def _load(self) -> None:
        scene, render = self.scene, daylight.dimmed(self.scene.render)
        loaded = {path: mesh.load(path) for path in {scene.model_path(name) for name in self.hierarchy.names}}
        self._models = [loaded[scene.model_path(name)] for name in self.hierarchy.names]
        self._is_water = np.array(
            [thing.shading == "water" and render.water is not None for thing in scene.objects.values()], dtype=bool
        )
        solid = {row: model for row, model in enumerate(self._models) if not self._is_water[row]}
        self._solid = SolidPass(self._device, render, solid, self._lighting, self._tolerance)
        has_sun = self._lighting.sun is not None
        colours = None if render.sky is None else SkyColours.of(self._device, render.sky, render.daylight)
        self._water = None
        if render.water is not None and self._is_water.any():
            bodies = {row: model for row, model in enumerate(self._models) if self._is_water[row]}
            self._water = WaterPass(self._device, render, render.water, bodies, colours, has_sun, self._survey())
        self._sky = None
        if render.sky is not None and colours is not None:
            self._sky = SkyPass(self._device, render, render.sky, colours, has_sun)
        self._background = render.ambient
        self._aim()

    def _aim(self) -> None:
        """Makes what cameras draw into, one for each size."""
        for camera in self.scene.cameras.values():
            if camera.size not in self._targets:
                self._targets[camera.size] = (
                    self._device.target(camera.size) if self._edges is None else self._edges.target(camera.size)
                )

    def _survey(self) -> Shore | None:
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
        """Draws everything once: the driver compiles each program at its first use, which takes a while."""
        camera = next(iter(self.scene.cameras.values()), None)
        if camera is None:
            return
        self._device.begin(self._targets[camera.size], self._background)
        self._solid.warm_up()
        for name in self.scene.cameras:
            self.draw(name, self.hierarchy.start, 0.0, Picture(self.scene.cameras[name].size, name))

    def _frame(self, name: str, world: Array, time: float) -> Frame:
        camera = self.scene.cameras[name]
        place = self.hierarchy.camera(name, world, time)
        clip = view.projection(camera) @ view.view(place)
        half = math.tan(camera.fov / 2)
        tangents = half, half * camera.size[1] / camera.size[0]
        return Frame(time, place, clip, tangents, 2 * half / camera.size[0], self._lighting.sun)

    def draw(self, name: str, poses: Array, time: float, picture: Picture) -> Array:
        """Draws what a camera sees into `picture`, which has its size; returns its matrix (4, 4) in the world.

        poses: (n, 7) of all objects in the scene's order, each in its parent's frame; time in s.
        """
        size = self.scene.cameras[name].size
        world = self.hierarchy.world(poses)
        frame = self._frame(name, world, time)
        target = self._targets[size]
        self._device.begin(target, self._background)
        self._solid.draw(frame, world)
        if self._water is not None:
            self._water.draw(frame, world)
        if self._sky is not None:
            self._sky.draw(frame, self._domes(frame, world))
        if self._lines is not None:
            self._lines.draw(frame.view_projection, size, self.scene.cameras[name].near)
        if self._edges is not None:
            self._wait()  # the pass fetches from the picture, and would wait for it without letting threads run
            target = self._edges.draw(size)
        self._wait()
        target.read_into(picture.buffer, components=3, alignment=1, write_offset=picture.offset)
        return frame.camera

    def measure(self, name: str, poses: Array, time: float, depth: Picture, labels: Picture) -> Array:
        """The same for how far away a camera's pixels are (32FC1, m along its optical axis, inf for the sky) and which
        objects they show (16UC1, numbers from 1 in the scene's order, 0 for none)."""
        if self._ranges is None:
            self._ranges = RangePass(self._device)
        world = self.hierarchy.world(poses)
        frame = self._frame(name, world, time)
        self._ranges.begin(self.scene.cameras[name].size, packed(frame.view_projection.T))
        self._solid.measure(frame, world, self._ranges)
        if self._water is not None:
            self._water.measure(world, self._ranges)
        self._wait()
        self._ranges.read(depth, labels)
        return frame.camera

    def show(self, lines: Lines | None) -> None:
        """Draws lines over the pictures from now on; none for None."""
        if lines is not None and self._overlay is None:
            self._overlay = LinePass(self._device)
        if lines is not None and self._overlay is not None:
            self._overlay.show(lines)
        self._lines = None if lines is None else self._overlay

    def adopt(self, scene: Scene) -> None:
        """Goes on with the same scene with other cameras."""
        self.scene = self.hierarchy.scene = scene
        self._aim()

    def _domes(self, frame: Frame, world: Array) -> Array:
        """The middle of the sky's domes, (3,)."""
        sky = self.scene.render.sky
        return frame.eye if sky is None or sky.parent is None else self.hierarchy.place(world, sky.parent)[:3, 3]
