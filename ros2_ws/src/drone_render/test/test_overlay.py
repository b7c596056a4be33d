"""Lines of the debug view: read from the message that others publish, and drawn where they are."""

import moderngl
import numpy as np
import pytest
from geometry_msgs.msg import Point
from rclpy.serialization import serialize_message
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from drone_render.image import Picture
from drone_render.lines import Lines, read_markers
from drone_render.overlay import BOLD, outlines
from drone_render.renderer import Renderer
from drone_render.view import matrices

from .drawing import Make

SCENE = """
render: {ambient: [0.1, 0.1, 0.1]ANTIALIASING}
objects: {crate: {model: crate, pose: [4, 0, 0], mass: 1}}
cameras: {front: {size: [160, 120], fov: 1.0}}
"""


def marker(frame: str, **fields: object) -> Marker:
    made = Marker(color=ColorRGBA(r=0.25, g=0.5, b=1.0, a=0.5), **fields)
    made.header.frame_id = frame
    return made


def test_a_marker_array_is_read_without_rclpy() -> None:
    red, blue = ColorRGBA(r=1.0, a=1.0), ColorRGBA(b=1.0, a=0.5)
    points = [Point(x=float(i), y=2.0 * i, z=-1.0) for i in range(4)]
    colours = [red, red, blue, blue]
    lines = marker("world", ns="boxes", type=Marker.LINE_LIST, points=points, colors=colours, text="word")
    lines.scale.x = 0.02
    lines.pose.position.x, lines.pose.orientation.w = 10.0, 1.0
    plain = marker("crate", type=Marker.LINE_LIST, points=points[:2])
    ball = marker("crate", type=Marker.SPHERE, ns="b")
    ball.scale.x = 3.0
    other = marker("world", type=Marker.CUBE, mesh_resource="none.obj", points=points)
    found = read_markers(serialize_message(MarkerArray(markers=[other, lines, ball, plain, marker("world", type=5)])))
    assert (found.frames, found.marker.tolist()) == (("world", "world", "crate", "crate", "world"), [1, 1, 3])
    first, second = [[0, 0, -1], [1, 2, -1]], [[2, 4, -1], [3, 6, -1]]
    np.testing.assert_allclose(found.ends, [first, second, first])
    np.testing.assert_allclose(found.colours, [[1, 0, 0, 1], [0, 0, 1, 0.5], [0.25, 0.5, 1, 0.5]])
    assert found.widths.tolist() == [4, 4, 1]
    assert (found.balls.tolist(), found.radii.tolist()) == ([2], [1.5])
    np.testing.assert_allclose(found.ball_colours, [[0.25, 0.5, 1, 0.5]])
    plain.scale.x = float("inf")
    lines.action = Marker.DELETE
    found = read_markers(serialize_message(MarkerArray(markers=[lines, plain])))
    assert (found.frames, found.widths.tolist()) == (("crate",), [8])
    for broken in (b"", b"\0\1\0\0", serialize_message(MarkerArray(markers=[lines]))[:-40]):
        with pytest.raises(ValueError):
            read_markers(broken)


def test_markers_go_with_what_they_hang_on() -> None:
    """A box in a body's frame is where the body is in the picture; what hangs on nobody is left out."""
    line = [Point(x=1.0), Point(y=1.0)]
    box, fixed, lost = (marker(frame, type=Marker.LINE_LIST, points=line) for frame in ("crate", "world", "nobody"))
    ball = marker("crate", type=Marker.SPHERE)
    for each in (box, fixed, lost, ball):
        each.pose.position.z = 0.5
    ball.scale.x = 2.0
    shapes = read_markers(serialize_message(MarkerArray(markers=[lost, box, ball, fixed])))
    quarter = np.sin(np.pi / 4)
    at = matrices(np.array([[7.0, 7, 7, 0, 0, 0, 1], [4.0, 5, 6, 0, 0, quarter, quarter]]))
    lines = shapes.placed(("other", "crate"), at)
    np.testing.assert_allclose(lines.ends, [[[4, 6, 6.5], [3, 5, 6.5]], [[1, 0, 0.5], [0, 1, 0.5]]], atol=1e-6)
    np.testing.assert_allclose(lines.centres, [[4, 5, 6.5]])
    assert lines.radii.tolist() == [1.0]


