"""What is left of the light between day (1) and night (0): of the sun, of what comes from all around, of the sky."""

from pathlib import Path

import numpy as np

from drone_engine.scene.picture import Render, Sky
from drone_render.geometry import pixels
from drone_render.view import Array

TIMES = (0.0, 0.25, 0.5, 1.0)
SUN = ((0.10, 0.13, 0.20), (0.34, 0.20, 0.14), (0.95, 0.66, 0.42), (1.0, 1.0, 1.0))  # by night it is the moon
AMBIENT = ((0.20, 0.24, 0.36), (0.40, 0.36, 0.44), (0.78, 0.70, 0.68), (1.0, 1.0, 1.0))
STARS_FROM = 0.45  # the daylight at which the first stars come out
STEPS = 64  # of the sky's colours, from the horizon to the zenith


def sun(daylight: float) -> Array:
    """The share of the parallel light, (3,)."""
    return _between(SUN, daylight)


def dimmed(render: Render) -> Render:
    """The same with the ambient light that its daylight leaves."""
    red, green, blue = (float(x) for x in np.array(render.ambient) * _between(AMBIENT, render.daylight))
    return render.model_copy(update={"ambient": (red, green, blue)})


def clouds(daylight: float) -> Array:
    """How bright clouds are, (3,)."""
    return 0.5 * (sun(daylight) + _between(AMBIENT, daylight))


def stars(daylight: float) -> float:
    """How bright stars are."""
    return max(1.0 - daylight / STARS_FROM, 0.0)


def colours(sky: Sky, daylight: float, texture: Path | None) -> Array:
    """The sky's colours, (STEPS, 3) from 0 to 1, evenly in the root of the sine of the elevation. Raises MeshError."""
    root = np.linspace(0.0, 1.0, STEPS)
    if texture is None:
        haze = (1 - root**2)[:, None] ** 4  # it ends low: most cameras see little more than the horizon
        return (np.array(sky.zenith) * (1 - haze) + np.array(sky.horizon) * haze) * _between(AMBIENT, daylight)
    (width, height), data = pixels(texture)
    image = np.frombuffer(data, np.uint8).reshape(height, width, 4)[..., :3] / 255
    column = daylight * (width - 1)
    left = min(int(column), width - 2) if width > 1 else 0
    right = min(left + 1, width - 1)
    strip = image[:, left] + (image[:, right] - image[:, left]) * (column - left)
    rows = (np.arange(height) + 0.5) / height
    return np.column_stack([np.interp(root, rows, strip[:, i]) for i in range(3)])


def _between(values: tuple[tuple[float, float, float], ...], daylight: float) -> Array:
    return np.array([np.interp(daylight, TIMES, [value[i] for value in values]) for i in range(3)])
