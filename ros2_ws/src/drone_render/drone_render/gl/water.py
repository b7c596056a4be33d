"""Water: waves that reflect the sky, and clear shallows near the shore."""

import math
from collections.abc import Mapping

import moderngl
import numpy as np

from drone_engine.arrays import Floats
from drone_engine.geometry.mesh import Model
from drone_engine.scene.picture import Render, Water
from drone_render.frame.frame import Frame
from drone_render.gl.depth import DepthPass
from drone_render.gl.device import Device
from drone_render.gl.edges import WATER_MARK
from drone_render.gl.instances import Batch, Instances
from drone_render.gl.shore import Shore
from drone_render.gl.sky import SkyColors
from drone_render.gl.uniforms import set_samplers, write
from drone_render.gl.variant import Variant

GRAVITY = 9.81  # m/s^2; the speed of waves of a given length follows from it
WAVE_LENGTHS = np.array([9.0, 5.3, 2.9, 1.7])  # m
WAVE_HEADINGS = np.array([0.4, -0.5, 1.3, -1.6])  # rad
WAVE_FADE = 2.5  # how soon waves fade with distance: to one half where a wave is 16 pixels long
WAVE_SHARES = np.array([0.16, 0.18, 0.20, 0.18])  # of the wave height


class WaterPass:
    """The water surfaces of a scene.

    models: by their object's row in the scene; skies: the sky to reflect, None without a sky; sun: whether there is
    one; shore: map of the shallows, None without land.
    """

    def __init__(
        self, device: Device, render: Render, water: Water, models: Mapping[int, Model], skies: SkyColors | None,
        sun: bool, shore: Shore | None,
    ) -> None:  # fmt: skip
        sky = skies is not None
        self._skies = skies
        self._program = device.program(Variant.of(
            "water", SKY=sky, SUN=sun and sky, SHORE=shore is not None,
            EDGES=shore is None and render.antialiasing is not None,  # surfaces seen through water keep their own mark
        ))  # fmt: skip
        self._shore = shore
        set_samplers(self._program, shore=0, colors=1)
        if shore is not None:
            write(self._program, square=shore.square)
        self._device = device
        self._instances = Instances(device)
        parts = [(row, part) for row, model in models.items() for part in model.parts]
        self._rows = np.array([row for row, _ in parts], dtype=np.intp)
        self._batches = [Batch(0, part.faces.size, number, 1) for number, (_, part) in enumerate(parts)]
        self._shapes = [(device.buffer(part.vertices), device.buffer(part.faces)) for _, part in parts]
        self._arrays: dict[moderngl.Program, list[moderngl.VertexArray]] = {}
        wave_number = 2 * math.pi / WAVE_LENGTHS
        heading = np.cos(WAVE_HEADINGS), np.sin(WAVE_HEADINGS)
        slope = math.pi * water.wave_height * WAVE_SHARES
        self._wave_number = wave_number
        self._angular_frequency = np.sqrt(GRAVITY * wave_number) * water.wave_speed  # rad/s, in deep water
        write(
            self._program, mark=WATER_MARK,
            deep=water.deep, shallow=water.shallow, ambient=render.ambient,
            wave_x=wave_number * heading[0], wave_y=wave_number * heading[1],
            slope_x=slope * heading[0], slope_y=slope * heading[1],
        )  # fmt: skip
        if skies is not None:
            write(self._program, horizon=skies.horizon)

    def draw(self, frame: Frame) -> None:
        """Draws the water with the waves at the picture's time."""
        gl = self._device.context
        if self._shore is not None:
            self._shore.texture.use(0)
            gl.enable(moderngl.BLEND)
            gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA, moderngl.ZERO, moderngl.ONE  # type: ignore[assignment]
        if self._skies is not None:
            self._skies.texture.use(1)
        write(
            self._program,
            view_projection=frame.view_projection.T, eye=frame.eye,
            wave_phase=np.fmod(-self._angular_frequency * frame.time, 2 * math.pi),
            wave_pixel=self._wave_number * frame.pixel_angle * WAVE_FADE,
            **frame.sun_uniforms(),
        )  # fmt: skip
        self._render(self._program, frame.world)
        gl.disable(moderngl.BLEND)

    def draw_depth(self, frame: Frame, depth: DepthPass) -> None:
        """Draws the water's depth and labels."""
        self._render(depth.program, frame.world)

    def _render(self, program: moderngl.Program, world: Floats) -> None:
        if program not in self._arrays:
            self._arrays[program] = [
                self._device.vertex_array(program, [(position, "3f", "position"), *self._instances.attributes], index)
                for position, index in self._shapes
            ]
        self._instances.fill(world[self._rows], self._rows + 1.0, self._batches)
        for number, array in enumerate(self._arrays[program]):
            self._instances.draw(array, number)
