"""Draws the pictures of the README into docs/figures.

    python -m figures.render.stills [NAME ...]

All but one show the island with objects placed for the picture; in the other one the simulation moves the television.
"""

import argparse
import math
from collections.abc import Callable, Mapping
from typing import Any

from matplotlib.font_manager import findfont
from PIL import Image, ImageDraw, ImageFont, ImageOps

from drone_engine import Scene, load
from drone_engine.arrays import Floats
from drone_engine.scene.schema import ObjectCollision
from drone_engine.world import World
from drone_render.frame.poses import pose
from drone_render.node.markers import read_markers
from drone_render.renderer import Renderer
from drone_sim.wire.markers import Markers
from figures import DOCS
from figures.style import INK

OUT = DOCS / "figures"
SIZE, QUALITY = (1280, 720), 90  # pixels; quality of the JPEG files
Places = Mapping[str, tuple[float, ...]]  # x y z roll pitch yaw of objects


def island(camera: str, **render: Any) -> Scene:
    """The island with an additional camera 'figure' and changed render options."""
    scene = load("island")
    scene = scene.model_copy(update={"render": scene.render.model_copy(update=render)})
    return scene.with_cameras(f"figure: {{size: [{SIZE[0]}, {SIZE[1]}], {camera}}}")


def draw(scene: Scene, places: Places = {}, time: float = 0.0, world: World | None = None) -> Image.Image:
    """The picture of the camera 'figure'; poses from the scene, from `places`, or from the world."""
    with Renderer(scene) as renderer:
        poses = renderer.hierarchy.start.copy()
        for name, place in places.items():
            poses[renderer.hierarchy.names.index(name)] = pose((*place, 0.0, 0.0, 0.0)[:6])  # type: ignore[arg-type]
        if world is not None:
            for name, row in zip(world.model.bodies.names, world.object_poses(), strict=True):
                poses[renderer.hierarchy.names.index(name)] = row
        if world is not None and scene.description == "debug":
            shapes = read_markers(Markers(world).message(0))
            renderer.show(shapes.placed(renderer.hierarchy.names, renderer.hierarchy.world(poses)))
        _turn_rotors(scene, poses, renderer.hierarchy.names, time)
        return Image.fromarray(renderer.draw("figure", poses, time))


def _turn_rotors(scene: Scene, poses: Floats, names: tuple[str, ...], time: float) -> None:
    """Rotates the rotors, each by a different angle."""
    for row, name in enumerate(names):
        if scene.objects[name].rotor is not None:
            angle = 0.7 * row + 40.0 * time
            poses[row, 5:] = math.sin(angle / 2), math.cos(angle / 2)


def label(picture: Image.Image, text: str) -> None:
    """Writes the text into the lower left corner."""
    pen, font = ImageDraw.Draw(picture), ImageFont.truetype(findfont("DejaVu Sans"), 26)
    left, top, right, bottom = pen.textbbox((28, picture.height - 28), text, font, "ls")
    pen.rectangle((left - 12, top - 10, right + 12, bottom + 10), "white")
    pen.text((28, picture.height - 28), text, INK, font, "ls")


def both_drones() -> Image.Image:
    """Both drones above the village, from the front."""
    scene = island("pose: [-20, -10, 11, 0, 0.19, 0.38], fov: 1.05")
    return draw(scene, {"user_drone": (-18.28, -8.81, 10.72, -0.06, 0.14, 3.25),
                        "ai_drone": (-17.37, -9.78, 10.98, 0.12, 0.10, 2.8)}, time=4.0)


