"""How daylight, from 1 (day) to 0 (night), dims the sun, the ambient light and the sky."""

from pathlib import Path

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.scene.picture import Render, Sky
from drone_render.models.textures import pixels

# Shares of the light (red, green, blue) that are left at these values of daylight; between them, linear interpolation.
DAYLIGHT = (0.0, 0.25, 0.5, 1.0)
SUN = ((0.10, 0.13, 0.20), (0.34, 0.20, 0.14), (0.95, 0.66, 0.42), (1.0, 1.0, 1.0))  # at night it is the moon
AMBIENT = ((0.20, 0.24, 0.36), (0.40, 0.36, 0.44), (0.78, 0.70, 0.68), (1.0, 1.0, 1.0))
STARS_BELOW = 0.45  # the daylight below which stars are visible
SKY_STEPS = 64  # colors of the sky from the horizon to the zenith


def sun(daylight: float) -> Floats:
    """Share (3,) of the sun's light."""
    return _interpolated(SUN, daylight)


def dimmed(render: Render) -> Render:
    """Copy of the settings with the ambient light dimmed by their daylight."""
    red, green, blue = (float(x) for x in np.array(render.ambient) * _interpolated(AMBIENT, render.daylight))
    return render.model_copy(update={"ambient": (red, green, blue)})


def clouds(daylight: float) -> Floats:
    """Brightness (3,) of clouds."""
    return 0.5 * (sun(daylight) + _interpolated(AMBIENT, daylight))


def stars(daylight: float) -> float:
    """Brightness of stars, 0 to 1."""
    return max(1.0 - daylight / STARS_BELOW, 0.0)


def sky_colors(sky: Sky, daylight: float, texture: Path | None) -> Floats:
    """Colors (SKY_STEPS, 3) of the sky from the horizon to the zenith, 0 to 1.

    Rows are evenly spaced in the square root of the sine of the elevation. texture: replaces the sky's two colors.
    Raises MeshError for an unreadable texture.
    """
    root = np.linspace(0.0, 1.0, SKY_STEPS)
    if texture is None:
        haze = (1 - root**2)[:, None] ** 4  # fades out low: most cameras see little more than the horizon
        return (np.array(sky.zenith) * (1 - haze) + np.array(sky.horizon) * haze) * _interpolated(AMBIENT, daylight)
    (width, height), data = pixels(texture)
    image = np.frombuffer(data, np.uint8).reshape(height, width, 4)[..., :3] / 255
    column = daylight * (width - 1)
    left = min(int(column), width - 2) if width > 1 else 0
    right = min(left + 1, width - 1)
    strip = image[:, left] + (image[:, right] - image[:, left]) * (column - left)
    rows = (np.arange(height) + 0.5) / height
    return np.column_stack([np.interp(root, rows, strip[:, i]) for i in range(3)])


def _interpolated(values: tuple[tuple[float, float, float], ...], daylight: float) -> Floats:
    return np.array([np.interp(daylight, DAYLIGHT, [value[i] for value in values]) for i in range(3)])
