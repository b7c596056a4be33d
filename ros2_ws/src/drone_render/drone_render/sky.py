"""The sky: three domes that hang on an object or on the camera, drawn at once where nothing stands before them."""

from dataclasses import dataclass

import moderngl
import numpy as np

from drone_engine.scene.picture import Render, Sky
from drone_render import daylight
from drone_render.context import Device, samplers, write
from drone_render.edges import SKY_MARK
from drone_render.frame import Frame
from drone_render.shaders import Variant
from drone_render.view import Array

OUTWARDS = 0.8  # of the domes' radius: who is further out sees them from there


@dataclass(frozen=True)
class SkyColours:
    """The dome of colours, which water mirrors, too: a row of them up to the zenith, and the one at the horizon."""

    texture: moderngl.Texture
    horizon: Array

    @classmethod
    def of(cls, device: Device, sky: Sky, light: float) -> "SkyColours":
        """What the sky has at that daylight. Raises ValueError."""
        rows = daylight.colours(sky, light, sky.colours)
        texels = np.rint(255 * np.clip(rows, 0, 1)).astype(np.uint8)
        return cls(device.plain_texture((len(texels), 1), texels), rows[0])


class SkyPass:
    """What is seen where nothing stands. Drawn last, so that it costs only the pixels that are left."""

    def __init__(self, device: Device, render: Render, sky: Sky, colours: SkyColours, sun: bool) -> None:
        self._sky = sky
        self._colours = colours
        by_night = sky.stars is not None and daylight.stars(render.daylight) > 0
        self._maps = {
            name: device.texture(file)
            for name, file in (("clouds", sky.clouds), ("stars", sky.stars if by_night else None))
            if file is not None
        }
        self._program = device.program(Variant.of(
            "sky", CLOUDS="clouds" in self._maps, STARS="stars" in self._maps, SUN=sun,
            EDGES=render.antialiasing is not None,
        ))  # fmt: skip
        self._array = device.vertex_array(self._program)
        samplers(self._program, colours=0, clouds=1, stars=2)
        write(
            self._program, mark=SKY_MARK,
            cloudlight=daylight.clouds(render.daylight), starlight=daylight.stars(render.daylight),
        )  # fmt: skip

    def draw(self, frame: Frame, middle: Array) -> None:
        """Fills what is left of the picture; middle: of the domes, (3,)."""
        right, down = -frame.camera[:3, 1] * frame.half[0], -frame.camera[:3, 2] * frame.half[1]
        inside = (frame.eye - middle) / self._sky.radius
        inside *= min(1.0, OUTWARDS / max(float(np.linalg.norm(inside)), 1e-9))
        write(
            self._program,
            rays=np.array([frame.camera[:3, 0], right, down]), inside=inside,
            drift=np.fmod(np.array(self._sky.drift) * frame.time, 1.0),
            **frame.sun_uniforms(),
        )  # fmt: skip
        self._colours.texture.use(0)
        for unit, name in ((1, "clouds"), (2, "stars")):
            if name in self._maps:
                self._maps[name].use(unit)
        self._array.render(vertices=3)