def clouds() -> Image.Image:
    """The clouds at two times, side by side."""
    scene = island("pose: [7, 2, 1.7, 0, -0.30, 0.50], fov: 1.2")
    whole = Image.new("RGB", SIZE, "white")
    for i, time in enumerate((0.0, 20.0)):
        half = draw(scene, time=time).crop((SIZE[0] // 4 + 2, 0, 3 * SIZE[0] // 4 - 2, SIZE[1]))
        label(half, f"{time:.0f} s")
        whole.paste(half, (i * (SIZE[0] // 2 + 4), 0))
    return whole


def specular() -> Image.Image:
    """The screen's light reflected by the drone, in the evening."""
    scene = island("pose: [2.85, -1.20, 1.02, 0, 0.19, 1.32], fov: 1.05", daylight=0.12)
    return draw(scene, {"user_drone": (3.02, -0.05, 0.80, -0.04, 0.08, -0.35)}, time=2.0)


def pushed() -> Image.Image:
    """The drone pushes the television off-center, which rotates it; inset: just before the contact."""
    scene = load("island")
    world = World(scene)
    for _ in range(round(scene.rates.physics)):
        world.step({"user_drone": (0.0, -0.4, 0.0, 0.0)})
    shots = []
    for seconds, size in ((2.1, (SIZE[0] // 3, SIZE[1] // 3)), (1.0, SIZE)):
        for _ in range(round(seconds * scene.rates.physics)):
            world.step({"user_drone": (2.0, 0.0, 0.0, 0.0)})
        x, y, z = world.pose("user_drone")[:3]
        camera = f"pose: [{x - 0.80:.3f}, {y + 1.30:.3f}, {z + 0.50:.3f}, 0, 0.22, -1.00], fov: 1.05"
        shot = draw(island(camera), time=world.time, world=world).resize(size, Image.Resampling.LANCZOS)
        label(shot, f"{world.time:.1f} s")
        shots.append(shot)
    small, picture = shots
    picture.paste(ImageOps.expand(small, 3, "white"), (SIZE[0] - small.width - 26, 20))
    return picture


def person() -> Image.Image:
    """The pilot, seen by an additional camera."""
    scene = island("pose: [4, -1, 1.35, 0, -0.09, 0.50], fov: 0.95")
    return draw(scene, {"person": (6.3, -0.3, 0.0, 0.0, 0.0, 2.9),
                        "user_drone": (5.69, 0.62, 1.84, 0.04, 0.08, -2.6)}, time=8.0)


def eyes() -> Image.Image:
    """The view of the pilot."""
    scene = island("parent: person, pose: [0.16, 0, 1.66], look_at: user_drone, fov: 1.1")
    return draw(scene, {"user_drone": (-1.55, 3.75, 2.16, 0.22, 0.12, 0.3),
                        "ai_drone": (0.2, 2.75, 2.75, 0.0, 0.1, 2.4)}, time=12.0)


def debug() -> Image.Image:
    """The debug view: a drone pushes a crate, another crate stands, a drone flies."""
    base = load("island")
    places = {
        "user_drone": ((6.85, -6.95, 0.36, 0, 0, 0.4), "octree"),
        "crate_0": ((7.75, -6.6, 0, 0, 0, 0.4), "octree"),
        "crate_1": ((9.3, -7.6, 0, 0, 0, -0.2), "obb"),
        "ai_drone": ((8.9, -6.3, 1.75, 0, 0, -0.6), "octree"),
    }
    objects = {}
    for name, (place, level) in places.items():
        collision = ObjectCollision.model_validate({"level": level})
        objects[name] = base.objects[name].model_copy(update={"pose": place, "collision": collision})
    scene = base.model_copy(update={"description": "debug", "objects": {**base.objects, **objects}})
    world = World(scene)
    for _ in range(60):
        world.step({"user_drone": (0.8, 0.0, 0.0, 0.0)})
    camera = "pose: [6.5, -10.95, 2.45, 0, 0.315, 1.13], fov: 1.0"
    return draw(scene.with_cameras(f"figure: {{size: [{SIZE[0]}, {SIZE[1]}], {camera}}}"), world=world)


def night() -> Image.Image:
    """The drone's light on the wall of the cottage at nightfall."""
    scene = island("pose: [-0.80, 6.7, 1.15, 0, -0.17, 1.10], fov: 1.05", daylight=0.14)
    return draw(scene, {"user_drone": (0.40, 10.15, 1.78, 0.06, 0.05, 1.35)}, time=3.0)


FIGURES: dict[str, Callable[[], Image.Image]] = {
    make.__name__: make for make in (both_drones, clouds, specular, pushed, person, eyes, debug, night)
}


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"which: {', '.join(FIGURES)}; default: all")
    names = parser.parse_args().names
    if unknown := set(names) - set(FIGURES):
        parser.error(f"no figure '{min(unknown)}'")
    OUT.mkdir(parents=True, exist_ok=True)
    for name in names or FIGURES:
        path = OUT / f"{name}.jpg"
        FIGURES[name]().save(path, quality=QUALITY, optimize=True)
        print(path.relative_to(OUT.parents[1]), flush=True)


if __name__ == "__main__":
    main()
