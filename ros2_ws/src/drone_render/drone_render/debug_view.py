"""The toggle of the debug view: listens to debug/markers while it is on."""

import threading

from rclpy.node import Node
from std_srvs.srv import SetBool
from visualization_msgs.msg import MarkerArray

from drone_render.lines import Shapes, read_markers
from drone_render.renderer import Renderer
from drone_render.view import Array


class DebugView:
    """Answers ~/show_debug; what it hears is shown by whoever draws, at the poses that are drawn."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._lock = threading.Lock()
        self._on = self._changed = False
        self._data: bytes | None = None
        self._shapes: Shapes | None = None
        self._shown: tuple[Renderer, Array | None] | None = None  # what was last told what; no poses if nothing
        self._subscription = None
        node.create_service(SetBool, "~/show_debug", self._on_show)

    def show(self, renderer: Renderer, poses: Array) -> None:
        """Tells who draws the objects at these poses what to draw over them."""
        with self._lock:
            changed, self._changed = self._changed, False
            data = self._data if self._on else None
        if changed:
            self._shapes, self._shown = self._read(data), None
        wanted = None if self._shapes is None else poses
        if self._shown is not None and self._shown[0] is renderer and self._shown[1] is wanted:
            return  # another camera of the same moment
        self._shown = renderer, wanted
        names, world = renderer.hierarchy.names, renderer.hierarchy.world
        renderer.show(None if self._shapes is None else self._shapes.placed(names, world(poses)))

    def _read(self, data: bytes | None) -> Shapes | None:
        try:
            return None if data is None else read_markers(data)
        except ValueError as error:
            self._node.get_logger().warning(f"debug/markers: {error}; left out", throttle_duration_sec=5.0)
            return self._shapes

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
