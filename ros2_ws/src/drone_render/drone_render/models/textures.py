"""Image files as texture data, and a color map and a normal map packed into one texture."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from drone_engine.geometry.mesh import MeshError
from drone_render.arrays import Bytes, Float32s

MAX_SLOPE = 4.0  # of a normal in a packed map
MAX_COLOR_ERROR = 1.5  # of 255, mean; above it two maps are not packed


@dataclass(frozen=True)
class PackedMap:
    """A color map and a normal map in one RGBA image, and the constants that decode it.

    color = ramp[0] + ramp[1] * r + ramp[2] * g. The normal's slopes x / z and y / z are steepness * (2 * (b, a) - 1):
    slopes average correctly in mip maps and need no square root.
    """

    size: tuple[int, int]  # width, height
    data: bytes  # RGBA, the bottom row first
    ramp: Float32s  # (3, 3)
    steepness: float


def pixels(path: Path) -> tuple[tuple[int, int], bytes]:
    """Size (width, height) and RGBA bytes of an image file, the bottom row first as in OpenGL. Raises MeshError."""
    try:
        with Image.open(path) as image:
            upright = image.convert("RGBA").transpose(Image.Transpose.FLIP_TOP_BOTTOM)
            return upright.size, upright.tobytes()
    except OSError as error:
        raise MeshError(f"{path}: not readable as an image: {error}") from None


def pack(color_map: Path, normal_map: Path) -> PackedMap | None:
    """Packs both maps into one, or returns None if their sizes differ or the colors need more than two channels.

    Most materials vary little in hue, so the two principal axes of their colors suffice. Raises MeshError.
    """
    (size, colors), (normal_size, normals) = (_bytes(path) for path in (color_map, normal_map))
    if size != normal_size:
        return None
    sample = colors[::17, :3].astype(np.float32)
    mean = sample.mean(axis=0)
    sample -= mean
    axes = np.linalg.eigh(sample.T @ sample)[1][:, 1:].astype(np.float32)
    axes *= np.where(axes.sum(axis=0) < 0, -1, 1)  # else rounding down would brighten some textures and darken others
    if float(np.abs(sample - sample @ axes @ axes.T).mean()) > MAX_COLOR_ERROR:
        return None
    # From here on one row per channel: reductions along rows are much faster than along columns.
    data = np.empty((4, len(colors)), np.uint8)
    along = axes.T @ colors[:, :3].T.astype(np.float32) - (mean @ axes)[:, None]
    low, span = along.min(axis=1), np.maximum(np.ptp(along, axis=1), 1.0)
    data[:2] = (along - low[:, None]) * (255 / span)[:, None] + 0.5
    x, y, z = normals[:, :3].T.astype(np.float32) / 127.5 - 1
    slopes = np.array([x, y]) / np.maximum(z, 1 / MAX_SLOPE)
    steepness = max(float(np.abs(slopes).max()), 1e-3)
    data[2:] = slopes * (127.5 / steepness) + 128.0
    ramp = np.vstack([mean + axes @ low, axes.T * span[:, None]]) / 255
    return PackedMap(size, data.T.tobytes(), ramp.astype(np.float32), steepness)


def _bytes(path: Path) -> tuple[tuple[int, int], Bytes]:
    """Size (width, height) and RGBA pixels (n, 4) of an image file, the bottom row first."""
    size, data = pixels(path)
    return size, np.frombuffer(data, np.uint8).reshape(-1, 4)
