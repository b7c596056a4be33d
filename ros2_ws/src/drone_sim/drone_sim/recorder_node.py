"""The recorder node: writes the messages of topics into a bag, byte for byte as received."""

import re
import sys
from functools import partial
from pathlib import Path

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

from drone_sim.bag import BagError, BagWriter, Topic
from drone_sim.node.parameters import ParameterError, Parameters
from drone_sim.node.process import run
from drone_sim.node.qos import strongest_common
from drone_sim.wire.message_types import UnknownTypeError, definition, message_class, type_hash

IMAGES = r"/camera/[^/]+/(image_raw|camera_info)$"


class RecorderNode(Node):
    """Subscribes to every published topic and writes its messages with their time of arrival.

    Times are the node's: simulated with use_sim_time, 0 before the first /clock, so that the bags of two runs can be
    compared. Raises BagError if the bag cannot be written, ParameterError for a wrong parameter.
    """

    def __init__(self) -> None:
        super().__init__("drone_recorder")
        self._log = self.get_logger()
        read = Parameters(self)
        path = read.text("path", "", "folder of the new bag; an existing folder is never overwritten")
        storage = read.text("storage", "mcap", "file format of the bag: mcap or sqlite3")
        topics = read.texts("topics", "topics to record; if empty, all that are published at any time")
        exclude = read.text(
            "exclude", IMAGES,
            "regular expression; matching topics are not recorded unless 'topics' names them. By default the cameras' "
            "images, because the renderer draws a camera only while it has subscribers",
        )
        if not path:
            raise ParameterError("parameter path: expected a folder, such as -p path:=out/run1, got ''")
        try:
            self._exclude = re.compile(exclude) if exclude else None
        except re.error as error:
            raise ParameterError(
                f"parameter exclude: expected a regular expression, got '{exclude}': {error}") from None
        self._wanted = {self.resolve_topic_name(name) for name in topics}
        self._decided: set[str] = set()  # topics that are recorded, or never will be
        self.bag = BagWriter(Path(path).expanduser(), storage)

        self._diagnostics = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        steady = Clock(clock_type=ClockType.STEADY_TIME)  # simulated time may be paused
        self.create_timer(0.25, self._find_topics, clock=steady)
        self.create_timer(1.0, self._flush, clock=steady)
        self._find_topics()
        self._log.info(f"recording into {path}")

    def destroy_node(self) -> None:
        """Closes the bag as well."""
        self.bag.close()
        super().destroy_node()

    def _find_topics(self) -> None:
        """Subscribes to topics that have appeared since the last call."""
        for name, types in self.get_topic_names_and_types():
            if name in self._decided or not self._is_wanted(name):
                continue
            publishers = self.get_publishers_info_by_topic(name)
            if not publishers:
                continue
            self._decided.add(name)
            if len(types) > 1:
                self._log.warning(f"{name}: expected one type, got {', '.join(types)}; not recorded")
                continue
            try:
                self._subscribe(name, types[0], publishers)
            except UnknownTypeError as error:
                self._log.warning(f"{name}: not recorded: {error}")

    def _is_wanted(self, name: str) -> bool:
        if self._wanted:
            return name in self._wanted
        hidden = "/_" in name
        return not hidden and not (self._exclude and self._exclude.search(name))

    def _subscribe(self, name: str, kind: str, publishers: list[TopicEndpointInfo]) -> None:
        """Starts to record a topic, whose publishers so far are given."""
        offered = tuple(_bag_qos(publisher.qos_profile) for publisher in publishers)
        topic = Topic(name, kind, definition(kind), type_hash(kind), offered)
        qos = strongest_common(publishers)
        self.create_subscription(message_class(kind), name, partial(self._record, name), qos, raw=True)
        self.bag.add_topic(topic)

    def _record(self, name: str, data: bytes) -> None:
        self.bag.write(name, self.get_clock().now().nanoseconds, data)

    def _flush(self) -> None:
        self.bag.flush()
        status = DiagnosticStatus(name=f"{self.get_name()}: bag", hardware_id=str(self.bag.path), message="recording")
        for key in ("topics", "messages", "bytes"):
            status.values.append(KeyValue(key=key, value=str(getattr(self.bag, key))))
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(array)


def _bag_qos(profile: QoSProfile) -> Qos:
    """The QoS of a publisher as rosbags' type; both number the policies alike."""
    return Qos(
        QosHistory(profile.history.value), profile.depth, QosReliability(profile.reliability.value),
        QosDurability(profile.durability.value), _time(profile.deadline), _time(profile.lifespan),
        QosLiveliness(profile.liveliness.value), _time(profile.liveliness_lease_duration),
        profile.avoid_ros_namespace_conventions,
    )


def _time(duration: Duration) -> QosTime:
    return QosTime(*divmod(duration.nanoseconds, 1_000_000_000))


def main(args: list[str] | None = None) -> int:
    """Runs the node until a signal ends it; returns the exit status."""
    return run("drone_recorder", lambda _: RecorderNode(), args, BagError)


if __name__ == "__main__":
    sys.exit(main())
