"""Publishes the topics of one camera, and keeps its drawing times."""

from functools import cached_property

from diagnostic_msgs.msg import KeyValue
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image
from tf2_msgs.msg import TFMessage

from drone_engine.arrays import Floats
from drone_engine.scene.picture import Camera
from drone_render.frame.poses import ORIGIN, pose, pose_from_matrix
from drone_render.frame.view import OPTICAL, moves_in_parent
from drone_render.node.camera_messages import ImageMessage, camera_info, transforms
from drone_sim.node.qos import NO_CALLBACKS


class ImageTopic:
    """image_raw and camera_info below one name, as image_transport and depth_image_proc expect them."""

    def __init__(self, node: Node, topic: str) -> None:
        self.images = node.create_publisher(
            Image, f"{topic}/image_raw", qos_profile_sensor_data, event_callbacks=NO_CALLBACKS)
        self.infos = node.create_publisher(
            CameraInfo, f"{topic}/camera_info", qos_profile_sensor_data, event_callbacks=NO_CALLBACKS)

    def has_subscribers(self) -> bool:
        """Whether either topic has a subscriber."""
        return bool(self.images.get_subscription_count() or self.infos.get_subscription_count())

    def close(self, node: Node) -> None:
        """Ends both topics."""
        node.destroy_publisher(self.images)
        node.destroy_publisher(self.infos)


class CameraPublisher:
    """The topics camera/<name>, camera/<name>/depth and camera/<name>/segmentation of a camera, and the tf of a camera
    that moves in its parent's frame. Pictures are drawn into `picture`, `depth` and `labels`."""

    def __init__(self, node: Node, name: str, camera: Camera) -> None:
        self.drawn, self.seconds = 0, 0.0
        """Number of pictures drawn since the last report, and the time that they took in s."""
        self._node = node
        self._name = name
        self._size = camera.size
        self._frame = f"{name}_optical"
        self._info = camera_info(camera, self._frame)
        self._color, self._depth, self._labels = (
            ImageTopic(node, f"camera/{name}{kind}") for kind in ("", "/depth", "/segmentation")
        )
        self._transform = transforms([("world", name, ORIGIN)])
        self._transforms = None
        if moves_in_parent(camera):
            self._transforms = node.create_publisher(TFMessage, "tf", 100, event_callbacks=NO_CALLBACKS)

    # Images are allocated at first use: most cameras are rarely subscribed to.

    @cached_property
    def picture(self) -> ImageMessage:
        """Color, rgb8."""
        return ImageMessage(self._size, self._frame)

    @cached_property
    def depth(self) -> ImageMessage:
        """Depth in m, 32FC1."""
        return ImageMessage(self._size, self._frame, "32FC1")

    @cached_property
    def labels(self) -> ImageMessage:
        """Numbers of objects, 16UC1."""
        return ImageMessage(self._size, self._frame, "16UC1")

    def needs_picture(self) -> bool:
        """Whether color has to be drawn: for subscribers of its image, or of its camera_info and nothing else."""
        if self._color.images.get_subscription_count():
            return True
        return bool(self._color.infos.get_subscription_count()) and not self.needs_depth()

    def needs_depth(self) -> bool:
        """Whether depth or labels have a subscriber."""
        return self._depth.has_subscribers() or self._labels.has_subscribers()

    def publish(self, stamp: int, matrix: Floats, image: bytes) -> None:
        """Publishes a picture; stamp in ns; matrix: (4, 4) of the camera in the world."""
        self._publish_camera(stamp, matrix)
        self._color.images.publish(image)

    def publish_depth(self, stamp: int, matrix: Floats | None, depth: bytes, labels: bytes) -> None:
        """Publishes depth and labels; matrix: as in `publish`, or None if it is published already for this stamp."""
        if matrix is not None:
            self._publish_camera(stamp, matrix)
        for topic, image in ((self._depth, depth), (self._labels, labels)):
            if topic.has_subscribers():
                topic.infos.publish(bytes(self._info))
                topic.images.publish(image)

    def _publish_camera(self, stamp: int, matrix: Floats) -> None:
        """Publishes the camera's transform, if it changes, and camera_info."""
        if self._transforms is not None:
            self._transform.stamp(stamp)
            self._transform.write("pose", pose_from_matrix(matrix))
            self._transforms.publish(bytes(self._transform))
        self._info.stamp(stamp)
        self._color.infos.publish(bytes(self._info))

    def report(self) -> list[KeyValue]:
        """Mean time per picture in ms since the last report; empty if none was drawn."""
        drawn, seconds = self.drawn, self.seconds
        self.drawn, self.seconds = 0, 0.0
        return [KeyValue(key=f"ms per frame of {self._name}", value=f"{1000 * seconds / drawn:.2f}")] if drawn else []

    def close(self) -> None:
        """Ends all topics of the camera."""
        for topic in (self._color, self._depth, self._labels):
            topic.close(self._node)
        if self._transforms is not None:
            self._node.destroy_publisher(self._transforms)


def static_transforms(cameras: dict[str, Camera]) -> bytes:
    """A TFMessage with the cameras that are fixed in their parent's frame, and the optical frames of all cameras."""
    links: list[tuple[str, str, Floats]] = []
    for name, camera in cameras.items():
        if not moves_in_parent(camera):
            links.append((camera.parent or "world", name, pose(camera.pose)))
        links.append((name, f"{name}_optical", OPTICAL))
    return bytes(transforms(links))
