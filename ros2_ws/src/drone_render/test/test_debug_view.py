"""The debug view puts what it heard last where the things are in the picture that is drawn."""

from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
from geometry_msgs.msg import Point
from rclpy.serialization import serialize_message
from std_srvs.srv import SetBool
from visualization_msgs.msg import Marker, MarkerArray

from drone_render.debug_view import DebugView
from drone_render.lines import Lines
from drone_render.view import matrices

POINTS = [Point(x=1.0), Point(x=2.0)]


class Picture:
    """Stands for a renderer of two objects."""

    def __init__(self) -> None:
        self.hierarchy = SimpleNamespace(names=("tree", "drone"), world=matrices)
        self.told: list[Lines | None] = []

    def show(self, lines: Lines | None) -> None:
        self.told.append(lines)


def poses(x: float) -> np.ndarray:
    return np.array([[0, 0, 0, 0, 0, 0, 1], [x, 0, 0, 0, 0, 0, 1]])


def test_lines_are_where_the_picture_has_the_drone() -> None:
    node = MagicMock()
    view, first, second = DebugView(node), Picture(), Picture()
    answer: Any = node.create_service.call_args.args[2]
    view.show(first, poses(1.0))
    assert first.told == [None]  # which costs nothing

    answer(SetBool.Request(data=True), SetBool.Response())
    hear: Any = node.create_subscription.call_args.args[2]
    marker = Marker(type=Marker.LINE_LIST, points=POINTS)
    marker.header.frame_id = "drone"
    hear(serialize_message(MarkerArray(markers=[marker])))
    for x in (1.0, 1.25, 1.5):  # one message, three pictures
        at = poses(x)
        view.show(first, at)
        assert first.told[-1].ends[:, :, 0].tolist() == [[x + 1, x + 2]]
    told = len(first.told)
    view.show(first, at)  # another camera at the same time
    assert len(first.told) == told
    view.show(second, at)  # another scene
    assert second.told[-1].ends[:, :, 0].tolist() == [[2.5, 3.5]]

    hear(b"nonsense")
    view.show(second, poses(3.0))
    assert second.told[-1].ends[:, :, 0].tolist() == [[4, 5]]
    answer(SetBool.Request(data=False), SetBool.Response())
    view.show(second, poses(3.0))
    assert second.told[-1] is None
    assert node.destroy_subscription.called
