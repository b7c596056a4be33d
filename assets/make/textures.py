"""Writes the textures and their normal maps, the same bytes every time."""

import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

from make import faces, glazing, landscape, wild, workshop
from make.canvas import Texture, normal_map

MAKERS: dict[str, Callable[[np.random.Generator], Texture]] = {
    maker.__name__: maker
    for maker in (
        *(landscape.grass, landscape.sand, landscape.shore, landscape.path, landscape.bark),
        *(wild.rock, wild.needles, wild.leaves, wild.frond),
        *(landscape.clouds, landscape.horizon, landscape.stars),
        *(workshop.wood, workshop.planks, workshop.cobbles, workshop.bricks, workshop.roof_tiles, workshop.plaster),
        *(workshop.metal, workshop.enamel, workshop.panels, workshop.weave, workshop.fabric, workshop.hair),
        *(workshop.concrete, workshop.test_card, faces.face, glazing.glass),
    )
}


def write_texture(name: str, folder: Path) -> list[Path]:
    """Writes <name>.png and, if it has a relief, <name>_normal.png (tangent space, y up)."""
    colour, relief = MAKERS[name](np.random.default_rng(zlib.crc32(name.encode())))
    images = {name: colour} | ({} if relief is None else {f"{name}_normal": normal_map(relief)})
    for key, image in images.items():
        levels = np.round(np.clip(image, 0, 1) * 255).astype(np.uint8)
        Image.fromarray(levels).save(folder / f"{key}.png", optimize=True)
    return [folder / f"{key}.png" for key in images]
