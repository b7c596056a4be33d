"""Textures of stones and of what grows. All tile but the frond, which is one leaf."""

import numpy as np

from make.canvas import Texture, mix, pixels
from make.noise import cells, fractal, smoothstep


def rock(rng: np.random.Generator) -> Texture:
    """Weathered stone: soft layers, pits, a few hair cracks, lichen. No direction stands out, so no seam does."""
    size = 512
    base = fractal(rng, size, 4, 6, 7, 0.62)
    layers = fractal(rng, size, 3, 14, 5, 0.55)
    grain = fractal(rng, size, 64, octaves=3, gain=0.7)
    vein = np.abs(fractal(rng, size, 3, octaves=5, gain=0.5) - 0.5)
    crack = (1 - smoothstep(0.0, 0.010, vein)) * smoothstep(0.50, 0.62, fractal(rng, size, 3, octaves=2))
    lichen = smoothstep(0.66, 0.80, fractal(rng, size, 7, octaves=5, gain=0.6))
    share = np.clip(0.45 * base + 0.25 * layers + 0.35 * grain - 0.05, 0, 1)
    colour = mix((0.33, 0.32, 0.31), (0.70, 0.67, 0.62), share) * (1 - 0.30 * crack)[..., None]
    colour += (np.array([0.55, 0.55, 0.40]) - colour) * 0.35 * lichen[..., None]
    return colour, 9 * base + 5 * layers + 3.0 * grain - 1.5 * crack


def needles(rng: np.random.Generator) -> Texture:
    """Twigs of a conifer that hang along -v, needle by needle: the later ones lie on the earlier ones."""
    size, twigs, each = 256, 240, 40
    share = 0.25 * fractal(rng, size, 32, octaves=2)
    height = np.zeros((size, size))
    for twig in range(twigs):
        row, column, lean = *rng.uniform(0, size, 2), rng.normal(0, 0.22)
        light = 0.25 + 0.45 * (twig / twigs) * rng.uniform(0.7, 1.3)
        for start in np.sort(rng.uniform(0, 42, each)):
            turn = lean + rng.choice((-1, 1)) * rng.uniform(0.25, 0.85)
            step = np.linspace(0, rng.uniform(9, 15), 26)
            i = np.round(row + start * np.cos(lean) + step * np.cos(turn)).astype(int) % size
            j = np.round(column + start * np.sin(lean) + step * np.sin(turn)).astype(int) % size
            share[i, j] = light * rng.uniform(0.65, 1.1) * (0.65 + 0.35 * step / step[-1]) + 0.12 * start / 42
            height[i, j] = 0.4 + 0.6 * twig / twigs + 0.25 * rng.random()
    return mix((0.07, 0.13, 0.07), (0.40, 0.54, 0.29), np.clip(share, 0, 1)), 1.6 * height


def leaves(rng: np.random.Generator) -> Texture:
    """Foliage as a heap of small leaves, each with its rib, dark between them."""
    size = 256
    total, top = np.zeros((size, size)), np.zeros((size, size))
    for across in (13, 17, 23):
        near, second, cell = cells(rng, size, across, 1.0)
        shade = rng.uniform(0.25, 1, across * across)[cell]
        leaf = smoothstep(0.0, 0.45, second - near) * shade
        total = np.where(leaf > top, shade * (0.50 + 0.50 * smoothstep(0, 0.35, second - near)), total)
        top = np.maximum(top, leaf)
    share = np.clip(total * (0.85 + 0.3 * (fractal(rng, size, 32, octaves=2) - 0.5)), 0, 1)
    return mix((0.07, 0.15, 0.05), (0.50, 0.63, 0.27), share), 3.0 * top


def frond(rng: np.random.Generator) -> Texture:
    """Leaflets of a palm, from the rib (left) to their tips; above as seen from below, below as seen from above."""
    size = 256
    down, across = pixels(size)
    half = down * 2 % 1
    groove = np.abs(half * 4 % 1 - 0.5) * 2
    fibre = fractal(rng, size, 3, 64, 2)
    share = np.clip(0.40 + 0.32 * groove + 0.30 * fibre - 0.12 * across, 0, 1)
    colour = mix((0.14, 0.30, 0.08), (0.50, 0.64, 0.24), share)
    pale = mix((0.66, 0.78, 0.40), (1.0, 1.0, 0.74), share)
    colour = np.where((down < 0.5)[..., None], pale, colour)
    dry = smoothstep(0.75, 1.0, across)[..., None] * 0.5
    rib = smoothstep(0.10, 0.03, across)[..., None] * 0.7
    colour += (np.array([0.66, 0.60, 0.30]) - colour) * np.maximum(dry, rib)
    return colour, 3.0 * groove * np.sin(np.pi * np.clip(half, 0, 1)) + 0.8 * fibre
