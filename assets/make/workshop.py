"""Textures of what people make. All tile, but for the test card."""

import numpy as np

from make.canvas import Texture, mix, pixels
from make.noise import cells, fractal, smoothstep


def wood(rng: np.random.Generator) -> Texture:
    """Grain that runs along u: year rings, bent around a few knots, and fine pores."""
    size = 256
    down, across = pixels(size)
    bend = 0.045 * fractal(rng, size, 2, 3, 3)
    for row, column, radius in ((0.30, 0.35, 0.07), (0.75, 0.80, 0.05)):
        away_down, away_across = (down - row + 0.5) % 1 - 0.5, (across - column + 0.5) % 1 - 0.5
        bend += (
            np.sign(away_down)
            * 0.06
            * np.exp(-(away_down**2 * 60 + away_across**2 * 25))
            * (1 - np.exp(-np.abs(away_down) / radius))
        )
    phase = (down + bend) * 9
    ring = (phase % 1) ** 2.2
    pores = fractal(rng, size, 8, 128, 2)
    streak = fractal(rng, size, 2, 32, 3)
    share = np.clip(0.90 - 0.50 * ring - 0.22 * pores * ring + 0.35 * (streak - 0.5), 0, 1)
    return mix((0.40, 0.23, 0.11), (0.88, 0.64, 0.38), share), 0.8 * share + 0.3 * pores


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


def cobbles(rng: np.random.Generator) -> Texture:
    """Rounded stones set in sand."""
    size = 512
    near, second, cell = cells(rng, size, 12, 0.65)
    stone = smoothstep(0.04, 0.22, second - near)
    grain = fractal(rng, size, 32, octaves=4)
    shade = rng.uniform(0, 1, 144)[cell]
    warm = mix((0.47, 0.45, 0.43), (0.72, 0.66, 0.57), np.clip(0.8 * shade + 0.4 * grain - 0.1, 0, 1))
    ground = mix((0.42, 0.37, 0.28), (0.56, 0.51, 0.38), grain)
    return ground + (warm - ground) * stone[..., None], 6 * stone + 1.5 * grain


def bricks(rng: np.random.Generator) -> Texture:
    """Running bond, 4 bricks by 12 courses."""
    size, across_count, down_count = 512, 4, 12
    down, across = pixels(size)
    course = np.minimum((down * down_count).astype(int), down_count - 1)
    x = across * across_count + 0.5 * (course % 2)
    column = x.astype(int) % across_count
    edge = np.minimum(
        np.minimum(x % 1, 1 - x % 1) / across_count,
        np.minimum(down * down_count % 1, 1 - down * down_count % 1) / down_count,
    )
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


def concrete(rng: np.random.Generator) -> Texture:
    """A slab of a floor, its joints at the edges: stains, fine sand, a few pores; nearly white, materials tint it."""
    size = 512
    down, across = pixels(size)
    edge = np.minimum(np.minimum(down, 1 - down), np.minimum(across, 1 - across))
    joint = smoothstep(0.0012, 0.0035, edge)
    stains, grain = fractal(rng, size, 3, octaves=6, gain=0.6), fractal(rng, size, 96, octaves=2)
    pores = smoothstep(0.86, 0.93, fractal(rng, size, 128, octaves=1))
    share = np.clip(0.25 + 0.40 * stains + 0.35 * grain - 0.25 * pores, 0, 1) * (0.3 + 0.7 * joint)
    return mix((0.62, 0.62, 0.61), (1.0, 1.0, 0.99), share), 2.0 * joint + 0.9 * grain - 0.6 * pores


def metal(rng: np.random.Generator) -> Texture:
    """Brushed along u; grey, materials tint it."""
    size = 128
    grooves = fractal(rng, size, 2, 32, 2)
    return mix((0.84, 0.84, 0.84), (1.0, 1.0, 1.0), grooves), 0.35 * grooves


def enamel(rng: np.random.Generator) -> Texture:
    """Paint or plastic, as good as smooth; white, materials tint it. Its waves are seen in highlights alone."""
    size = 128
    waves = fractal(rng, size, 5, octaves=2)
    return mix((0.97, 0.97, 0.97), (1.0, 1.0, 1.0), fractal(rng, size, 6, octaves=4)), 0.7 * waves


