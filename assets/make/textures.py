"""Textures and their normal maps, from noise and geometry. Each maker returns colours and, if it has one, a relief."""

import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

from make.noise import cells, fractal, smoothstep, value_noise
from make.shapes import Array

Texture = tuple[Array, Array | None]  # (size, size, 3 or 4) in 0..1, row 0 at the top; (size, size) in pixels' widths

GRASS = ((0.26, 0.40, 0.13), (0.50, 0.60, 0.24))
SAND = ((0.80, 0.70, 0.51), (0.93, 0.86, 0.69))


def mix(dark: tuple[float, ...], light: tuple[float, ...], share: Array) -> Array:
    """Colours between two, by a field from 0 to 1."""
    return np.asarray(np.asarray(dark) + (np.asarray(light) - np.asarray(dark)) * share[..., None])


def pixels(size: int) -> tuple[Array, Array]:
    """Row and column of each pixel's middle, from 0 to 1."""
    position = (np.arange(size) + 0.5) / size
    down, across = np.meshgrid(position, position, indexing="ij")
    return down, across


def wood(rng: np.random.Generator) -> Texture:
    """Grain that runs along u: year rings, bent around a few knots, and fine pores."""
    size = 256
    down, across = pixels(size)
    bend = 0.10 * fractal(rng, size, 2, 3, 3)
    for row, column, radius in ((0.30, 0.35, 0.07), (0.75, 0.80, 0.05)):
        away_down, away_across = (down - row + 0.5) % 1 - 0.5, (across - column + 0.5) % 1 - 0.5
        bend += np.sign(away_down) * 0.06 * np.exp(-(away_down**2 * 60 + away_across**2 * 25)) * (
            1 - np.exp(-np.abs(away_down) / radius))
    phase = (down + bend) * 9
    ring = (phase % 1) ** 2.2
    pores = fractal(rng, size, 8, 128, 2)
    streak = fractal(rng, size, 2, 32, 3)
    share = np.clip(0.90 - 0.50 * ring - 0.22 * pores * ring + 0.35 * (streak - 0.5), 0, 1)
    return mix((0.36, 0.19, 0.08), (0.86, 0.61, 0.34), share), 1.6 * share + 0.4 * pores


def planks(rng: np.random.Generator) -> Texture:
    """Five boards side by side; they run along v."""
    size, count = 256, 5
    _, across = pixels(size)
    board = np.minimum((across * count).astype(int), count - 1)
    place = across * count - board
    grain = fractal(rng, size, 64, 2, 3)
    rings = fractal(rng, size, 16, 3, 3)
    shade = rng.uniform(-0.16, 0.16, count)[board]
    gap = smoothstep(0.0, 0.05, np.minimum(place, 1 - place))
    share = np.clip(0.58 + shade + 0.5 * (grain - 0.5) + 0.45 * (rings - 0.5), 0, 1)
    colour = mix((0.40, 0.28, 0.17), (0.86, 0.70, 0.50), share) * (0.35 + 0.65 * gap[..., None])
    return colour, 4 * gap + 1.2 * grain


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
    return both[0] + (both[1] - both[0]) * cover[..., None], None


def cobbles(rng: np.random.Generator) -> Texture:
    """Rounded stones set in sand."""
    size = 512
    near, second, cell = cells(rng, size, 9, 0.65)
    stone = smoothstep(0.04, 0.22, second - near)
    grain = fractal(rng, size, 32, octaves=4)
    shade = rng.uniform(0, 1, 81)[cell]
    warm = mix((0.50, 0.49, 0.47), (0.76, 0.71, 0.63), np.clip(0.6 * shade + 0.5 * grain - 0.05, 0, 1))
    ground = mix((0.42, 0.37, 0.28), (0.56, 0.51, 0.38), grain)
    return ground + (warm - ground) * stone[..., None], 9 * stone + 1.5 * grain


