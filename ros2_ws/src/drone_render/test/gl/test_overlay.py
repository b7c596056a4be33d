"""Lines and spheres over the picture."""

import moderngl
import numpy as np
import pytest

from drone_render.frame.lines import Lines
from drone_render.gl.overlay import BOLD, outlines
from drone_render.renderer import Renderer

from ..drawing import Make

SCENE = """
render: {ambient: [0.1, 0.1, 0.1]ANTIALIASING}
objects: {crate: {model: crate, pose: [4, 0, 0], mass: 1}}
cameras: {front: {size: [160, 120], fov: 1.0}}
"""


def test_a_ball_is_outlined_where_rays_from_the_eye_touch_it() -> None:
    eye = np.array([1.0, 2.0, 3.0])
    centers, radii = np.float32([[5, 2, 3], [1, 2, 9], [1, 2, 3.5]]), np.float32([1.5, 2.0, 1.0])
    seen, ends = outlines(centers, radii, eye)
    assert seen.tolist() == [0, 1]  # the eye is within the third
    for i, circle in enumerate(np.split(ends.reshape(-1, 3), 2)):
        on, ray = circle - centers[i], circle - eye
        np.testing.assert_allclose(np.linalg.norm(on, axis=1), radii[i])
        np.testing.assert_allclose((on * ray).sum(axis=1), 0, atol=1e-5)


def green(picture: np.ndarray) -> np.ndarray:
    """How much greener than red each pixel is."""
    rgb = picture.astype(int)
    return rgb[..., 1] - rgb[..., 0]


def test_a_ball_is_a_circle_in_the_picture(make_scene: Make, graphics: moderngl.Context) -> None:
    color = np.float32([[0, 1, 0, 1]])
    lines = Lines.of(np.empty((0, 2, 3)), np.empty((0, 4)))._replace(
        centers=np.float32([[3, 0, 0]]), radii=np.float32([0.6]), sphere_colors=color
    )
    with Renderer(make_scene(SCENE.replace("ANTIALIASING", "")), graphics) as renderer:
        renderer.show(lines)
        rows, columns = np.nonzero(green(renderer.draw("front")) > 100)
    radius = 80 / np.tan(0.5) * 0.6 / np.sqrt(3**2 - 0.6**2)
    assert len(rows) > 200
    np.testing.assert_allclose(np.hypot(rows - 59.5, columns - 79.5), radius, atol=1.5)


def test_lines_on_a_surface_are_before_it(make_scene: Make, graphics: moderngl.Context) -> None:
    """The edges of a box that lie in the faces of the very thing that it is of do not flicker."""
    y = np.linspace(-0.45, 0.45, 10)
    ends = np.array([[[3.501, a, -0.4], [3.501, a, 0.4]] for a in y])  # as rounding may leave them
    with Renderer(make_scene(SCENE.replace("ANTIALIASING", "")), graphics) as renderer:
        renderer.show(Lines.of(ends, [[0, 1, 0, 1]] * len(ends), 1))
        shown = green(renderer.draw("front"))[50:70]
    assert ((shown > 200).sum(axis=1) == len(y)).all()


def test_bold_lines_have_a_rim_and_are_seen_behind_things(make_scene: Make, graphics: moderngl.Context) -> None:
    ends = np.array([[[3, -3, 0.6], [3, 3, 0.6]], [[6, -6, -0.3], [6, 6, -0.3]]])
    with Renderer(make_scene(SCENE.replace("ANTIALIASING", "")), graphics) as renderer:
        renderer.show(Lines.of(ends, [[0, 1, 0, 1]] * 2, BOLD))
        picture = renderer.draw("front")
        shown = green(picture)
    before = np.flatnonzero(shown[:60, 80] > 200)
    assert len(before) == BOLD
    assert picture[before[0] - 1, 80].max() < 20
    behind = shown[60:].max(axis=0)
    assert behind[10] > 200 and 120 < behind[80] < 200


@pytest.mark.parametrize("antialiasing", ["", ", antialiasing: {}"])
def test_lines_are_drawn_and_faint_behind_things(
    antialiasing: str, make_scene: Make, graphics: moderngl.Context
) -> None:
    ends = np.array([[[3, -3, 0.3], [3, 3, 0.3]], [[6, -6, -0.3], [6, 6, -0.3]], [[-5, 0, 0], [-2, 0, 0]]], np.float32)
    lines = Lines.of(ends, [[0, 1, 0, 1]] * 3)
    with Renderer(make_scene(SCENE.replace("ANTIALIASING", antialiasing)), graphics) as renderer:
        without = renderer.draw("front")
        assert green(without).max() < 30
        renderer.show(lines)
        shown = green(renderer.draw("front"))
        assert (shown[:60] > 200).any(axis=0).all()  # before the crate, over all columns
        below = shown[60:].max(axis=0)
        assert below[:40].min() > 200 and 10 < below[78:82].max() < 120  # behind it
        renderer.show(None)
        np.testing.assert_array_equal(renderer.draw("front"), without)
