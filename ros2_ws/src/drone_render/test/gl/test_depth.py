"""Depth and segmentation agree with the scene."""

import moderngl
import numpy as np
import pytest

from drone_engine import Scene
from drone_render.frame import poses, view
from drone_render.renderer import Renderer

from ..drawing import Make, draw

SCENE = """
render: {sky: {}, water: {}}
objects:
  ball: {model: ball, pose: [6, 1, 0.2], mass: 1}
  part: {model: ball, parent: ball, pose: [0, -2, 0]}
  lake: {model: floor, pose: [0, 0, -1.01], static: true, shading: water}
cameras: {front: {size: [160, 120], pose: [0.5, 0, 0.3, 0, 0.05, 0.02]}}
"""


def measure(scene: Scene, graphics: moderngl.Context) -> tuple[np.ndarray, np.ndarray]:
    """Depth in m and labels, (height, width) each."""
    with Renderer(scene, graphics, tolerance=0.0) as renderer:
        return renderer.measure("front")


def test_points_of_the_depth_image_lie_on_the_objects(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = make_scene(SCENE)
    depth, labels = measure(scene, graphics)
    camera = scene.cameras["front"]
    rows, columns = np.indices(depth.shape)
    rays = np.dstack([columns, rows, np.ones_like(rows)]) @ np.linalg.inv(view.intrinsics(camera)).T
    with np.errstate(invalid="ignore"):
        optical = np.dstack([rays * depth[..., None], np.ones_like(depth)])
    world = optical @ (poses.matrices(poses.pose(camera.pose)) @ poses.matrices(view.OPTICAL)).T
    for label, middle in ((1, [6, 1, 0.2]), (2, [6, -1, 0.2])):
        away = np.linalg.norm(world[labels == label][:, :3] - middle, axis=1)
        assert len(away) > 50
        np.testing.assert_allclose(away, 0.5, atol=0.01)  # a ball of triangles
    np.testing.assert_allclose(world[labels == 3][:, 2], -1.0, atol=2e-3)
    assert np.isinf(depth[labels == 0]).all() and (labels[0] == 0).all() and (labels[-1] == 3).all()


def test_colors_are_the_same_after_measuring(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = make_scene(SCENE)
    with Renderer(scene, graphics) as renderer:
        before = renderer.draw("front")
        renderer.measure("front")
        np.testing.assert_array_equal(renderer.draw("front"), before)


def test_a_camera_can_be_added(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = make_scene(SCENE)
    with Renderer(scene, graphics) as renderer:
        renderer.set_cameras(scene.with_cameras("close: {parent: ball, pose: [-2, 0, 0], size: [64, 48]}"))
        depth, labels = renderer.measure("close")
        assert labels.shape == (48, 64) and labels[24, 32] == 1
        assert depth[24, 32] == pytest.approx(1.5, abs=0.01)


def test_instances_keep_their_places_and_labels(make_scene: Make, graphics: moderngl.Context) -> None:
    """Two models alternate by distance, so instances of one model are not neighbors in drawing order."""
    scene = make_scene("""
render: {ambient: [1, 1, 1]}
objects:
  near: {model: crate, pose: [3, 0.8, 0], mass: 1}
  gray: {model: gray_crate, pose: [4, -0.8, 0], mass: 1}
  far: {model: crate, pose: [6, 2.5, 0], mass: 1}
  far_gray: {model: gray_crate, pose: [7, -2.5, 0], mass: 1}
cameras: {front: {size: [160, 120]}}
""")
    depth, labels = measure(scene, graphics)
    nearest = [float(depth[labels == label].min()) for label in (1, 2, 3, 4)]
    np.testing.assert_allclose(nearest, [2.5, 3.5, 5.5, 6.5], atol=1e-3)
    hues = np.ptp(draw(scene, graphics).astype(int), axis=2)
    assert [hues[labels == label].mean() > 1 for label in (1, 2, 3, 4)] == [True, False, True, False]
