"""What a picture shows beside solid things: water, and the sky behind it all."""

import math
from dataclasses import dataclass
from pathlib import Path

import moderngl
import numpy as np

from drone_render.context import Device, write
from drone_render.edges import SKY_MARK, WATER_MARK
from drone_render.shaders import Variant
from drone_render.shore import Shore
from drone_render.view import Array
from drone_sim.assets import asset_path
from drone_sim.look import Render, Sky, Water
from drone_sim.mesh import Model, Part

GRAVITY = 9.81  # m/s^2; how fast waves of a length run follows from it
WAVE_LENGTHS = np.array([9.0, 5.3, 2.9, 1.7])  # m
WAVE_HEADINGS = np.array([0.4, -0.5, 1.3, -1.6])  # rad
CROWDED = 2.5  # how soon waves fade as they shrink: half is left where one is 16 pixels long
WAVE_SHARES = np.array([0.16, 0.18, 0.20, 0.18])  # of the wave height


@dataclass(frozen=True)
class Sun:
    """The light that distance does not weaken: where it is, and its colour times its intensity."""

    position: Array
    colour: Array


@dataclass(frozen=True)
class Frame:
    """What all draws of a picture share."""

    time: float  # s
    camera: Array  # (4, 4), from the camera's frame to the world
    view_projection: Array  # (4, 4)
    half: tuple[float, float]  # tangents of half the angles of view, across and down
    pixel: float  # angle of a pixel, rad
    sun: Sun | None

    @property
    def eye(self) -> Array:
        """Position of the camera, (3,)."""
        return self.camera[:3, 3]

    def sun_uniforms(self) -> dict[str, Array]:
        """Direction and colour of the sun as this camera sees it."""
        if self.sun is None:
            return {}
        way = self.sun.position - self.eye
        return {"sun_direction": way / np.linalg.norm(way), "sun_colour": self.sun.colour}


class WaterPass:
    """The surfaces of water."""

    def __init__(self, device: Device, render: Render, water: Water, sun: bool, shore: Shore | None) -> None:
        sky = render.sky is not None
        self._program = device.program(Variant.of(
            "water", SKY=sky, SUN=sun and sky, SHORE=shore is not None, EDGES=render.antialiasing is not None,
        ))  # fmt: skip
        self._shore = shore
        if shore is not None:
            write(self._program, square=shore.square)
        self._device = device
        self._arrays: dict[Path, list[moderngl.VertexArray]] = {}
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
        if render.sky is not None:
            write(self._program, horizon=render.sky.horizon, zenith=render.sky.zenith)

    def begin(self, frame: Frame) -> None:
        """Sets the camera, and moves the waves to the time of the picture."""
        if self._shore is not None:
            self._shore.texture.use(0)
        write(
            self._program,
            view_projection=frame.view_projection.T, eye=frame.eye,
            wave_phase=np.fmod(-self._speed * frame.time, 2 * math.pi),
            wave_pixel=self._number * frame.pixel * CROWDED,
            **frame.sun_uniforms(),
        )  # fmt: skip

    def draw(self, model: Model, matrix: bytes) -> None:
        """Draws one body of water."""
        if model.path not in self._arrays:
            self._arrays[model.path] = [self._upload(part) for part in model.parts]
        self._program["model"].write(matrix)  # type: ignore[union-attr]
        for array in self._arrays[model.path]:
            array.render()

    def _upload(self, part: Part) -> moderngl.VertexArray:
        attributes = [(self._device.buffer(part.vertices), "3f", "position")]
        return self._device.vertex_array(self._program, attributes, self._device.buffer(part.faces))


class SkyPass:
    """What is seen where nothing stands. Drawn last, so that it costs only the pixels that are left."""

    def __init__(self, device: Device, render: Render, sky: Sky, sun: bool) -> None:
        self._sky = sky
        self._clouds = None if sky.clouds is None else device.texture(texture_path(sky.clouds))
        self._program = device.program(Variant.of(
            "sky", CLOUDS=sky.clouds is not None, SUN=sun, EDGES=render.antialiasing is not None,
        ))  # fmt: skip
        self._array = device.vertex_array(self._program)
        write(self._program, mark=SKY_MARK, horizon=sky.horizon, zenith=sky.zenith)

    def draw(self, frame: Frame) -> None:
        """Fills what is left of the picture."""
        right, down = -frame.camera[:3, 1] * frame.half[0], -frame.camera[:3, 2] * frame.half[1]
        write(
            self._program,
            rays=np.array([frame.camera[:3, 0], right, down]),
            drift=np.fmod(np.array(self._sky.drift) * frame.time, 1.0),
            **frame.sun_uniforms(),
        )
        if self._clouds is not None:
            self._clouds.use(0)
        self._array.render(vertices=3)


def texture_path(name: str) -> Path:
    """File of a texture that a scene names, with or without its ending. Raises ValueError."""
    return asset_path("textures", name if Path(name).suffix else f"{name}.png")
