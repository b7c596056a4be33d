"""Noise that tiles: every field repeats at its edges."""

import numpy as np

from make.shapes import Array


def value_noise(rng: np.random.Generator, size: int, across: int, down: int | None = None) -> Array:
    """Smooth noise in 0..1, (size, size), with `across` times `down` cells."""
    down = down or across
    lattice = rng.random((down, across))
    rows, row_part = _cells(size, down)
    columns, column_part = _cells(size, across)
    top, bottom = (lattice[(rows + k) % down] for k in (0, 1))
    band = top + (bottom - top) * row_part[:, None]
    left, right = (band[:, (columns + k) % across] for k in (0, 1))
    return np.asarray(left + (right - left) * column_part)


def fractal(
    rng: np.random.Generator, size: int, across: int, down: int | None = None, octaves: int = 4, gain: float = 0.5
) -> Array:
    """Octaves of value noise, each twice as fine and `gain` as strong as the one before; stretched to 0..1."""
    down = down or across
    total = np.zeros((size, size))
    for octave in range(octaves):
        if max(across, down) << octave <= size:
            total += gain**octave * value_noise(rng, size, across << octave, down << octave)
    return stretched(total)


def cells(rng: np.random.Generator, size: int, across: int, jitter: float = 0.8) -> tuple[Array, Array, Array]:
    """Worley cells: distance to the nearest point, to the second nearest (in cells), and the nearest one's index."""
    offsets = 0.5 + (rng.random((across, across, 2)) - 0.5) * jitter
    position = (np.arange(size) + 0.5) * across / size
    y, x = np.meshgrid(position, position, indexing="ij")
    cell_y, cell_x = y.astype(int), x.astype(int)
    distances, indices = [], []
    for step_y in (-1, 0, 1):
        for step_x in (-1, 0, 1):
            row, column = (cell_y + step_y) % across, (cell_x + step_x) % across
            point = offsets[row, column]
            distances.append(
                np.sqrt((cell_y + step_y + point[..., 0] - y) ** 2 + (cell_x + step_x + point[..., 1] - x) ** 2)
            )
            indices.append(row * across + column)
    order = np.argsort(distances, axis=0, kind="stable")
    ranked = np.take_along_axis(np.array(distances), order, axis=0)
    nearest = np.take_along_axis(np.array(indices), order[:1], axis=0)[0]
    return ranked[0], ranked[1], nearest


def stretched(field: Array) -> Array:
    """The same field from 0 to 1."""
    return np.asarray((field - field.min()) / np.ptp(field))


def smoothstep(low: float, high: float, value: Array) -> Array:
    """0 below low, 1 above high, an S between."""
    part = np.clip((value - low) / (high - low), 0, 1)
    return np.asarray(part * part * (3 - 2 * part))


def _cells(size: int, count: int) -> tuple[np.ndarray, Array]:
    """Which cell each pixel lies in, and how far in, smoothed."""
    position = np.arange(size) * count / size
    cell = position.astype(int)
    return cell, smoothstep(0, 1, position - cell)