def test_a_ball_is_outlined_where_rays_from_the_eye_touch_it() -> None:
    eye = np.array([1.0, 2.0, 3.0])
    centres, radii = np.float32([[5, 2, 3], [1, 2, 9], [1, 2, 3.5]]), np.float32([1.5, 2.0, 1.0])
    seen, ends = outlines(centres, radii, eye)
    assert seen.tolist() == [0, 1]  # the eye is within the third
    for i, circle in enumerate(np.split(ends.reshape(-1, 3), 2)):
        on, ray = circle - centres[i], circle - eye
        np.testing.assert_allclose(np.linalg.norm(on, axis=1), radii[i])
        np.testing.assert_allclose((on * ray).sum(axis=1), 0, atol=1e-5)


def green(renderer: Renderer, picture: Picture) -> np.ndarray:
    """How much greener than red each pixel is."""
    renderer.draw("front", renderer.hierarchy.start, 0.0, picture)
    rgb = np.frombuffer(picture.pixels(), np.uint8).reshape(120, 160, 3).astype(int)
    return rgb[..., 1] - rgb[..., 0]


def test_a_ball_is_a_circle_in_the_picture(make_scene: Make, graphics: moderngl.Context) -> None:
    picture, colour = Picture((160, 120), "front"), np.float32([[0, 1, 0, 1]])
    lines = Lines.of(np.empty((0, 2, 3)), np.empty((0, 4)))._replace(
        centres=np.float32([[3, 0, 0]]), radii=np.float32([0.6]), ball_colours=colour
    )
    with Renderer(make_scene(SCENE.replace("ANTIALIASING", "")), graphics) as renderer:
        renderer.show(lines)
        rows, columns = np.nonzero(green(renderer, picture) > 100)
    radius = 80 / np.tan(0.5) * 0.6 / np.sqrt(3**2 - 0.6**2)
    assert len(rows) > 200
    np.testing.assert_allclose(np.hypot(rows - 59.5, columns - 79.5), radius, atol=1.5)


def test_lines_on_a_surface_are_before_it(make_scene: Make, graphics: moderngl.Context) -> None:
    """The edges of a box that lie in the faces of the very thing that it is of do not flicker."""
    picture = Picture((160, 120), "front")
    y = np.linspace(-0.45, 0.45, 10)
    ends = np.array([[[3.501, a, -0.4], [3.501, a, 0.4]] for a in y])  # as rounding may leave them
    with Renderer(make_scene(SCENE.replace("ANTIALIASING", "")), graphics) as renderer:
        renderer.show(Lines.of(ends, [[0, 1, 0, 1]] * len(ends), 1))
        shown = green(renderer, picture)[50:70]
    assert ((shown > 200).sum(axis=1) == len(y)).all()


def test_bold_lines_have_a_rim_and_are_seen_behind_things(make_scene: Make, graphics: moderngl.Context) -> None:
    picture = Picture((160, 120), "front")
    ends = np.array([[[3, -3, 0.6], [3, 3, 0.6]], [[6, -6, -0.3], [6, 6, -0.3]]])
    with Renderer(make_scene(SCENE.replace("ANTIALIASING", "")), graphics) as renderer:
        renderer.show(Lines.of(ends, [[0, 1, 0, 1]] * 2, BOLD))
        shown = green(renderer, picture)
        rgb = np.frombuffer(picture.pixels(), np.uint8).reshape(120, 160, 3)
    before = np.flatnonzero(shown[:60, 80] > 200)
    assert len(before) == BOLD
    assert rgb[before[0] - 1, 80].max() < 20
    behind = shown[60:].max(axis=0)
    assert behind[10] > 200 and 120 < behind[80] < 200


@pytest.mark.parametrize("antialiasing", ["", ", antialiasing: {}"])
def test_lines_are_drawn_and_faint_behind_things(
    antialiasing: str, make_scene: Make, graphics: moderngl.Context
) -> None:
    ends = np.array([[[3, -3, 0.3], [3, 3, 0.3]], [[6, -6, -0.3], [6, 6, -0.3]], [[-5, 0, 0], [-2, 0, 0]]], np.float32)
    lines = Lines.of(ends, [[0, 1, 0, 1]] * 3)
    picture = Picture((160, 120), "front")
    with Renderer(make_scene(SCENE.replace("ANTIALIASING", antialiasing)), graphics) as renderer:
        without = picture.pixels() if green(renderer, picture).max() < 30 else b""
        renderer.show(lines)
        shown = green(renderer, picture)
        assert (shown[:60] > 200).any(axis=0).all()  # before the crate, over all columns
        below = shown[60:].max(axis=0)
        assert below[:40].min() > 200 and 10 < below[78:82].max() < 120  # behind it
        renderer.show(None)
        green(renderer, picture)
        assert picture.pixels() == without
