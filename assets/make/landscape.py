"""Textures of land and sky. All tile, unless they say otherwise."""

import numpy as np

from make.canvas import Texture, mix, pixels
from make.noise import cells, fractal, smoothstep
from make.shapes import Array

GRASS = ((0.24, 0.38, 0.12), (0.62, 0.68, 0.30))
SAND = ((0.80, 0.70, 0.51), (0.93, 0.86, 0.69))


def grass(rng: np.random.Generator) -> Texture:
    """A meadow: patches, tufts and blades, with a few daisies."""
    size = 512
    share, blades = _meadow(rng, size)
    colour = mix(GRASS[0], GRASS[1], share)
    near, _, cell = cells(rng, size, 24, 0.9)
    bloom = (near < 0.07) & (rng.random(24 * 24) < 0.10)[cell]
    colour[bloom] = (0.95, 0.93, 0.80)
    return colour, 3 * blades


def sand(rng: np.random.Generator) -> Texture:
    """Grains and low ripples."""
    size = 256
    share, ripples = _beach(rng, size)
    return mix(SAND[0], SAND[1], share), 2.0 * ripples


def shore(rng: np.random.Generator) -> Texture:
    """Where the meadow ends: sand below, grass above; tiles sideways only."""
    size = 512
    down, _ = pixels(size)
    meadow, _ = _meadow(rng, size)
    beach, _ = _beach(rng, size)
    edge = 1 - down + 0.55 * (fractal(rng, size, 6, 6, 5, 0.6) - 0.5)
    cover = smoothstep(0.42, 0.56, edge)
    cover = np.where(down < 0.05, 1.0, np.where(down > 0.95, 0.0, cover))
    both = mix(SAND[0], SAND[1], beach), mix(GRASS[0], GRASS[1], meadow)
    ripples = _relief(rng, size)
    return both[0] + (both[1] - both[0]) * cover[..., None], ripples


def path(rng: np.random.Generator) -> Texture:
    """Trodden gravel between two fringes of grass; runs along v, and tiles that way only."""
    size = 256
    _, across = pixels(size)
    meadow, _ = _meadow(rng, size)
    pebbles, second, cell = cells(rng, size, 28, 0.9)
    grain = fractal(rng, size, 32, octaves=3)
    shade = np.clip(0.5 * rng.uniform(0, 1, 784)[cell] + 0.4 * grain + 0.3 * (second - pebbles), 0, 1)
    gravel = mix((0.50, 0.42, 0.30), (0.80, 0.72, 0.57), shade)
    ruts = np.abs(np.abs(across - 0.5) - 0.17)
    gravel = gravel * (0.90 + 0.10 * smoothstep(0.0, 0.10, ruts))[..., None]
    edge = np.abs(across - 0.5) * 2 + 0.30 * (fractal(rng, size, 4, 8, 5, 0.6) - 0.5)
    cover = np.maximum(smoothstep(0.70, 0.86, edge), smoothstep(0.90, 0.97, np.abs(across - 0.5) * 2))
    stones = 3 * smoothstep(0.0, 0.35, second - pebbles) * (1 - cover) + 2 * fractal(rng, size, 32, octaves=2) * cover
    return gravel + (mix(GRASS[0], GRASS[1], meadow) - gravel) * cover[..., None], stones


def bark(rng: np.random.Generator) -> Texture:
    """Ridges that run along v, broken across."""
    size = 256
    ridge = fractal(rng, size, 12, 3, 4, 0.6)
    scale = fractal(rng, size, 4, 24, 3)
    share = np.clip(0.75 * ridge + 0.35 * scale - 0.05, 0, 1)
    return mix((0.24, 0.17, 0.12), (0.62, 0.49, 0.37), share), 8 * share


def clouds(rng: np.random.Generator) -> Texture:
    """Fair-weather clouds; white and grey where thick, alpha is the cover."""
    size = 512
    base = fractal(rng, size, 6, octaves=7, gain=0.55)
    billow = fractal(rng, size, 12, octaves=5, gain=0.5)
    cover = smoothstep(0.47, 0.75, 0.75 * base + 0.25 * billow)
    shade = smoothstep(0.55, 0.95, base)
    return np.dstack([mix((1.0, 1.0, 1.0), (0.84, 0.87, 0.92), shade), cover]), None


def horizon(rng: np.random.Generator) -> Texture:
    """The sky's colours: from the horizon below to the zenith above, from night at the left to day at the right."""
    size = 64
    down, across = pixels(size)
    rise = 1 - down
    times = (0.0, 0.22, 0.45, 1.0)
    night = ((0.055, 0.075, 0.135), (0.030, 0.045, 0.100), (0.012, 0.018, 0.055))
    dusk = ((0.42, 0.24, 0.26), (0.20, 0.16, 0.30), (0.05, 0.07, 0.19))
    low = ((0.98, 0.66, 0.42), (0.74, 0.58, 0.58), (0.24, 0.34, 0.58))
    day = ((0.76, 0.86, 0.94), (0.46, 0.65, 0.88), (0.20, 0.42, 0.77))
    steps = np.array([[np.interp(rise[:, 0], (0.0, 0.45, 1.0), [colour[i] for colour in time]) for i in range(3)]
                      for time in (night, dusk, low, day)])
    colour = np.stack([[np.interp(across[row], times, steps[:, i, row]) for i in range(3)] for row in range(size)])
    return np.moveaxis(colour, 1, 2), None


def stars(rng: np.random.Generator) -> Texture:
    """A clear night: many faint stars, a few bright ones, and a band of haze."""
    size = 512
    down, across = pixels(size)
    haze = fractal(rng, size, 4, octaves=6, gain=0.6) * (0.5 + 0.5 * np.cos(2 * np.pi * (down + across))) ** 3
    colour = mix((0.0, 0.0, 0.0), (0.16, 0.17, 0.24), haze)
    for _ in range(900):
        row, column = rng.integers(0, size, 2)
        bright = 0.25 + 0.75 * rng.random() ** 5
        tint = mix((1.0, 0.82, 0.66), (0.78, 0.88, 1.0), rng.random(1))[0]
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                spot = bright * np.exp(-1.3 * (i * i + j * j) / (0.35 + bright))
                colour[(row + i) % size, (column + j) % size] += spot * tint
    return np.minimum(colour, 1.0), None


def _relief(rng: np.random.Generator, size: int) -> Array:
    """Tufts and ripples, low."""
    return 2.5 * fractal(rng, size, 24, octaves=3)


def _meadow(rng: np.random.Generator, size: int) -> tuple[Array, Array]:
    """How light the grass is, and how high."""
    patches = fractal(rng, size, 3, octaves=4, gain=0.6)
    tufts = fractal(rng, size, 32, octaves=2)
    blades = fractal(rng, size, 128, 64, 2)
    return np.clip(0.36 * patches + 0.30 * tufts + 0.42 * blades - 0.08, 0, 1), 0.5 * tufts + blades


def _beach(rng: np.random.Generator, size: int) -> tuple[Array, Array]:
    """How light the sand is, and how high."""
    down, across = pixels(size)
    bend = fractal(rng, size, 3, octaves=3)
    ripples = 0.5 + 0.5 * np.sin(2 * np.pi * (7 * down + 2 * across + 1.2 * bend))
    grains = fractal(rng, size, 64, octaves=2)
    return np.clip(0.25 * ripples + 0.45 * grains + 0.35 * bend, 0, 1), ripples + 0.6 * grains
