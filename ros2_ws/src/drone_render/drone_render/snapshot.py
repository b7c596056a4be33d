"""Draws a scene at its start poses to a PNG: python -m drone_render.snapshot SCENE --out x.png. Needs no ROS."""

import argparse
import sys
from pathlib import Path

from PIL import Image
from pydantic import ValidationError

from drone_engine.scene import loading as scenes
from drone_engine.scene.errors import first_error
from drone_engine.scene.picture import Camera
from drone_render.gl.context import ContextError
from drone_render.renderer import Renderer


def _resized(camera: Camera, size: tuple[int, ...]) -> Camera:
    """The camera with another size in pixels. Raises ValueError for a size that scenes do not allow."""
    try:
        return Camera.model_validate({**dict(camera), "size": size})
    except ValidationError as error:
        raise ValueError(f"--size {' '.join(map(str, size))}: {first_error(error, Camera)}") from None


def main(args: list[str] | None = None) -> int:
    """Runs the command line; returns the exit status."""
    parser = argparse.ArgumentParser(prog="drone_render.snapshot", description="Draws a scene at its start poses.")
    parser.add_argument("scene", help="name of a shipped scene, or a scene file")
    parser.add_argument("--camera", help="name of the camera; by default the first")
    parser.add_argument("--out", type=Path, default=Path("out/snapshot.png"), help="the PNG to write")
    parser.add_argument("--time", type=float, default=0.0, help="simulated time in s; moves clouds, waves and orbits")
    parser.add_argument("--size", type=int, nargs=2, metavar=("WIDTH", "HEIGHT"),
                        help="in pixels; by default the camera's own")
    options = parser.parse_args(args)
    try:
        scene = scenes.load(options.scene)
        camera = options.camera or next(iter(scene.cameras), "")
        if camera not in scene.cameras:
            raise ValueError(f"no camera '{camera}' in {scene.path}; there are {', '.join(scene.cameras) or 'none'}")
        if options.size:
            resized = _resized(scene.cameras[camera], tuple(options.size))
            scene = scene.model_copy(update={"cameras": {**scene.cameras, camera: resized}})
        with Renderer(scene) as renderer:
            image = Image.fromarray(renderer.draw(camera, time=options.time))
        options.out.parent.mkdir(parents=True, exist_ok=True)
        image.save(options.out)
    except (ValueError, OSError, ContextError) as error:
        print(f"snapshot: {error}", file=sys.stderr)
        return 1
    print(options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
