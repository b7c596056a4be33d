"""The debug view's service: subscribes to debug/markers while it is on."""

import threading

from rclpy.node import Node
from std_srvs.srv import SetBool
from visualization_msgs.msg import MarkerArray

from drone_engine.arrays import Floats
from drone_render.frame.lines import Shapes
from drone_render.node.markers import read_markers
from drone_render.renderer import Renderer


class DebugView:
    """The service ~/show_debug. The latest markers are drawn in all pictures, at the poses of each picture."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._lock = threading.Lock()
        self._on = self._changed = False
        self._data: bytes | None = None
        self._shapes: Shapes | None = None
        self._shown: tuple[Renderer, Floats | None] | None = None  # the renderer last updated, and for which poses
        self._subscription = None
        node.create_service(SetBool, "~/show_debug", self._on_show)

    def show(self, renderer: Renderer, poses: Floats) -> None:
        """Updates the lines of a renderer that is about to draw the poses (n, 7)."""
        with self._lock:
            changed, self._changed = self._changed, False
            data = self._data if self._on else None
        if changed:
            self._shapes, self._shown = self._read(data), None
        wanted = None if self._shapes is None else poses
        if self._shown is not None and self._shown[0] is renderer and self._shown[1] is wanted:
            return  # another camera at the same moment
        self._shown = renderer, wanted
        names, world = renderer.hierarchy.names, renderer.hierarchy.world
        renderer.show(None if self._shapes is None else self._shapes.placed(names, world(poses)))

    def _read(self, data: bytes | None) -> Shapes | None:
        try:
            return None if data is None else read_markers(data)
        except ValueError as error:
            self._node.get_logger().warning(f"debug/markers: {error}; message ignored", throttle_duration_sec=5.0)
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
