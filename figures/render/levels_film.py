"""Films the same flight at the four collision levels, side by side: python -m figures.render.levels_film.

Writes levels.mp4 and levels.gif into docs/collision. The commands do not depend on what the drone hits.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont
from rich.progress import Progress

from drone_engine import Scene, load
from drone_engine.scene.schema import Collision
from drone_engine.world import Command, World
from drone_render.film import Film
from drone_render.renderer import Renderer
from figures import DOCS

OUT = DOCS / "collision"
LEVELS = {
    "sphere": "one sphere per body",
    "obb": "one box per body",
    "octree": "small boxes around the surface",
    "triangle": "the triangles of the surface",
}
DRONE, CAMERA = "user_drone", "overview"
TILE = (480, 270)  # pixels
DURATION = 8.0  # s
FLIGHT = ((0.0, 2.0, 0.0), (4.9, 2.0, -0.6), (5.9, 2.0, 0.0), (6.9, 1.2, 0.6))  # start in s, forward and up in m/s
GIF_SIZE, GIF_EVERY, GIF_COLORS = (720, 405), 3, 256  # pixels, pictures, size of the palette
FREE, TOUCHED = (24, 28, 34), (190, 40, 24)


def command(time: float) -> Command:
    """The command at a time in s."""
    _, forward, up = next(part for part in reversed(FLIGHT) if part[0] <= time)
    return forward, 0.0, up, 0.0


def at_level(scene: Scene, level: str) -> Scene:
    """The scene with this collision level for all objects without a setting of their own."""
    return scene.model_copy(update={"collision": Collision.model_validate({"level": level})})


def tiles(scene: Scene, renderer: Renderer) -> Iterator[Image.Image]:
    """A picture of all levels for each step of the flight."""
    worlds = {level: World(at_level(scene, level)) for level in LEVELS}
    for step in range(round(DURATION * scene.rates.physics)):
        sheet = Image.new("RGB", (2 * TILE[0], 2 * TILE[1]))
        for i, (level, world) in enumerate(worlds.items()):
            world.step({DRONE: command(step * world.dt)})
            tile = Image.fromarray(renderer.draw(CAMERA, world))
            write_label(tile, level, touches(world))
            sheet.paste(tile, (i % 2 * TILE[0], i // 2 * TILE[1]))
        lines = ImageDraw.Draw(sheet)
        lines.line([(0, TILE[1]), (2 * TILE[0], TILE[1])], "white", 2)
        lines.line([(TILE[0], 0), (TILE[0], 2 * TILE[1])], "white", 2)
        yield sheet


def touches(world: World) -> bool:
    """Whether the drone has a contact with a normal impulse."""
    m, drone = world.detection.manifolds, world.model.bodies.names.index(DRONE)
    return any(drone in m.pair[i] and m.total[i, : m.points[i]].any() for i in range(m.count))


def write_label(tile: Image.Image, level: str, touched: bool) -> None:
    """Writes the level and its description into the upper left corner, on red during a contact."""
    draw = ImageDraw.Draw(tile)
    large, small = ImageFont.load_default(22), ImageFont.load_default(14)
    width = max(draw.textlength(level, large), draw.textlength(LEVELS[level], small))
    draw.rounded_rectangle((8, 8, 28 + width, 62), 6, fill=TOUCHED if touched else FREE)
    draw.text((18, 11), level, "white", large)
    draw.text((18, 39), LEVELS[level], (215, 220, 226), small)


def write_gif(sheets: list[Image.Image], rate: float, path: Path) -> None:
    """Writes a GIF with one palette, from the first and last pictures, so that unchanged pixels take no space."""
    first_and_last = Image.new("RGB", (GIF_SIZE[0], 2 * GIF_SIZE[1]))
    first_and_last.paste(sheets[0])
    first_and_last.paste(sheets[-1], (0, GIF_SIZE[1]))
    palette = first_and_last.quantize(GIF_COLORS, kmeans=4)
    frames = [sheet.quantize(palette=palette, dither=Image.Dither.NONE) for sheet in sheets]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=1000 / rate, loop=0)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m figures.render.levels_film",
                                     description="Films the same flight at the four levels.")
    parser.add_argument("--scene", default="ring", help="name of an installed scene, or path of its file")
    parser.add_argument("--out", type=Path, default=OUT, help="folder to write to")
    options = parser.parse_args()
    scene = load(options.scene)
    camera = scene.cameras[CAMERA].model_copy(update={"size": TILE})
    scene = scene.model_copy(update={"cameras": {CAMERA: camera}})
    rate = scene.rates.physics
    film = Film(options.out / "levels.mp4", (2 * TILE[0], 2 * TILE[1]), round(rate))
    sheets = []
    try:
        with Renderer(scene) as renderer, Progress() as progress:
            for i, sheet in enumerate(progress.track(tiles(scene, renderer), DURATION * rate, description="filming")):
                film.add(sheet.tobytes())
                if i % GIF_EVERY == 0:
                    sheets.append(sheet.resize(GIF_SIZE, Image.Resampling.LANCZOS))
    finally:
        film.close()
    write_gif(sheets, rate / GIF_EVERY, options.out / "levels.gif")
    print(options.out)


if __name__ == "__main__":
    main()