def bricks(rng: np.random.Generator) -> Texture:
    """Running bond, 4 bricks by 12 courses."""
    size, across_count, down_count = 512, 4, 12
    down, across = pixels(size)
    course = np.minimum((down * down_count).astype(int), down_count - 1)
    x = across * across_count + 0.5 * (course % 2)
    column = x.astype(int) % across_count
    edge = np.minimum(np.minimum(x % 1, 1 - x % 1) / across_count,
                      np.minimum(down * down_count % 1, 1 - down * down_count % 1) / down_count)
    edge = edge + 0.004 * (fractal(rng, size, 32, octaves=3) - 0.5)
    face = smoothstep(0.006, 0.012, edge)
    grain = fractal(rng, size, 24, 48, 4, 0.6)
    shade = rng.uniform(0, 1, (down_count, across_count))[course, column]
    clay = mix((0.46, 0.19, 0.13), (0.79, 0.43, 0.30), np.clip(0.75 * shade + 0.5 * grain - 0.15, 0, 1))
    mortar = mix((0.70, 0.67, 0.61), (0.84, 0.81, 0.75), grain)
    return mortar + (clay - mortar) * face[..., None], 5 * face + 1.5 * grain


def roof_tiles(rng: np.random.Generator) -> Texture:
    """Rows of rounded clay tiles, each row over the one below; v runs up the roof."""
    size, count = 256, 8
    down, across = pixels(size)
    row = np.minimum((down * count).astype(int), count - 1)
    place = down * count - row
    x = across * count + 0.5 * (row % 2)
    column = x.astype(int) % count
    side = (x % 1) * 2 - 1
    lower_edge = 1 - 0.28 * side**2
    overlap = place > lower_edge
    row, column = np.where(overlap, (row + 1) % count, row), np.where(overlap, (column + (row % 2)) % count, column)
    grain = fractal(rng, size, 16, octaves=4)
    shade = rng.uniform(0, 1, (count, count))[row, column]
    gap = np.where(overlap, 1, smoothstep(0.0, 0.12, 1 - np.abs(side)))
    depth = np.where(overlap, smoothstep(0.0, 0.3, place - lower_edge), 0.45 + 0.55 * place)
    colour = mix((0.50, 0.20, 0.13), (0.86, 0.47, 0.31), np.clip(0.7 * shade + 0.45 * grain - 0.1, 0, 1))
    colour = colour * (0.55 + 0.45 * np.minimum(gap, 0.3 + 0.7 * depth))[..., None]
    return colour, 5 * np.where(overlap, 0.0, 0.3 + 0.7 * place) * (1 - 0.4 * side**2) + grain


def plaster(rng: np.random.Generator) -> Texture:
    """Rough render with traces of the trowel; nearly white, materials tint it."""
    size = 256
    coarse, fine = fractal(rng, size, 4, octaves=5, gain=0.6), fractal(rng, size, 48, octaves=3)
    return mix((0.80, 0.79, 0.77), (1.0, 1.0, 0.99), np.clip(0.55 * coarse + 0.5 * fine, 0, 1)), 2 * coarse + 2 * fine


def rock(rng: np.random.Generator) -> Texture:
    """Layered stone with cracks and lichen."""
    size = 256
    base = fractal(rng, size, 4, 8, 6, 0.6)
    near, second, _ = cells(rng, size, 5, 1.0)
    crack = smoothstep(0.0, 0.10, second - near + 0.12 * (fractal(rng, size, 16, octaves=3) - 0.5))
    lichen = smoothstep(0.62, 0.80, fractal(rng, size, 6, octaves=5, gain=0.6))
    colour = mix((0.38, 0.37, 0.36), (0.74, 0.71, 0.66), base) * (0.72 + 0.28 * crack)[..., None]
    colour += (np.array([0.56, 0.57, 0.38]) - colour) * 0.45 * lichen[..., None]
    return colour, 7 * base + 3 * crack


