"""The sky: three domes around an object or the camera, drawn in one pass where there are no surfaces."""

from dataclasses import dataclass

import moderngl
import numpy as np

from drone_engine.arrays import Floats
from drone_engine.scene.picture import Render, Sky
from drone_render.frame import daylight
from drone_render.frame.frame import Frame
from drone_render.gl.device import Device
from drone_render.gl.edges import SKY_MARK
from drone_render.gl.uniforms import set_samplers, write
from drone_render.gl.variant import Variant

MAX_OFFSET = 0.8  # of the domes' radius; cameras further from the center see the sky as from there


@dataclass(frozen=True)
class SkyColors:
    """The dome of colors, which water reflects as well."""

    texture: moderngl.Texture  # one row, from the horizon to the zenith
    horizon: Floats  # (3,) color at the horizon

    @classmethod
    def of(cls, device: Device, sky: Sky, light: float) -> "SkyColors":
        """The colors of a sky at a daylight from 0 to 1. Raises MeshError for an unreadable texture."""
        rows = daylight.sky_colors(sky, light, sky.colours)
        texels = np.rint(255 * np.clip(rows, 0, 1)).astype(np.uint8)
        return cls(device.plain_texture((len(texels), 1), texels), rows[0])


class SkyPass:
    """Colors, stars, the sun and clouds. Drawn after all opaque surfaces, so it costs only the remaining pixels."""

    def __init__(self, device: Device, render: Render, sky: Sky, colors: SkyColors, sun: bool) -> None:
        self._sky = sky
        self._colors = colors
        has_stars = sky.stars is not None and daylight.stars(render.daylight) > 0
        self._maps = {
            name: device.texture(file)
            for name, file in (("clouds", sky.clouds), ("stars", sky.stars if has_stars else None))
            if file is not None
        }
        self._program = device.program(Variant.of(
            "sky", CLOUDS="clouds" in self._maps, STARS="stars" in self._maps, SUN=sun,
            EDGES=render.antialiasing is not None,
        ))  # fmt: skip
        self._array = device.vertex_array(self._program)
        set_samplers(self._program, colors=0, clouds=1, stars=2)
        write(
            self._program, mark=SKY_MARK,
            cloudlight=daylight.clouds(render.daylight), starlight=daylight.stars(render.daylight),
        )  # fmt: skip

    def draw(self, frame: Frame, center: Floats) -> None:
        """Fills the pixels without surfaces; center: (3,) of the domes, in the world."""
        right, down = -frame.camera[:3, 1] * frame.half_tangents[0], -frame.camera[:3, 2] * frame.half_tangents[1]
        offset = (frame.eye - center) / self._sky.radius
        offset *= min(1.0, MAX_OFFSET / max(float(np.linalg.norm(offset)), 1e-9))
        write(
            self._program,
            rays=np.array([frame.camera[:3, 0], right, down]), offset=offset,
            drift=np.fmod(np.array(self._sky.drift) * frame.time, 1.0),
            **frame.sun_uniforms(),
        )  # fmt: skip
        self._colors.texture.use(0)
        for unit, name in ((1, "clouds"), (2, "stars")):
            if name in self._maps:
                self._maps[name].use(unit)
        self._array.render(vertices=3)
