"""The texture of the person's skin: around u = 0.5 it is the face, elsewhere it is plain."""

import numpy as np

from make.canvas import Texture, mix, pixels
from make.noise import fractal, smoothstep
from make.shapes import Array

HEIGHT, LOW = 0.25, 1.50  # m that v covers, from this z on
HALF_WIDTH = 0.080  # m, of the head
EYE = (0.0315, 1.637)  # m, y and z
MOUTH = 1.562  # m, z

TONE = ((0.74, 0.54, 0.42), (0.80, 0.60, 0.47))
HAIR, LIP, WHITE, IRIS = (0.20, 0.12, 0.08), (0.56, 0.27, 0.24), (0.86, 0.85, 0.82), (0.22, 0.36, 0.42)


def face(rng: np.random.Generator) -> Texture:
    """Brows, eyes, cheeks and a smile, painted as seen from the front."""
    size = 512
    down, across = pixels(size)
    y = HALF_WIDTH * np.sin(2 * np.pi * (across - 0.5)) + np.where(np.abs(across - 0.5) > 0.25, 9.0, 0.0)
    z = LOW + HEIGHT * (1 - down)
    pores = fractal(rng, size, 64, octaves=2)
    colour = mix(TONE[0], TONE[1], np.clip(0.7 * fractal(rng, size, 8, octaves=5) + 0.3 * pores, 0, 1))
    side = np.abs(y)
    _put(colour, (0.76, 0.40, 0.33), 0.55 * _spot(side - 0.045, z - 1.592, 0.021, 0.018))
    _put(colour, (0.76, 0.42, 0.34), 0.40 * _spot(y, z - 1.603, 0.016, 0.016))
    _put(colour, (0.52, 0.33, 0.25), 0.35 * _spot(side - EYE[0], z - EYE[1] - 0.004, 0.024, 0.018))
    _mouth(colour, y, z)
    ball = _eyes(colour, y, z)
    arch = 1.6635 - 11.0 * (side - 0.034) ** 2
    thick = 0.0048 * np.clip((0.052 - side) / 0.03, 0.3, 1) * smoothstep(0.010, 0.016, side) * (side < 0.052)
    brow = smoothstep(1.0, 0.6, np.abs(z - arch) / np.maximum(thick, 1e-6))
    _put(colour, HAIR, brow * (0.8 + 0.2 * fractal(rng, size, 128, 16, 2)))
    smile = np.exp(-(((z - MOUTH - 9 * y**2) / 0.0028) ** 2)) * (side < 0.03)
    return colour, 0.45 * pores + 5.0 * ball + 2.0 * brow - 2.5 * smile


def _mouth(colour: Array, y: Array, z: Array) -> None:
    """Closed lips that smile, and the dimples at their ends."""
    line = MOUTH + 9.0 * y**2
    taper = np.clip(1 - (np.abs(y) / 0.029) ** 2, 0, 1)
    upper = smoothstep(0.0050, 0.0035, (z - line) / np.maximum(taper, 0.05)) * (z > line) * (taper > 0)
    lower = smoothstep(0.0075, 0.0050, (line - z) / np.maximum(taper, 0.05)) * (z <= line) * (taper > 0)
    _put(colour, LIP, 0.75 * np.maximum(upper, lower))
    _put(colour, (0.30, 0.12, 0.11), smoothstep(0.0022, 0.0010, np.abs(z - line)) * (np.abs(y) < 0.030))
    _put(colour, (0.46, 0.29, 0.23), 0.7 * _spot(np.abs(y) - 0.033, z - MOUTH - 0.010, 0.003, 0.005))


def _eyes(colour: Array, y: Array, z: Array) -> Array:
    """White, iris, pupil, a glint and the lid's dark edge; returns where the eyeballs bulge."""
    across, up = np.abs(y) - EYE[0], z - EYE[1]
    upper = 0.0110 * (1 - (across / 0.0175) ** 2)
    lower = -0.0095 * (1 - (across / 0.0175) ** 2)
    inside = smoothstep(0.0, 0.0012, np.minimum(upper - up, up - lower))
    _put(colour, WHITE, inside * (1 - 0.35 * smoothstep(0.002, 0.012, up)))
    away = np.hypot(across, up - 0.002)
    _put(colour, IRIS, inside * smoothstep(0.0092, 0.0082, away))
    _put(colour, (0.10, 0.17, 0.20), inside * smoothstep(0.0070, 0.0084, away) * smoothstep(0.0094, 0.0086, away))
    _put(colour, (0.03, 0.03, 0.03), inside * smoothstep(0.0050, 0.0042, away))
    glint = np.hypot(y - EYE[0] * np.sign(y) + 0.003, up - 0.0055)
    _put(colour, (1.0, 1.0, 1.0), inside * smoothstep(0.0024, 0.0016, glint))
    lid = np.abs(across) < 0.0185
    _put(colour, (0.14, 0.08, 0.06), lid * smoothstep(0.0026, 0.0012, np.abs(up - upper)))
    _put(colour, (0.40, 0.25, 0.20), 0.6 * lid * smoothstep(0.0014, 0.0006, np.abs(up - lower)))
    _put(colour, (0.45, 0.29, 0.22), 0.7 * lid * smoothstep(0.0014, 0.0006, np.abs(up - upper - 0.0045)))
    return np.exp(-((across / 0.013) ** 2) - (up / 0.010) ** 2)


def _put(colour: Array, paint: tuple[float, float, float], share: Array) -> None:
    """Paints over a picture where the share is not 0."""
    colour += (np.asarray(paint) - colour) * share[..., None]


def _spot(across: Array, up: Array, wide: float, high: float) -> Array:
    return np.asarray(np.exp(-((across / wide) ** 2) - (up / high) ** 2))
