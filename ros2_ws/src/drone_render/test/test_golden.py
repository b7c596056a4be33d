"""Each feature looks like its golden picture. `GOLDEN=write pytest` writes them again; look at them before committing.

On Mesa's software rasterizer pictures are compared pixel by pixel, with a tolerance for other versions of it. On other
devices blocks of pixels are compared, which rounding, filters and the edges of triangles hardly change.
"""

import os
import tempfile
from pathlib import Path

import moderngl
import numpy as np
import pytest
from PIL import Image

from drone_engine import Scene
from drone_render.frame.lines import Lines
from drone_render.gl import context
from drone_render.renderer import Renderer

from .drawing import Make, draw

GOLDEN = Path(__file__).with_name("golden")
FAILED = Path(tempfile.gettempdir()) / "golden"
MEAN, FAR, FEW = 0.5, 12, 0.01  # of 255: mean difference; a share FEW of the pixels may differ by more than FAR
BLOCK, BLOCK_OFF = 10, 12.0  # side of a block in pixels; difference of a block's mean, of 255, on other devices

THINGS = """
objects:
  floor: {model: floor, pose: [0, 0, -0.5], static: true}
  crate: {model: crate, pose: [3, 0.7, 0.2, 0, 0, 0.5], mass: 1}
  ball: {model: ball, pose: [3, -0.7, 0.2], mass: 1}
  lamp: {model: lamp, parent: ball, pose: [-0.6, 0.6, 0.3]}
cameras: {front: {size: [160, 120], pose: [0, 0, 0.6, 0, 0.15, 0]}}
"""
SUN = "lights: {sun: {pose: [-200, 200, 300]}}\n"
LAMP = "lights: {lamp: {pose: [1.5, 0, 1], colour: [1, 0.6, 0.3], reach: 1.5BEAM}}\n"
BAY = THINGS.replace("floor, pose: [0, 0, -0.5]", "floor, pose: [0, 0, -0.6, 0.1, 0, 0.3]").replace(
    "objects:", "objects:\n  sea: {model: floor, pose: [0, 0, -0.5], static: true, shading: water}")
POND = THINGS.replace("static: true}", "static: true, shading: water}")
FEATURES = {
    "ambient": THINGS,
    "sun": SUN + THINGS,
    "lamp": LAMP.replace("BEAM", "") + "render: {ambient: [0.1, 0.1, 0.1]}\n" + THINGS,
    "beam": LAMP.replace("BEAM", ", beam: 0.9").replace("1.5, 0, 1]", "1.5, 0, 1, 0, 0.4, 0.4]")
    + "render: {ambient: [0.1, 0.1, 0.1]}\n" + THINGS,
    "normal_mapping": SUN + "render: {normal_mapping: {}}\n" + THINGS,
    "packed_maps": SUN + "render: {normal_mapping: {}, specular: {}}\n" + THINGS.replace("l: crate", "l: gray_crate"),
    "specular": SUN + "render: {specular: {}}\n" + THINGS,
    "antialiasing": SUN + "render: {antialiasing: {}}\n" + THINGS,
    "sky": SUN + "render: {sky: {}}\n" + THINGS,
    "clouds": SUN + "render: {sky: {clouds: clouds}}\n" + THINGS,
    "dusk": SUN + "render: {daylight: 0.4, sky: {clouds: clouds, stars: noise}}\n" + THINGS,
    "night": SUN + "render: {daylight: 0.0, sky: {stars: noise}}\n" + THINGS,
    "water": SUN + "render: {water: {}}\n" + POND,
    "shore": SUN + "render: {sky: {}, water: {}, antialiasing: {}}\n" + BAY,
    "water_and_sky": SUN + "render: {sky: {}, water: {}}\n" + POND,
    "everything": SUN + "render: {sky: {clouds: clouds}, water: {}, normal_mapping: {}, specular: {}, "
    "antialiasing: {}}\n" + POND,
}  # fmt: skip


def compare(name: str, pixels: np.ndarray, graphics: moderngl.Context) -> None:
    """Asserts that pixels (height, width, 3) are the golden ones; saves both and their difference if not."""
    path = GOLDEN / f"{name}.png"
    if os.environ.get("GOLDEN") == "write":
        GOLDEN.mkdir(exist_ok=True)
        Image.fromarray(pixels).save(path, optimize=True)
    golden = np.asarray(Image.open(path)).astype(int)
    off = np.abs(pixels.astype(int) - golden)
    if "llvmpipe" in context.device_name(graphics):
        same = off.mean() <= MEAN and (off.max(axis=2) > FAR).mean() <= FEW
    else:
        same = np.abs(blocks(pixels) - blocks(golden)).max() <= BLOCK_OFF
    if not same:
        FAILED.mkdir(exist_ok=True)
        rows = np.hstack([golden.astype(np.uint8), pixels, np.minimum(off * 8, 255).astype(np.uint8)])
        Image.fromarray(rows).save(FAILED / f"{name}.png")
    assert same, f"{name}: {off.mean():.2f} of 255 off; golden, drawn and difference: {FAILED / name}.png"


def blocks(pixels: np.ndarray) -> np.ndarray:
    """Means over squares of BLOCK pixels."""
    height, width, _ = pixels.shape
    return pixels.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean(axis=(1, 3))


@pytest.mark.parametrize("feature", FEATURES)
def test_a_feature_looks_as_before(feature: str, make_scene: Make, graphics: moderngl.Context) -> None:
    compare(feature, draw(make_scene(FEATURES[feature]), graphics, time=2.5), graphics)


def test_levels_of_detail_look_as_before(make_scene: Make, graphics: moderngl.Context) -> None:
    compare("coarse", draw(make_scene(FEATURES["sun"]), graphics, tolerance=30.0), graphics)


def test_the_debug_view_looks_as_before(make_scene: Make, graphics: moderngl.Context) -> None:
    corners = np.array([(x, y, z) for x in (2.5, 3.5) for y in (0.2, 1.2) for z in (-0.3, 0.7)], np.float32)
    ends = np.array([(a, b) for a in corners for b in corners if 0.9 < np.linalg.norm(a - b) < 1.1], np.float32)
    foot, tip, wings = (2.5, 0.2, -0.3), (2.5, 0.2, 0.3), [(2.5, y, 0.2) for y in (0.3, 0.1)]
    arrow = [(foot, tip), *((tip, wing) for wing in wings)]
    green, yellow = [0.2, 0.8, 0.3, 1.0], [1.0, 0.85, 0.0, 1.0]
    colors = np.array([green] * len(ends) + [yellow] * 3)
    lines = Lines.of(np.concatenate([ends, np.array(arrow)]), colors)._replace(
        widths=np.repeat([3, 4], [len(ends), 3]),
        centers=np.array([[3, -0.7, 0.2]], np.float32),
        radii=np.array([0.5], np.float32),
        sphere_colors=np.array([[0.15, 0.75, 1.0, 0.2]], np.float32),
    )
    with Renderer(make_scene(FEATURES["antialiasing"]), graphics) as renderer:
        renderer.show(lines)
        compare("debug", renderer.draw("front"), graphics)


def test_depth_and_labels_look_as_before(make_scene: Make, graphics: moderngl.Context) -> None:
    """Shown in gray: 30 steps per m, and 60 per label."""
    scene: Scene = make_scene(FEATURES["ambient"])
    with Renderer(scene, graphics) as renderer:
        depth, labels = renderer.measure("front")
    for name, gray in (("depth", np.minimum(depth * 30, 255)), ("labels", labels * 60)):
        compare(name, np.repeat(gray.astype(np.uint8)[..., None], 3, axis=2), graphics)