def panels(rng: np.random.Generator) -> Texture:
    """A moulded shell: plates with fine seams and rivets, grained; nearly white, materials tint it."""
    size = 256
    down, across = pixels(size)
    row = np.minimum((down * 3).astype(int), 2)
    column = np.minimum(((across + 0.5 / 3 * (row % 2)) % 1 * 3).astype(int), 2)
    x, y = (across + 0.5 / 3 * (row % 2)) * 3 % 1, down * 3 % 1
    edge = np.minimum(np.minimum(x, 1 - x), np.minimum(y, 1 - y))
    plate = smoothstep(0.0, 0.035, edge)
    rivet = np.zeros((size, size))
    for spot_x in (0.12, 0.5, 0.88):
        for spot_y in (0.12, 0.88):
            rivet = np.maximum(rivet, smoothstep(0.035, 0.015, np.hypot(x - spot_x, y - spot_y)))
    shade = rng.uniform(0.90, 1.0, (3, 3))[row, column]
    grain = fractal(rng, size, 32, octaves=2)
    colour = (0.70 + 0.30 * plate) * shade * (1 - 0.15 * rivet) * (0.94 + 0.06 * grain)
    return np.repeat(np.clip(colour, 0, 1)[..., None], 3, axis=2), 2.2 * plate + 1.6 * rivet + 0.7 * grain


def weave(rng: np.random.Generator) -> Texture:
    """Twill of carbon fibre; nearly white, materials tint it. Its relief is low: the threads are fine."""
    size, threads = 128, 8
    down, across = pixels(size)
    x, y = across * threads, down * threads
    warp = (x.astype(int) + y.astype(int)) % 4 < 2
    arch = np.where(warp, np.sin(np.pi * (x % 1)), np.sin(np.pi * (y % 1)))
    share = np.clip(np.where(warp, 0.75, 0.50) * (0.6 + 0.4 * arch) + 0.1 * fractal(rng, size, 16, octaves=2), 0, 1)
    return mix((0.70, 0.70, 0.70), (1.0, 1.0, 1.0), share), 0.55 * arch


def fabric(rng: np.random.Generator) -> Texture:
    """Twill with a trace of wrinkles; nearly white, materials tint it."""
    size, threads = 256, 32
    down, across = pixels(size)
    x, y = across * threads, down * threads
    rib = np.sin(np.pi * ((x + y) % 1))
    thread = 0.5 + 0.5 * np.sin(2 * np.pi * (x - y))
    wrinkles = fractal(rng, size, 3, 5, 3)
    share = np.clip(0.35 + 0.30 * rib + 0.12 * thread + 0.4 * (wrinkles - 0.5), 0, 1)
    return mix((0.74, 0.74, 0.74), (1.0, 1.0, 1.0), share), 0.30 * rib + 6.0 * wrinkles


def hair(rng: np.random.Generator) -> Texture:
    """Strands that run along v; nearly white, materials tint it."""
    size = 128
    strands = fractal(rng, size, 32, 2, 2)
    return mix((0.55, 0.55, 0.55), (1.0, 1.0, 1.0), strands), 1.6 * strands


def test_card(rng: np.random.Generator) -> Texture:
    """What the television shows: colour bars in a circle on a grid, with a grey scale, and lines of the tube."""
    size = 256
    down, across = pixels(size)
    x, y = (across - 0.5) * 4 / 3, down - 0.5
    colour = np.full((size, size, 3), 0.36)
    grid = (np.abs(x * 9 % 1 - 0.5) > 0.46) | (np.abs((y * 9 + 0.5) % 1 - 0.5) > 0.46)
    colour[grid] = 0.88
    inside = x**2 + y**2 < 0.43**2
    bars = np.array(
        [
            [0.9, 0.9, 0.9],
            [0.9, 0.9, 0.1],
            [0.1, 0.9, 0.9],
            [0.1, 0.85, 0.1],
            [0.9, 0.1, 0.9],
            [0.9, 0.1, 0.1],
            [0.1, 0.1, 0.9],
        ]
    )
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
    return colour * (lines * vignette)[..., None], 0.25 * np.cos(2 * np.pi * 64 * down) + 0.6 * fractal(rng, size, 4)