def bark(rng: np.random.Generator) -> Texture:
    """Ridges that run along v, broken across."""
    size = 256
    ridge = fractal(rng, size, 12, 3, 4, 0.6)
    scale = fractal(rng, size, 4, 24, 3)
    share = np.clip(0.75 * ridge + 0.35 * scale - 0.05, 0, 1)
    return mix((0.24, 0.17, 0.12), (0.62, 0.49, 0.37), share), 8 * share


def leaves(rng: np.random.Generator) -> Texture:
    """Foliage as a heap of small leaves, dark between them."""
    size = 256
    total, top = np.zeros((size, size)), np.zeros((size, size))
    for across in (9, 13, 18):
        near, second, cell = cells(rng, size, across, 1.0)
        shade = rng.uniform(0.2, 1, across * across)[cell]
        leaf = smoothstep(0.0, 0.5, second - near) * shade
        total = np.where(leaf > top, shade * (0.55 + 0.45 * smoothstep(0, 0.4, second - near)), total)
        top = np.maximum(top, leaf)
    return mix((0.07, 0.17, 0.06), (0.56, 0.70, 0.30), np.clip(total, 0, 1)), None


def frond(rng: np.random.Generator) -> Texture:
    """One palm leaf from its stalk (left) to its tip: leaflets slanting from the rib."""
    size = 256
    down, across = pixels(size)
    side = np.abs(down - 0.5) * 2
    slant = (across - 0.22 * side) * 34
    groove = np.abs(slant % 1 - 0.5) * 2
    rib = smoothstep(0.10, 0.03, side)
    share = np.clip(0.25 + 0.45 * groove + 0.30 * value_noise(rng, size, 34, 2) - 0.12 * side, 0, 1)
    colour = mix((0.10, 0.27, 0.07), (0.55, 0.70, 0.26), share)
    return colour + (np.array([0.72, 0.74, 0.42]) - colour) * rib[..., None], None


def metal(rng: np.random.Generator) -> Texture:
    """Brushed along u; grey, materials tint it."""
    size = 128
    return mix((0.74, 0.74, 0.74), (1.0, 1.0, 1.0), fractal(rng, size, 2, 64, 2)), None


def fabric(rng: np.random.Generator) -> Texture:
    """Plain weave; nearly white, materials tint it."""
    size, threads = 128, 16
    down, across = pixels(size)
    x, y = across * threads, down * threads
    over = (x.astype(int) + y.astype(int)) % 2 == 0
    warp, weft = np.sin(np.pi * (x % 1)), np.sin(np.pi * (y % 1))
    height = np.where(over, warp, weft)
    share = np.clip(0.25 + 0.6 * height + 0.3 * (fractal(rng, size, 16, octaves=3) - 0.5), 0, 1)
    return mix((0.62, 0.62, 0.62), (1.0, 1.0, 1.0), share), 1.8 * height


def test_card(rng: np.random.Generator) -> Texture:
    """What the television shows: colour bars in a circle on a grid, with a grey scale, and lines of the tube."""
    size = 256
    down, across = pixels(size)
    x, y = (across - 0.5) * 4 / 3, down - 0.5
    colour = np.full((size, size, 3), 0.36)
    grid = (np.abs(x * 9 % 1 - 0.5) > 0.46) | (np.abs((y * 9 + 0.5) % 1 - 0.5) > 0.46)
    colour[grid] = 0.88
    inside = x**2 + y**2 < 0.43**2
    bars = np.array([[0.9, 0.9, 0.9], [0.9, 0.9, 0.1], [0.1, 0.9, 0.9], [0.1, 0.85, 0.1], [0.9, 0.1, 0.9],
                     [0.9, 0.1, 0.1], [0.1, 0.1, 0.9]])
    steps = np.clip(((x + 0.43) / 0.86 * 7).astype(int), 0, 6)
    colour[inside & (y < 0.06)] = bars[steps][inside & (y < 0.06)]
    grey = inside & (y >= 0.06) & (y < 0.20)
    colour[grey] = (np.clip(((x + 0.43) / 0.86 * 6).astype(int), 0, 5) / 5)[grey][:, None]
    low = inside & (y >= 0.20)
    colour[low] = np.where((x * 24 % 1 > 0.5)[low][:, None], (0.93, 0.30, 0.16), (0.98, 0.86, 0.62))
    ring = np.abs(np.sqrt(x**2 + y**2) - 0.43) < 0.008
    colour[ring] = 0.97
    colour[(np.abs(x) < 0.004) & inside & (y < 0.06)] = 0.05
    lines = 0.90 + 0.10 * np.cos(2 * np.pi * 64 * down)
    vignette = 1 - 0.9 * np.clip(np.maximum(np.abs(across - 0.5), np.abs(down - 0.5)) - 0.36, 0, 1) ** 1.2
    return colour * (lines * vignette)[..., None], None


