"""Water: waves that mirror the sky, and the shallows where land is near."""

import math
from pathlib import Path

import moderngl
import numpy as np

from drone_render.context import Attribute, Device, samplers, write
from drone_render.edges import WATER_MARK
from drone_render.frame import Frame
from drone_render.ranges import RangePass
from drone_render.shaders import Variant
from drone_render.shore import Shore
from drone_render.sky import SkyColours
from drone_sim.look import Render, Water
from drone_sim.mesh import Model, Part

GRAVITY = 9.81  # m/s^2; how fast waves of a length run follows from it
WAVE_LENGTHS = np.array([9.0, 5.3, 2.9, 1.7])  # m
WAVE_HEADINGS = np.array([0.4, -0.5, 1.3, -1.6])  # rad
CROWDED = 2.5  # how soon waves fade as they shrink: half is left where one is 16 pixels long
WAVE_SHARES = np.array([0.16, 0.18, 0.20, 0.18])  # of the wave height


class WaterPass:
    """The surfaces of water."""

    def __init__(
        self, device: Device, render: Render, water: Water, skies: SkyColours | None, sun: bool, shore: Shore | None
    ) -> None:
        sky = skies is not None
        self._skies = skies
        self._program = device.program(Variant.of(
            "water", SKY=sky, SUN=sun and sky, SHORE=shore is not None,
            EDGES=shore is None and render.antialiasing is not None,  # what is seen through water keeps its mark
        ))  # fmt: skip
        self._shore = shore
        samplers(self._program, shore=0, colours=1)
        if shore is not None:
            write(self._program, square=shore.square)
        self._device = device
        self._arrays: dict[tuple[Path, moderngl.Program], list[moderngl.VertexArray]] = {}
        number = 2 * math.pi / WAVE_LENGTHS
        heading = np.cos(WAVE_HEADINGS), np.sin(WAVE_HEADINGS)
        slope = math.pi * water.wave_height * WAVE_SHARES
        self._number = number
        self._speed = np.sqrt(GRAVITY * number) * water.wave_speed  # rad/s, deep water
        write(
            self._program, mark=WATER_MARK,
            deep=water.deep, shallow=water.shallow, ambient=render.ambient,
            wave_x=number * heading[0], wave_y=number * heading[1],
            slope_x=slope * heading[0], slope_y=slope * heading[1],
        )  # fmt: skip
        if skies is not None:
            write(self._program, horizon=skies.horizon)

    def begin(self, frame: Frame) -> None:
        """Sets the camera, and moves the waves to the time of the picture."""
        if self._shore is not None:
            self._shore.texture.use(0)
            gl = self._device.context
            gl.enable(moderngl.BLEND)
            gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA, moderngl.ZERO, moderngl.ONE  # type: ignore[assignment]
        if self._skies is not None:
            self._skies.texture.use(1)
        write(
            self._program,
            view_projection=frame.view_projection.T, eye=frame.eye,
            wave_phase=np.fmod(-self._speed * frame.time, 2 * math.pi),
            wave_pixel=self._number * frame.pixel * CROWDED,
            **frame.sun_uniforms(),
        )  # fmt: skip

    def draw(self, model: Model, matrix: bytes) -> None:
        """Draws one body of water."""
        self._program["model"].write(matrix)  # type: ignore[union-attr]
        self._render(model, self._program, [])

    def measure(self, model: Model, ranges: RangePass) -> None:
        """Draws the shape of one for its distances."""
        self._render(model, ranges.program, ranges.single.attributes)

    def _render(self, model: Model, program: moderngl.Program, attributes: list[Attribute]) -> None:
        if (model.path, program) not in self._arrays:
            self._arrays[model.path, program] = [self._upload(program, part, attributes) for part in model.parts]
        for array in self._arrays[model.path, program]:
            array.render()

    def _upload(self, program: moderngl.Program, part: Part, attributes: list[Attribute]) -> moderngl.VertexArray:
        position: Attribute = self._device.buffer(part.vertices), "3f", "position"
        return self._device.vertex_array(program, [position, *attributes], self._device.buffer(part.faces))
