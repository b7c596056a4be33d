"""Lines of the debug view: read from the message that others publish, and drawn where they are."""

import moderngl
import numpy as np
import pytest
from geometry_msgs.msg import Point
from rclpy.serialization import serialize_message
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from drone_render.image import Picture
from drone_render.lines import Lines, read_lines
from drone_render.renderer import Renderer

from .drawing import Make

SCENE = """
render: {ambient: [0.1, 0.1, 0.1]ANTIALIASING}
objects: {crate: {model: crate, pose: [4, 0, 0], mass: 1}}
cameras: {front: {size: [160, 120], fov: 1.0}}
"""


def test_a_marker_array_is_read_without_rclpy() -> None:
    red, blue = ColorRGBA(r=1.0, a=1.0), ColorRGBA(b=1.0, a=0.5)
    points = [Point(x=float(i), y=2.0 * i, z=-1.0) for i in range(4)]
    lines = Marker(ns="boxes", type=Marker.LINE_LIST, points=points, colors=[red, red, blue, blue], text="a word")
    lines.header.frame_id = "world"
    other = Marker(type=Marker.SPHERE, ns="b", mesh_resource="none.obj")
    found = read_lines(serialize_message(MarkerArray(markers=[other, lines, Marker(type=Marker.LINE_LIST)])))
    np.testing.assert_allclose(found.ends, [[[0, 0, -1], [1, 2, -1]], [[2, 4, -1], [3, 6, -1]]])
    np.testing.assert_allclose(found.colours, [[1, 0, 0, 1], [0, 0, 1, 0.5]])
    for broken in (b"", b"\0\1\0\0", serialize_message(MarkerArray(markers=[lines]))[:-40]):
        with pytest.raises(ValueError):
            read_lines(broken)


@pytest.mark.parametrize("antialiasing", ["", ", antialiasing: {}"])
def test_lines_are_drawn_and_faint_behind_things(
    antialiasing: str, make_scene: Make, graphics: moderngl.Context
) -> None:
    ends = np.array([[[3, -3, 0.3], [3, 3, 0.3]], [[6, -6, -0.3], [6, 6, -0.3]], [[-5, 0, 0], [-2, 0, 0]]], np.float32)
    lines = Lines(ends, np.array([[0, 1, 0, 1]] * 3, np.float32))
    picture = Picture((160, 120), "front")

    def green(renderer: Renderer) -> np.ndarray:
        renderer.draw("front", renderer.hierarchy.start, 0.0, picture)
        rgb = np.frombuffer(picture.pixels(), np.uint8).reshape(120, 160, 3).astype(int)
        return rgb[..., 1] - rgb[..., 0]

    with Renderer(make_scene(SCENE.replace("ANTIALIASING", antialiasing)), graphics) as renderer:
        without = picture.pixels() if green(renderer).max() < 30 else b""
        renderer.show(lines)
        shown = green(renderer)
        assert (shown[:60] > 200).any(axis=0).all()  # before the crate, over all columns
        below = shown[60:].max(axis=0)
        assert below[:40].min() > 200 and 10 < below[78:82].max() < 120  # behind it
        renderer.show(None)
        green(renderer)
        assert picture.pixels() == without
