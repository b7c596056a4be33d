"""Markers of the debug view, read from the serialized message."""

import numpy as np
import pytest
from geometry_msgs.msg import Point
from rclpy.serialization import serialize_message
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from drone_render.frame.poses import matrices
from drone_render.node.markers import read_markers


def marker(frame: str, **fields: object) -> Marker:
    made = Marker(color=ColorRGBA(r=0.25, g=0.5, b=1.0, a=0.5), **fields)
    made.header.frame_id = frame
    return made


def test_a_marker_array_is_read_without_rclpy() -> None:
    red, blue = ColorRGBA(r=1.0, a=1.0), ColorRGBA(b=1.0, a=0.5)
    points = [Point(x=float(i), y=2.0 * i, z=-1.0) for i in range(4)]
    colors = [red, red, blue, blue]
    lines = marker("world", ns="boxes", type=Marker.LINE_LIST, points=points, colors=colors, text="word")
    lines.scale.x = 0.02
    lines.pose.position.x, lines.pose.orientation.w = 10.0, 1.0
    plain = marker("crate", type=Marker.LINE_LIST, points=points[:2])
    ball = marker("crate", type=Marker.SPHERE, ns="b")
    ball.scale.x = 3.0
    other = marker("world", type=Marker.CUBE, mesh_resource="none.obj", points=points)
    found = read_markers(serialize_message(MarkerArray(markers=[other, lines, ball, plain, marker("world", type=5)])))
    assert (found.frames, found.line_marker.tolist()) == (("world", "world", "crate", "crate", "world"), [1, 1, 3])
    first, second = [[0, 0, -1], [1, 2, -1]], [[2, 4, -1], [3, 6, -1]]
    np.testing.assert_allclose(found.ends, [first, second, first])
    np.testing.assert_allclose(found.colors, [[1, 0, 0, 1], [0, 0, 1, 0.5], [0.25, 0.5, 1, 0.5]])
    assert found.widths.tolist() == [4, 4, 1]
    assert (found.sphere_marker.tolist(), found.radii.tolist()) == ([2], [1.5])
    np.testing.assert_allclose(found.sphere_colors, [[0.25, 0.5, 1, 0.5]])
    plain.scale.x = float("inf")
    lines.action = Marker.DELETE
    found = read_markers(serialize_message(MarkerArray(markers=[lines, plain])))
    assert (found.frames, found.widths.tolist()) == (("crate",), [8])
    for broken in (b"", b"\0\1\0\0", serialize_message(MarkerArray(markers=[lines]))[:-40]):
        with pytest.raises(ValueError):
            read_markers(broken)


def test_markers_move_with_their_frames() -> None:
    """A box in a body's frame is drawn at the body's pose in the picture; shapes in an unknown frame are left out."""
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
    np.testing.assert_allclose(lines.centers, [[4, 5, 6.5]])
    assert lines.radii.tolist() == [1.0]
