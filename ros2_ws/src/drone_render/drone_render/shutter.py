"""One camera in the graph: its topics, the bytes of its messages, and what its pictures took."""

from functools import cached_property

from diagnostic_msgs.msg import KeyValue
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image
from tf2_msgs.msg import TFMessage

from drone_engine.scene.picture import Camera
from drone_render import view
from drone_render.image import Picture, camera_info, transforms
from drone_render.view import Array
from drone_sim.node.process import NO_CALLBACKS


class Outlet:
    """Images of one kind, and the camera_info beside them, where image_transport and depth_image_proc look for it."""

    def __init__(self, node: Node, topic: str) -> None:
        self.images = node.create_publisher(
            Image, f"{topic}/image_raw", qos_profile_sensor_data, event_callbacks=NO_CALLBACKS)
        self.infos = node.create_publisher(
            CameraInfo, f"{topic}/camera_info", qos_profile_sensor_data, event_callbacks=NO_CALLBACKS)

    def heard(self) -> bool:
        """Whether anybody listens to either."""
        return bool(self.images.get_subscription_count() or self.infos.get_subscription_count())

    def close(self, node: Node) -> None:
        """Ends both topics."""
        node.destroy_publisher(self.images)
        node.destroy_publisher(self.infos)


class Shutter:
    """Publishes what is drawn into `picture`, `depth` and `labels`: image_raw and camera_info below camera/<name>,
    camera/<name>/depth and camera/<name>/segmentation, and tf of cameras that turn."""

    def __init__(self, node: Node, name: str, camera: Camera) -> None:
        self.drawn, self.seconds = 0, 0.0
        self._node = node
        self._name = name
        self._size = camera.size
        self._frame = f"{name}_optical"
        self._info = camera_info(camera, self._frame)
        self._colours, self._depths, self._labels = (
            Outlet(node, f"camera/{name}{kind}") for kind in ("", "/depth", "/segmentation")
        )
        self._place = transforms([("world", name, view.ORIGIN)])
        self._places = None
        if view.turns(camera):
            self._places = node.create_publisher(TFMessage, "tf", 100, event_callbacks=NO_CALLBACKS)

    # Made when they are drawn into first: most cameras are there to be looked at now and then.

    @cached_property
    def picture(self) -> Picture:
        """rgb8."""
        return Picture(self._size, self._frame)

    @cached_property
    def depth(self) -> Picture:
        """32FC1, m."""
        return Picture(self._size, self._frame, "32FC1")

    @cached_property
    def labels(self) -> Picture:
        """16UC1, numbers of objects."""
        return Picture(self._size, self._frame, "16UC1")

    def watched(self) -> bool:
        """Whether its picture has to be drawn: somebody listens to it, or to its camera_info and to nothing else."""
        if self._colours.images.get_subscription_count():
            return True
        return bool(self._colours.infos.get_subscription_count()) and not self.measured()

    def measured(self) -> bool:
        """Whether anybody listens to its depths or labels."""
        return self._depths.heard() or self._labels.heard()

    def publish(self, stamp: int, place: Array, image: bytes) -> None:
        """Publishes a picture's message with its stamp in ns, taken from the matrix `place` in the world."""
        self._publish_place(stamp, place)
        self._colours.images.publish(image)

    def publish_ranges(self, stamp: int, place: Array | None, depth: bytes, labels: bytes) -> None:
        """The same for the messages of both; `place` is None where `publish` has had it at the same stamp."""
        if place is not None:
            self._publish_place(stamp, place)
        for outlet, image in ((self._depths, depth), (self._labels, labels)):
            if outlet.heard():
                outlet.infos.publish(bytes(self._info))
                outlet.images.publish(image)

    def _publish_place(self, stamp: int, place: Array) -> None:
        if self._places is not None:
            self._place.stamp(stamp)
            self._place.write("pose", view.pose_of(place))
            self._places.publish(bytes(self._place))
        self._info.stamp(stamp)
        self._colours.infos.publish(bytes(self._info))

    def report(self) -> list[KeyValue]:
        """Mean ms per picture since the last report; nothing if none was drawn."""
        drawn, seconds = self.drawn, self.seconds
        self.drawn, self.seconds = 0, 0.0
        return [KeyValue(key=f"ms per frame of {self._name}", value=f"{1000 * seconds / drawn:.2f}")] if drawn else []

    def close(self) -> None:
        """Ends its topics."""
        for outlet in (self._colours, self._depths, self._labels):
            outlet.close(self._node)
        if self._places is not None:
            self._node.destroy_publisher(self._places)


def rigid_transforms(cameras: dict[str, Camera]) -> bytes:
    """A TFMessage of how cameras that do not turn hang on their parents, and all optical frames on their cameras."""
    links: list[tuple[str, str, Array]] = []
    for name, camera in cameras.items():
        if not view.turns(camera):
            links.append((camera.parent or "world", name, view.pose(camera.pose)))
        links.append((name, f"{name}_optical", view.OPTICAL))
    return bytes(transforms(links))
