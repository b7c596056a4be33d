"""What a picture is made of: solid things, then water, then the sky behind it all."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import moderngl
import numpy as np
import numpy.typing as npt

from drone_render.context import Device, packed, write
from drone_render.geometry import tangents
from drone_render.shaders import Variant
from drone_render.shore import Shore
from drone_render.view import Array
from drone_sim.assets import asset_path
from drone_sim.mesh import Model, Part
from drone_sim.scene import Render, Sky, Water

FAINT = 0.1  # a highlight that reflects less is not seen, so it is not computed
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


@dataclass(frozen=True)
class Lights:
    """Of all lights: positions with 1/reach^2, and colours with what is cut off, each (n, 4) float32."""

    positions: npt.NDArray[np.float32]
    colours: npt.NDArray[np.float32]


@dataclass(frozen=True)
class Placed:
    """An object in a picture: its row in the scene, its packed matrix, its lights."""

    row: int
    matrix: bytes
    lights: npt.NDArray[np.intp]


class Surface:
    """One part of a model on the device, and the programs that draw it, one for each number of lights."""

    def __init__(self, device: Device, part: Part, render: Render) -> None:
        material = part.material
        normal_map = material.normal_map if render.normal_mapping is not None else None
        self._device = device
        self._material = material
        self._maps = {"colour_map": material.colour_map, "normal_map": normal_map}
        self._specular = render.specular is not None and max(material.specular) >= FAINT
        self._attributes = [
            (device.buffer(part.vertices), "3f", "position"),
            (device.buffer(part.normals), "3f", "normal"),
        ]
        if any(self._maps.values()):
            self._attributes.append((device.buffer(part.uv), "2f", "uv"))
        if normal_map is not None:
            self._attributes.append((device.buffer(tangents(part)), "4f", "tangent"))
        self._index = device.buffer(part.faces)
        self._arrays: dict[int, moderngl.VertexArray] = {}
        self.textures = tuple(device.texture(path) for path in self._maps.values() if path is not None)

    def variant(self, lights: int) -> Variant:
        """The program that draws this with so many lights."""
        return Variant.of(
            "solid",
            LIGHTS=lights,
            UV=any(self._maps.values()),
            TEXTURED=self._maps["colour_map"] is not None,
            NORMAL_MAP=self._maps["normal_map"] is not None,
            EMISSIVE=any(self._material.emission),
            SPECULAR=squarings(self._material.shininess) if self._specular else False,
        )

    def array(self, lights: int) -> moderngl.VertexArray:
        """What to draw with so many lights."""
        if lights not in self._arrays:
            program = self._device.program(self.variant(lights))
            self._arrays[lights] = self._device.vertex_array(program, self._attributes, self._index)
        return self._arrays[lights]

    def paint(self, program: moderngl.Program) -> None:
        """Gives the program this material and these textures."""
        material = self._material
        write(program, colour=material.colour, specular=material.specular, emission=material.emission)
        for unit, texture in enumerate(self.textures):
            texture.use(unit)
        for unit, name in enumerate(name for name, path in self._maps.items() if path is not None):
            program[name] = unit


def squarings(shininess: float) -> int:
    """How often to square the cosine to the mirrored light so that it looks like Blinn's with this exponent."""
    return int(np.clip(round(math.log2(max(shininess, 1.0) / 4)), 1, 6))


class SolidPass:
    """All that is neither water nor sky. Equal models are on the device once, and equal states are set once."""

    def __init__(self, device: Device, render: Render, models: Sequence[Model]) -> None:
        self._device = device
        self._ambient = render.ambient
        made: dict[Path, list[Surface]] = {}
        for model in models:
            if model.path not in made:
                made[model.path] = [Surface(device, part, render) for part in model.parts]
        self.surfaces = [made[model.path] for model in models]
        """Of each object, in the scene's order."""
        # Drawing in this order changes programs and textures least, which costs the driver more than a draw.
        surfaces = [surface for parts in made.values() for surface in parts]
        kinds = {surface: (str(surface.variant(0)), str(surface.textures)) for surface in surfaces}
        self._rank = {surface: i for i, surface in enumerate(sorted(kinds, key=kinds.__getitem__))}

    def draw(self, frame: Frame, near: Sequence[Placed], around: Sequence[Placed], lights: Lights) -> None:
        """Draws objects, those nearby and then those around the camera, which they hide."""
        view_projection = packed(frame.view_projection.T)
        for variant, program in self._device.programs.items():
            if variant.name == "solid":
                program["view_projection"].write(view_projection)  # type: ignore[union-attr]
                write(program, ambient=self._ambient, eye=frame.eye)
        for group in (near, around):
            draws = [(surface, placed) for placed in group for surface in self.surfaces[placed.row]]
            draws.sort(key=lambda draw: self._rank[draw[0]])
            self._draw_sorted(draws, lights)

    def _draw_sorted(self, draws: Sequence[tuple[Surface, Placed]], lights: Lights) -> None:
        painted: tuple[moderngl.Program, Surface] | None = None
        for surface, placed in draws:
            count = len(placed.lights)
            array = surface.array(count)
            program = array.program
            program["model"].write(placed.matrix)  # type: ignore[union-attr]
            if count:
                program["light_position"].write(lights.positions[placed.lights].tobytes())  # type: ignore[union-attr]
                program["light_colour"].write(lights.colours[placed.lights].tobytes())  # type: ignore[union-attr]
            if painted != (program, surface):
                surface.paint(program)
                painted = program, surface
            array.render()


class WaterPass:
    """The surfaces of water."""

    def __init__(self, device: Device, render: Render, water: Water, sun: bool, shore: Shore | None) -> None:
        sky = render.sky is not None
        self._program = device.program(Variant.of("water", SKY=sky, SUN=sun and sky, SHORE=shore is not None))
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
            self._program,
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

    def __init__(self, device: Device, sky: Sky, sun: bool) -> None:
        self._sky = sky
        self._clouds = None if sky.clouds is None else device.texture(texture_path(sky.clouds))
        self._program = device.program(Variant.of("sky", CLOUDS=sky.clouds is not None, SUN=sun))
        self._array = device.vertex_array(self._program)
        write(self._program, horizon=sky.horizon, zenith=sky.zenith)

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
