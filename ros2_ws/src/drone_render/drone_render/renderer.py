"""Draws the cameras of one scene."""

import math
from collections.abc import Iterable
from typing import Self

import moderngl
import numpy as np

from drone_render import view
from drone_render.context import Device
from drone_render.geometry import sphere
from drone_render.hierarchy import LIGHTS, Hierarchy, Lighting
from drone_render.image import Picture
from drone_render.passes import Frame, Lights, Placed, SkyPass, SolidPass, Sun, WaterPass
from drone_render.shore import Shore, survey
from drone_render.view import Array
from drone_sim import mesh
from drone_sim.scene import Scene


class Renderer:
    """A scene on the graphics device. Use it as a context manager, or call `release`.

    Raises SceneError, MeshError or ValueError for models and textures that are not as they should be.
    """

    def __init__(self, scene: Scene, context: moderngl.Context) -> None:
        self.scene = scene
        self.hierarchy = Hierarchy(scene)
        self._context = context
        self._device = Device(context)
        self._lighting = Lighting(self.hierarchy)
        self._targets: dict[tuple[int, int], moderngl.Framebuffer] = {}
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
        scene, render = self.scene, self.scene.render
        loaded = {path: mesh.load(path) for path in {scene.model_path(name) for name in self.hierarchy.names}}
        self._models = [loaded[scene.model_path(name)] for name in self.hierarchy.names]
        spheres = {path: sphere(model) for path, model in loaded.items()}
        self._centres = np.array([spheres[model.path][0] for model in self._models]).reshape(-1, 3)
        self._radii = np.array([spheres[model.path][1] for model in self._models])
        self._is_water = np.array(
            [thing.shading == "water" and render.water is not None for thing in scene.objects.values()], dtype=bool
        )
        self._solid = SolidPass(self._device, render, self._models)
        self._sun = self._lighting.sun()
        has_sun = self._sun is not None
        self._water = None
        if render.water is not None and self._is_water.any():
            self._water = WaterPass(self._device, render, render.water, has_sun, self._survey())
        self._sky = None if render.sky is None else SkyPass(self._device, render.sky, has_sun)
        self._background = render.ambient if render.sky is None else render.sky.horizon
        for camera in scene.cameras.values():
            if camera.size not in self._targets:
                self._targets[camera.size] = self._device.target(camera.size)

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
        """Draws with every program that can occur: the driver compiles each at its first use, which takes a while."""
        camera = next(iter(self.scene.cameras.values()), None)
        if camera is None:
            return
        self._begin(camera.size)
        for row, surfaces in enumerate(self._solid.surfaces):
            for surface in surfaces:
                for count in range(min(int(self._lighting.lit[row].sum()), LIGHTS) + 1):
                    variant = surface.variant(count)
                    if not self._is_water[row] and variant not in self._device.programs:
                        array = surface.array(count)
                        surface.paint(array.program)
                        array.program["view_projection"] = array.program["model"] = tuple(np.eye(4).ravel())
                        array.render()
        for name in self.scene.cameras:
            self.draw(name, self.hierarchy.start, 0.0, Picture(self.scene.cameras[name].size, name))

    def draw(self, name: str, poses: Array, time: float, picture: Picture) -> Array:
        """Draws what a camera sees into `picture`, which has its size; returns its matrix (4, 4) in the world.

        poses: (n, 7) of all objects in the scene's order, each in its parent's frame; time in s.
        """
        camera = self.scene.cameras[name]
        world = self.hierarchy.world(poses)
        lights = self._lights(world)
        place = self.hierarchy.camera(name, world, time)
        sun = None
        if self._sun is not None:
            sun = Sun(self._lighting.positions(world)[self._sun], self._lighting.colours[self._sun])
        clip = view.projection(camera) @ view.view(place)
        half = math.tan(camera.fov / 2)
        frame = Frame(
            time, place, clip, (half, half * camera.size[1] / camera.size[0]), 2 * half / camera.size[0], sun
        )  # fmt: skip
        target = self._begin(camera.size)
        self._draw_objects(frame, world, lights)
        if self._sky is not None:
            self._sky.draw(frame)
        target.read_into(picture.buffer, components=3, alignment=1, write_offset=picture.offset)
        return place

    def _begin(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        context, target = self._context, self._targets[size]
        context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        context.front_face = "cw"  # the projection turns y over, and triangles with it
        context.depth_func = "<="  # the sky lies at the far end of it
        target.use()
        target.clear(*self._background)
        return target

    def _lights(self, world: Array) -> Lights:
        lighting = self._lighting
        positions = np.column_stack([lighting.positions(world), lighting.falloff])
        colours = np.column_stack([lighting.colours, lighting.cut])
        return Lights(positions.astype(np.float32), colours.astype(np.float32))

    def _draw_objects(self, frame: Frame, world: Array, lights: Lights) -> None:
        centres = np.einsum("nij,nj->ni", world[:, :3, :3], self._centres) + world[:, :3, 3]
        planes = view.frustum(frame.view_projection)
        inside = centres @ planes[:, :3].T + planes[:, 3] > -self._radii[:, None]
        away = np.linalg.norm(centres - frame.eye, axis=1)
        chosen = self._lighting.strongest(lights.positions[:, :3].astype(np.float64), centres, self._radii)
        matrices = np.ascontiguousarray(world.transpose(0, 2, 1), dtype=np.float32)
        seen = [
            Placed(int(row), matrices[row].tobytes(), chosen[row])
            for row in np.argsort(away, kind="stable")
            if inside[row].all()
        ]
        # What is near hides the most; what surrounds the camera, such as the ground, comes after it.
        solid = [placed for placed in seen if not self._is_water[placed.row]]
        near = [placed for placed in solid if away[placed.row] > self._radii[placed.row]]
        around = [placed for placed in solid if away[placed.row] <= self._radii[placed.row]]
        self._solid.draw(frame, near, around, lights)
        if self._water is not None:
            self._water.begin(frame)
            for placed in seen:
                if self._is_water[placed.row]:
                    self._water.draw(self._models[placed.row], placed.matrix)
