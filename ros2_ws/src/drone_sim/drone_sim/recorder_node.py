"""Records topics into a bag, byte for byte as they were received."""

import re
import sys
from functools import partial
from pathlib import Path
from typing import TypeVar

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

from drone_sim.bag import BagError, BagWriter, Topic
from drone_sim.node.process import run
from drone_sim.wire.message_types import UnknownTypeError, definition, message_class, type_hash

T = TypeVar("T")

PICTURES = r"/camera/[^/]+/(image_raw|camera_info)$"


class RecorderNode(Node):
    """Subscribes to everything that is published, and writes what arrives with the time at which it did.

    The times are the node's: simulated ones with use_sim_time, 0 before the first /clock; so the bags of two runs
    can be laid side by side. Raises BagError if there is no bag to be written.
    """

    def __init__(self) -> None:
        super().__init__("drone_recorder")
        self._log = self.get_logger()
        path = self._parameter("path", "", "folder of the new bag; one that exists is never overwritten")
        storage = self._parameter("storage", "mcap", "how the bag keeps messages: mcap or sqlite3")
        topics = self._parameter("topics", [""], "topics to record; without any, all that are published at any time")
        exclude = self._parameter(
            "exclude", PICTURES,
            "regular expression; a topic in which it is found is not recorded, unless 'topics' names it. "
            "By default the cameras' pictures, because a camera is drawn only when somebody listens",
        )
        if not path:
            raise BagError("path: a bag needs a folder; give one with -p path:=out/run1")
        try:
            self._exclude = re.compile(exclude) if exclude else None
        except re.error as error:
            raise BagError(f"exclude: '{exclude}' is no regular expression: {error}") from None
        self._wanted = {self.resolve_topic_name(name) for name in topics if name}
        self._settled: set[str] = set()  # topics that are recorded or never will be
        self.bag = BagWriter(Path(path).expanduser(), storage)

        self._diagnostics = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        steady = Clock(clock_type=ClockType.STEADY_TIME)  # simulated time may stand still
        self.create_timer(0.25, self._look_around, clock=steady)
        self.create_timer(1.0, self._flush, clock=steady)
        self._look_around()
        self._log.info(f"records into {path}")

    def destroy_node(self) -> None:
        """Closes the bag, too."""
        self.bag.close()
        super().destroy_node()

    def _parameter(self, name: str, default: T, description: str) -> T:
        descriptor = ParameterDescriptor(description=description, read_only=True)
        value: T = self.declare_parameter(name, default, descriptor).value
        return value

    def _look_around(self) -> None:
        """Subscribes to the topics that have come up since the last time."""
        for name, types in self.get_topic_names_and_types():
            if name in self._settled or not self._is_wanted(name):
                continue
            publishers = self.get_publishers_info_by_topic(name)
            if not publishers:
                continue
            self._settled.add(name)
            if len(types) > 1:
                self._log.warning(f"{name}: has several types ({', '.join(types)}) and is not recorded")
                continue
            try:
                self._subscribe(name, types[0], publishers)
            except UnknownTypeError as error:
                self._log.warning(f"{name}: is not recorded: {error}")

    def _is_wanted(self, name: str) -> bool:
        if self._wanted:
            return name in self._wanted
        hidden = "/_" in name
        return not hidden and not (self._exclude and self._exclude.search(name))

    def _subscribe(self, name: str, kind: str, publishers: list[TopicEndpointInfo]) -> None:
        """Asks for as much as all publishers of a topic offer."""
        offers = [publisher.qos_profile for publisher in publishers]
        reliable = all(offer.reliability == ReliabilityPolicy.RELIABLE for offer in offers)
        kept = all(offer.durability == DurabilityPolicy.TRANSIENT_LOCAL for offer in offers)
        qos = QoSProfile(
            depth=100 if reliable else 10,
            reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE,
        )
        topic = Topic(name, kind, definition(kind), type_hash(kind), tuple(_offered(offer) for offer in offers))
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


def _offered(profile: QoSProfile) -> Qos:
    """The QoS of a publisher, in rosbags' words; the numbers of the policies are the same."""
    return Qos(
        QosHistory(profile.history.value), profile.depth, QosReliability(profile.reliability.value),
        QosDurability(profile.durability.value), _time(profile.deadline), _time(profile.lifespan),
        QosLiveliness(profile.liveliness.value), _time(profile.liveliness_lease_duration),
        profile.avoid_ros_namespace_conventions,
    )


def _time(duration: Duration) -> QosTime:
    return QosTime(*divmod(duration.nanoseconds, 1_000_000_000))


def main(args: list[str] | None = None) -> int:
    return run("drone_recorder", lambda _: RecorderNode(), args, BagError)


if __name__ == "__main__":
    sys.exit(main())
