"""Textures of land and sky. All tile, unless they say otherwise."""

import numpy as np

from make.canvas import Texture, mix, pixels
from make.noise import cells, fractal, smoothstep
from make.shapes import Array

GRASS = ((0.17, 0.28, 0.09), (0.55, 0.63, 0.27))
SAND = ((0.56, 0.48, 0.35), (0.80, 0.73, 0.58))
BLADES = 130_000  # strokes on a texture of a thousand pixels
LEVELS = 32  # of what is as good as noise; finer ones only make files larger


def grass(rng: np.random.Generator) -> Texture:
    """A meadow, blade by blade, with a few daisies."""
    size = 1024
    share, blades = _meadow(rng, size)
    colour = mix(GRASS[0], GRASS[1], share)
    near, _, cell = cells(rng, size, 26, 0.9)
    bloom, heart = (near < 0.075) & (rng.random(26 * 26) < 0.07)[cell], near < 0.028
    colour[bloom] = (0.80, 0.78, 0.70)
    colour[bloom & heart] = (0.75, 0.60, 0.18)
    return colour, 1.7 * blades + 1.5 * bloom


def sand(rng: np.random.Generator) -> Texture:
    """Grains, a few shells, faint ripples."""
    size = 512
    down, across = pixels(size)
    share, grains = _grains(rng, size)
    bend = fractal(rng, size, 3, octaves=3)
    ripples = 0.5 + 0.5 * np.sin(2 * np.pi * (9 * down + 2 * across + 1.3 * bend))
    near, _, cell = cells(rng, size, 18, 0.9)
    shell = smoothstep(0.11, 0.07, near) * (rng.random(324) < 0.06)[cell]
    colour = mix(SAND[0], SAND[1], share)
    colour += (np.array([0.82, 0.77, 0.70]) - colour) * 0.8 * shell[..., None]
    return colour, grains + 1.6 * ripples + 2.0 * shell


def shore(rng: np.random.Generator) -> Texture:
    """Where the meadow ends: sand below, grass above; tiles sideways only."""
    size = 1024
    down, _ = pixels(size)
    meadow, blades = _meadow(rng, size)
    beach, grains = _grains(rng, size)
    edge = 1 - down + 0.55 * (fractal(rng, size, 6, 6, 6, 0.6) - 0.5) + 0.10 * (blades - 0.5)
    cover = smoothstep(0.44, 0.54, edge)
    cover = np.where(down < 0.05, 1.0, np.where(down > 0.95, 0.0, cover))
    both = mix(SAND[0], SAND[1], beach), mix(GRASS[0], GRASS[1], meadow)
    colour = both[0] + (both[1] - both[0]) * cover[..., None]
    colour *= (1 - 0.25 * smoothstep(0.40, 0.48, edge) * (1 - cover))[..., None]
    return colour, grains + (1.7 * blades - grains) * cover


def path(rng: np.random.Generator) -> Texture:
    """Trodden gravel between two fringes of grass; runs along v, and tiles that way only."""
    size = 512
    _, across = pixels(size)
    meadow, _ = _meadow(rng, size)
    pebbles, second, cell = cells(rng, size, 36, 0.9)
    grain = fractal(rng, size, 32, octaves=3)
    shade = np.clip(0.5 * rng.uniform(0, 1, 1296)[cell] + 0.4 * grain + 0.3 * (second - pebbles), 0, 1)
    gravel = mix((0.40, 0.34, 0.25), (0.70, 0.63, 0.50), shade)
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


def _meadow(rng: np.random.Generator, size: int) -> tuple[Array, Array]:
    """How light the grass is, and how high: blades lie on each other in all directions, the later ones above."""
    patches = fractal(rng, size, 2, octaves=5, gain=0.7)
    ground = fractal(rng, size, size // 16, octaves=3)
    count = BLADES * size**2 // 1024**2
    steps = np.linspace(0, 1, 24)
    row, column = rng.uniform(0, size, (2, count, 1))
    turn, length = rng.uniform(0, 2 * np.pi, (count, 1)), rng.uniform(9, 24, (count, 1))
    bend = rng.normal(0, 0.5, (count, 1)) * steps
    i = np.round(row + length * steps * np.sin(turn + bend)).astype(int) % size
    j = np.round(column + length * steps * np.cos(turn + bend)).astype(int) % size
    rank = np.linspace(0, 1, count)[:, None]
    share, high = 0.25 * ground, 0.3 * ground
    share[i, j] = (0.20 + 0.50 * rank) * rng.uniform(0.6, 1.25, (count, 1)) * (0.70 + 0.30 * steps)
    high[i, j] = 0.2 + 0.6 * rank + 0.2 * np.sin(np.pi * steps)
    share = np.clip(share + 0.08 * (patches - 0.5) + 0.10, 0, 1)
    return np.round(share * LEVELS) / LEVELS, np.round(high * LEVELS) / LEVELS


def _grains(rng: np.random.Generator, size: int) -> tuple[Array, Array]:
    """How light the sand is, and how high."""
    grains = rng.random((size, size))
    grains = 0.5 * grains + 0.25 * (np.roll(grains, 1, axis=0) + np.roll(grains, 1, axis=1))
    lumps = fractal(rng, size, size // 16, octaves=3)
    drifts = fractal(rng, size, 6, octaves=4)
    share = 0.40 * grains + 0.30 * lumps + 0.14 * drifts + 0.10
    height = 0.8 * grains + 1.3 * lumps
    return np.round(np.clip(share, 0, 1) * LEVELS) / LEVELS, np.round(height * LEVELS) / LEVELS
