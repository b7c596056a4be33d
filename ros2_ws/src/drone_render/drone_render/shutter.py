"""One camera in the graph: its topics, the bytes of its messages, and what its pictures took."""

import threading
from dataclasses import dataclass, field

from diagnostic_msgs.msg import KeyValue
from PIL import Image as PillowImage
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image
from tf2_msgs.msg import TFMessage

from drone_render import view
from drone_render.image import Picture, camera_info, transforms
from drone_render.view import Array
from drone_sim.look import Camera


@dataclass
class Request:
    """Somebody waits for a picture of the selected camera."""

    done: threading.Event = field(default_factory=threading.Event)
    image: PillowImage.Image | None = None
    name: str = ""


class Shutter:
    """Publishes what is drawn into `picture`, `depth` and `labels`: camera/<name>/image_raw, depth/image_raw,
    segmentation/image_raw and camera_info, and tf of cameras that turn."""

    def __init__(self, node: Node, name: str, camera: Camera) -> None:
        frame = f"{name}_optical"
        self.picture = Picture(camera.size, frame)
        self.depth, self.labels = (Picture(camera.size, frame, encoding) for encoding in ("32FC1", "16UC1"))
        self.drawn, self.seconds = 0, 0.0
        self._node = node
        self._name = name
        self._info = camera_info(camera, frame)
        self._images = node.create_publisher(Image, f"camera/{name}/image_raw", qos_profile_sensor_data)
        self._depths = node.create_publisher(Image, f"camera/{name}/depth/image_raw", qos_profile_sensor_data)
        self._labels = node.create_publisher(Image, f"camera/{name}/segmentation/image_raw", qos_profile_sensor_data)
        self._infos = node.create_publisher(CameraInfo, f"camera/{name}/camera_info", qos_profile_sensor_data)
        self._place = transforms([("world", name, view.ORIGIN)])
        self._places = node.create_publisher(TFMessage, "tf", 100) if view.turns(camera) else None

    def watched(self) -> bool:
        """Whether anybody listens to its picture."""
        return bool(self._images.get_subscription_count() or self._infos.get_subscription_count())

    def measured(self) -> bool:
        """Whether anybody listens to its depths or labels."""
        return bool(self._depths.get_subscription_count() or self._labels.get_subscription_count())

    def publish(self, stamp: int, place: Array, image: bytes) -> None:
        """Publishes a picture's message with its stamp in ns, taken from the matrix `place` in the world."""
        self._publish_place(stamp, place)
        self._images.publish(image)

    def publish_ranges(self, stamp: int, place: Array, depth: bytes, labels: bytes) -> None:
        """The same for the messages of both."""
        self._publish_place(stamp, place)
        self._depths.publish(depth)
        self._labels.publish(labels)

    def _publish_place(self, stamp: int, place: Array) -> None:
        if self._places is not None:
            self._place.stamp(stamp)
            self._place.write("pose", view.pose_of(place))
            self._places.publish(bytes(self._place))
        self._info.stamp(stamp)
        self._infos.publish(bytes(self._info))

    def report(self) -> list[KeyValue]:
        """Mean ms per picture since the last report; nothing if none was drawn."""
        drawn, seconds = self.drawn, self.seconds
        self.drawn, self.seconds = 0, 0.0
        return [KeyValue(key=f"ms per frame of {self._name}", value=f"{1000 * seconds / drawn:.2f}")] if drawn else []

    def close(self) -> None:
        """Ends its topics."""
        for publisher in (self._images, self._depths, self._labels, self._infos, self._places):
            if publisher is not None:
                self._node.destroy_publisher(publisher)


def rigid_transforms(cameras: dict[str, Camera]) -> bytes:
    """A TFMessage of how cameras that do not turn hang on their parents, and all optical frames on their cameras."""
    links: list[tuple[str, str, Array]] = []
    for name, camera in cameras.items():
        if not view.turns(camera):
            links.append((camera.parent or "world", name, view.pose(camera.pose)))
        links.append((name, f"{name}_optical", view.OPTICAL))
    return bytes(transforms(links))
