"""Draws a scene at its start poses to a PNG, without ROS: python -m drone_render.snapshot SCENE --out x.png."""

import argparse
import sys
from pathlib import Path

from PIL import Image
from pydantic import ValidationError

from drone_engine.scene import loading as scenes
from drone_engine.scene.errors import first_error
from drone_engine.scene.picture import Camera
from drone_render import context
from drone_render.image import Picture
from drone_render.renderer import Renderer


def draw(scene: scenes.Scene, camera: str, time: float = 0.0) -> Image.Image:
    """The picture of a camera with every object where the scene puts it, at `time` in s."""
    graphics = context.create()
    try:
        with Renderer(scene, graphics) as renderer:
            picture = Picture(scene.cameras[camera].size, camera)
            renderer.draw(camera, renderer.hierarchy.start, time, picture)
            return Image.frombytes("RGB", scene.cameras[camera].size, picture.pixels())
    finally:
        graphics.release()


def _resized(camera: Camera, size: tuple[int, ...]) -> Camera:
    """The camera with another size in pixels. Raises ValueError for one that no scene may have."""
    try:
        return Camera.model_validate({**dict(camera), "size": size})
    except ValidationError as error:
        raise ValueError(f"--size {' '.join(map(str, size))}: {first_error(error, Camera)}") from None


def main(args: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="drone_render.snapshot", description="Draws a scene as it starts.")
    parser.add_argument("scene", help="name of a scene among the assets, or its file")
    parser.add_argument("--camera", help="which camera; the first if not given")
    parser.add_argument("--out", type=Path, default=Path("out/snapshot.png"), help="the PNG to write")
    parser.add_argument("--time", type=float, default=0.0, help="simulated s; moves clouds, waves and orbits")
    parser.add_argument("--size", type=int, nargs=2, metavar=("WIDTH", "HEIGHT"),
                        help="pixels; the camera's own if not given")
    options = parser.parse_args(args)
    try:
        scene = scenes.load(options.scene)
        camera = options.camera or next(iter(scene.cameras), "")
        if camera not in scene.cameras:
            raise ValueError(f"no camera '{camera}' in {scene.path}; there are {', '.join(scene.cameras) or 'none'}")
        if options.size:
            resized = _resized(scene.cameras[camera], tuple(options.size))
            scene = scene.model_copy(update={"cameras": {**scene.cameras, camera: resized}})
        image = draw(scene, camera, options.time)
        options.out.parent.mkdir(parents=True, exist_ok=True)
        image.save(options.out)
    except (ValueError, OSError, context.ContextError) as error:
        print(f"snapshot: {error}", file=sys.stderr)
        return 1
    print(options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
