"""The toggle of the debug view: listens to debug/markers while it is on."""

import threading

from rclpy.node import Node
from std_srvs.srv import SetBool
from visualization_msgs.msg import MarkerArray

from drone_render.lines import Lines, read_lines


class DebugView:
    """Answers ~/show_debug; what it hears is taken by whoever draws."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._lock = threading.Lock()
        self._on = self._changed = False
        self._data: bytes | None = None
        self._subscription = None
        node.create_service(SetBool, "~/show_debug", self._on_show)

    def take(self) -> tuple[bool, Lines | None]:
        """Whether anything is new since the last call, and the lines to show, None for none."""
        with self._lock:
            changed, self._changed = self._changed, False
            data = self._data if self._on else None
        if not changed or data is None:
            return changed, None
        try:
            return True, read_lines(data)
        except ValueError as error:
            self._node.get_logger().warning(f"debug/markers: {error}; left out", throttle_duration_sec=5.0)
            return False, None

    def _on_show(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        with self._lock:
            self._on, self._changed, self._data = request.data, True, None
        if request.data and self._subscription is None:
            self._subscription = self._node.create_subscription(MarkerArray, "debug/markers", self._on_markers, 1,
                                                                raw=True)
        elif not request.data and self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None
        response.success = True
        response.message = "the debug view is " + ("on" if request.data else "off")
        return response

    def _on_markers(self, data: bytes) -> None:
        with self._lock:
            self._data, self._changed = data, True
