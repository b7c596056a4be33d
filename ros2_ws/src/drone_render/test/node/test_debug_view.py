"""The debug view draws the latest markers at the poses of each picture."""

from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
from geometry_msgs.msg import Point
from rclpy.serialization import serialize_message
from std_srvs.srv import SetBool
from visualization_msgs.msg import Marker, MarkerArray

from drone_render.frame.lines import Lines
from drone_render.frame.poses import matrices
from drone_render.node.debug_view import DebugView

POINTS = [Point(x=1.0), Point(x=2.0)]


class FakeRenderer:
    """Records the lines that a renderer of two objects is given."""

    def __init__(self) -> None:
        self.hierarchy = SimpleNamespace(names=("tree", "drone"), world=matrices)
        self.shown: list[Lines | None] = []

    def show(self, lines: Lines | None) -> None:
        self.shown.append(lines)


def poses(x: float) -> np.ndarray:
    return np.array([[0, 0, 0, 0, 0, 0, 1], [x, 0, 0, 0, 0, 0, 1]])


def test_lines_are_where_the_picture_has_the_drone() -> None:
    node = MagicMock()
    view, first, second = DebugView(node), FakeRenderer(), FakeRenderer()
    answer: Any = node.create_service.call_args.args[2]
    view.show(first, poses(1.0))
    assert first.shown == [None]  # which costs nothing

    answer(SetBool.Request(data=True), SetBool.Response())
    hear: Any = node.create_subscription.call_args.args[2]
    marker = Marker(type=Marker.LINE_LIST, points=POINTS)
    marker.header.frame_id = "drone"
    hear(serialize_message(MarkerArray(markers=[marker])))
    for x in (1.0, 1.25, 1.5):  # one message, three pictures
        at = poses(x)
        view.show(first, at)
        assert first.shown[-1].ends[:, :, 0].tolist() == [[x + 1, x + 2]]
    shown = len(first.shown)
    view.show(first, at)  # another camera at the same time
    assert len(first.shown) == shown
    view.show(second, at)  # another scene
    assert second.shown[-1].ends[:, :, 0].tolist() == [[2.5, 3.5]]

    hear(b"nonsense")
    view.show(second, poses(3.0))
    assert second.shown[-1].ends[:, :, 0].tolist() == [[4, 5]]
    answer(SetBool.Request(data=False), SetBool.Response())
    view.show(second, poses(3.0))
    assert second.shown[-1] is None
    assert node.destroy_subscription.called
