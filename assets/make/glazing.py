"""Panes, lenses and lamps: one texture with a cell for each, and what maps a part into a cell."""

from dataclasses import replace

import numpy as np

from make.canvas import Texture, mix, pixels
from make.noise import fractal, smoothstep
from make.shapes import Array, Part

Cell = tuple[Array, Array]  # colours and heights, as in a texture
CELLS = {"window": (0.0, 0.5), "lit": (0.5, 0.5), "plain": (0.0, 0.0), "lens": (0.5, 0.0)}  # uv of the lower left
MARGIN = 0.012  # of a cell, so that its neighbours do not shine in when it is drawn small

DARK, SKY = (0.055, 0.085, 0.12), (0.34, 0.46, 0.60)  # of glass: what it shows of the room, and of the sky


def glazed(part: Part, cell: str) -> Part:
    """A part whose texture coordinates fill one cell of the texture 'glass'."""
    low, high = part.uv.min(axis=(0, 1)), part.uv.max(axis=(0, 1))
    share = MARGIN + (1 - 2 * MARGIN) * (part.uv - low) / np.maximum(high - low, 1e-9)
    return replace(part, uv=np.asarray(CELLS[cell]) + 0.5 * share)


def glass(rng: np.random.Generator) -> Texture:
    """Above a window by day and one with the lamp lit, below plain glass and a lens of ringed prisms."""
    size = 256
    upper, lower = (_window(rng, size), _lit(rng, size)), (_plain(rng, size), _lens(rng, size))
    colour, relief = (np.vstack([np.hstack([left[k], right[k]]) for left, right in (upper, lower)]) for k in (0, 1))
    return colour, relief


def _reflection(rng: np.random.Generator, size: int) -> tuple[Array, Array]:
    """How much of the sky old glass shows, and its waves."""
    down, across = pixels(size)
    clouds = fractal(rng, size, 2, 3, 4)
    slant = (across + 0.7 * down) % 1
    broad, narrow = (smoothstep(0.12, 0.10, np.abs(slant - 0.30)), smoothstep(0.05, 0.03, np.abs(slant - 0.55)))
    streak = broad + 0.6 * narrow
    share = np.clip(0.62 - 0.60 * down + 0.30 * (clouds - 0.5) + 0.16 * streak, 0, 1)
    return share, 4.0 * fractal(rng, size, 3, 4, 2)


def _curtains(size: int) -> tuple[Array, Array]:
    """How much curtains cover, drawn aside and with a pelmet, and the light on their folds."""
    down, across = pixels(size)
    side = np.abs(across - 0.5) * 2
    hem = 0.70 - 0.22 * np.sin(np.pi * np.clip(down, 0, 0.75) / 0.75) ** 2 + 0.08 * down
    pelmet = smoothstep(0.13, 0.11, down + 0.012 * np.cos(90 * across))
    cover = np.maximum(smoothstep(0.0, 0.03, side - hem), pelmet)
    return cover, 0.72 + 0.28 * np.sin(2 * np.pi * 13 * across) * np.sin(np.pi * across)


def _window(rng: np.random.Generator, size: int) -> Cell:
    """A dark room behind glass: curtains, and a plant on the sill."""
    down, across = pixels(size)
    share, waves = _reflection(rng, size)
    cover, folds = _curtains(size)
    room = np.broadcast_to(np.array(DARK), (size, size, 3)).copy()
    leaf = np.hypot((across - 0.62) * 1.5, down - 0.82) + 0.10 * fractal(rng, size, 12, octaves=2) < 0.17
    room[leaf] = (0.08, 0.26, 0.08)
    room[(np.abs(across - 0.62) < 0.055) & (down > 0.88)] = (0.34, 0.16, 0.10)
    room += (np.array([0.50, 0.30, 0.32]) * folds[..., None] - room) * cover[..., None]
    colour = room + (np.array(SKY) - room) * (0.75 * share)[..., None]
    return colour * _shade(size)[..., None], waves


def _lit(rng: np.random.Generator, size: int) -> Cell:
    """The same with a lamp on: a warm wall, a lamp with its shade, curtains."""
    down, across = pixels(size)
    share, waves = _reflection(rng, size)
    cover, folds = _curtains(size)
    glow = np.exp(-5.0 * np.hypot(across - 0.40, 1.1 * (down - 0.55)))
    room = mix((0.20, 0.13, 0.07), (0.86, 0.62, 0.30), np.clip(0.15 + 1.1 * glow, 0, 1))
    lamp = (np.abs(across - 0.40) < 0.055 + 0.16 * (down - 0.44)) & (down > 0.44) & (down < 0.62)
    room[lamp] = (1.0, 0.90, 0.62)
    room[(np.abs(across - 0.40) < 0.012) & (down >= 0.62) & (down < 0.82)] = (0.16, 0.10, 0.06)
    room[(down > 0.82) & (np.abs(across - 0.42) < 0.30)] = (0.13, 0.075, 0.04)
    curtain = np.array([0.66, 0.16, 0.16]) * (folds * (0.45 + 0.55 * glow))[..., None]
    room += (curtain - room) * cover[..., None]
    colour = room + (np.array(SKY) - room) * (0.40 * share)[..., None]
    return colour * _shade(size)[..., None], waves


def _plain(rng: np.random.Generator, size: int) -> Cell:
    share, waves = _reflection(rng, size)
    return mix(DARK, SKY, 0.9 * share), waves


def _lens(rng: np.random.Generator, size: int) -> Cell:
    """Prisms lie in rings above and below a bull's eye; nearly white, materials tint it."""
    down, across = pixels(size)
    away = np.abs(down - 0.5) * 2
    prism = np.where(away < 0.30, np.sqrt(np.maximum(1 - (away / 0.30) ** 2, 0)), (away * 10) % 1)
    pillar = smoothstep(0.0, 0.03, np.abs((across * 8) % 1 - 0.5))
    share = np.clip((0.35 + 0.65 * prism) * (0.55 + 0.45 * np.exp(-3 * away**2)) * (0.7 + 0.3 * pillar), 0, 1)
    return mix((0.30, 0.36, 0.42), (1.0, 1.0, 0.97), share), 6 * prism + fractal(rng, size, 8, octaves=2)


def _shade(size: int) -> Array:
    """The frame's shadow along the upper edge and the sides."""
    down, across = pixels(size)
    edge = np.minimum(down, np.minimum(across, 1 - across))
    return 0.55 + 0.45 * smoothstep(0.0, 0.06, edge)