def clouds(rng: np.random.Generator) -> Texture:
    """Fair-weather clouds; white and grey where thick, alpha is the cover."""
    size = 512
    base = fractal(rng, size, 4, octaves=7, gain=0.55)
    billow = fractal(rng, size, 8, octaves=5, gain=0.5)
    cover = smoothstep(0.50, 0.78, 0.75 * base + 0.25 * billow)
    shade = smoothstep(0.55, 0.95, base)
    return np.dstack([mix((1.0, 1.0, 1.0), (0.84, 0.87, 0.92), shade), cover]), None


def _meadow(rng: np.random.Generator, size: int) -> tuple[Array, Array]:
    """How light the grass is, and how high."""
    patches = fractal(rng, size, 4, octaves=3)
    tufts = fractal(rng, size, 32, octaves=2)
    blades = fractal(rng, size, 128, 64, 2)
    return np.clip(0.30 * patches + 0.35 * tufts + 0.45 * blades - 0.08, 0, 1), 0.5 * tufts + blades


def _beach(rng: np.random.Generator, size: int) -> tuple[Array, Array]:
    """How light the sand is, and how high."""
    down, across = pixels(size)
    bend = fractal(rng, size, 3, octaves=3)
    ripples = 0.5 + 0.5 * np.sin(2 * np.pi * (7 * down + 2 * across + 1.2 * bend))
    grains = fractal(rng, size, 64, octaves=2)
    return np.clip(0.25 * ripples + 0.45 * grains + 0.35 * bend, 0, 1), ripples + 0.6 * grains


MAKERS: dict[str, Callable[[np.random.Generator], Texture]] = {
    maker.__name__: maker for maker in (wood, planks, grass, sand, shore, cobbles, bricks, roof_tiles, plaster, rock,
                                        bark, leaves, frond, metal, fabric, test_card, clouds)}


def write_texture(name: str, folder: Path) -> list[Path]:
    """Writes <name>.png and, if it has a relief, <name>_normal.png (tangent space, y up)."""
    colour, relief = MAKERS[name](np.random.default_rng(zlib.crc32(name.encode())))
    images = {name: colour} | ({} if relief is None else {f"{name}_normal": normal_map(relief)})
    for key, image in images.items():
        levels = np.round(np.clip(image, 0, 1) * 255).astype(np.uint8)
        Image.fromarray(levels).save(folder / f"{key}.png", optimize=True)
    return [folder / f"{key}.png" for key in images]


def normal_map(relief: Array) -> Array:
    """Colours of the normals of a height field that tiles: red to the right, green up, blue out of the surface."""
    right = (np.roll(relief, -1, axis=1) - np.roll(relief, 1, axis=1)) / 2
    up = (np.roll(relief, 1, axis=0) - np.roll(relief, -1, axis=0)) / 2
    normal = np.dstack([-right, -up, np.ones_like(relief)])
    return np.asarray(0.5 + 0.5 * normal / np.linalg.norm(normal, axis=2, keepdims=True))
