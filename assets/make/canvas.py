"""What every texture is painted with."""

import numpy as np

from make.shapes import Array

Texture = tuple[Array, Array | None]
"""Colours (size, size, 3 or 4) in 0..1, the top row first; and heights (size, size) in widths of a pixel."""


def mix(dark: tuple[float, ...], light: tuple[float, ...], share: Array) -> Array:
    """Colours between two, by a field from 0 to 1."""
    return np.asarray(np.asarray(dark) + (np.asarray(light) - np.asarray(dark)) * share[..., None])


def pixels(size: int) -> tuple[Array, Array]:
    """Row and column of each pixel's middle, from 0 to 1."""
    position = (np.arange(size) + 0.5) / size
    down, across = np.meshgrid(position, position, indexing="ij")
    return down, across


def normal_map(relief: Array) -> Array:
    """Colours of the normals of a height field that tiles: red to the right, green up, blue out of the surface."""
    right = (np.roll(relief, -1, axis=1) - np.roll(relief, 1, axis=1)) / 2
    up = (np.roll(relief, 1, axis=0) - np.roll(relief, -1, axis=0)) / 2
    normal = np.dstack([-right, -up, np.ones_like(relief)])
    return np.asarray(0.5 + 0.5 * normal / np.linalg.norm(normal, axis=2, keepdims=True))
