"""The recorder as a process: it keeps what others publish, byte for byte, also when it is killed."""

import signal
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import Reader
from sensor_msgs.msg import Image
from std_msgs.msg import String

from drone_sim.bag import recover

from .live import Graph, Spawn

RECORDER = "drone_sim.recorder_node"


def read(path: Path, topic: str) -> list[bytes]:
    with Reader(path) as bag:
        return [bytes(data) for connection, _, data in bag.messages() if connection.topic == topic]


def twists(count: int) -> list[Twist]:
    sent = []
    for i in range(count):
        sent.append(Twist())
        sent[-1].linear.x = float(i)
    return sent


def recorded_messages(heard: list[Any]) -> int:
    """How many messages the recorder has flushed, by its diagnostics."""
    values = {pair.key: pair.value for array in heard for pair in array.status[0].values}
    return int(values.get("messages", 0))


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_bytes_published_are_bytes_recorded(
    graph: Graph, spawn: Spawn, tmp_path: Path, storage: str, end: signal.Signals
) -> None:
    # DDS pads what it sends to whole words of four bytes; these messages have whole words.
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    scene = graph.node.create_publisher(String, "latched", latched)
    scene.publish(String(data="said before the recorder begins"))
    picture = graph.node.create_publisher(Image, "camera/chase/image_raw", qos_profile_sensor_data)
    recorder = spawn(RECORDER, path=tmp_path / "bag", storage=storage)
    command = graph.publisher(Twist, "cmd_vel")
    for message in twists(50):
        command.publish(message)
    heard = graph.listen(DiagnosticArray, "diagnostics")
    graph.wait_for(lambda: recorded_messages(heard) >= 51, "51 messages in the bag")
    assert picture.get_subscription_count() == 0  # a camera is not drawn for the sake of the recorder
    recorder.send(end)
    assert recorder.wait() == 0

    assert read(tmp_path / "bag", "/cmd_vel") == [serialize_message(message) for message in twists(50)]
    assert read(tmp_path / "bag", "/latched") == [serialize_message(String(data="said before the recorder begins"))]
    with Reader(tmp_path / "bag") as bag:
        digests = {connection.topic: connection.digest for connection in bag.connections}
    (publisher,) = graph.node.get_publishers_info_by_topic("/cmd_vel")
    assert digests["/cmd_vel"] == str(publisher.topic_type_hash)
    for each in (scene, picture, command):
        graph.node.destroy_publisher(each)


def test_after_kill_9_the_bag_is_recovered(graph: Graph, spawn: Spawn, tmp_path: Path) -> None:
    recorder = spawn(RECORDER, path=tmp_path / "bag", topics=["cmd_vel"])
    command = graph.publisher(Twist, "cmd_vel")
    heard = graph.listen(DiagnosticArray, "diagnostics")
    with graph.repeating(command, Twist(), rate=50.0):
        graph.wait_for(lambda: recorded_messages(heard) >= 100, "100 messages in the bag")
    flushed = recorded_messages(heard)
    recorder.send(signal.SIGKILL)
    assert recorder.wait() == -signal.SIGKILL
    assert recover(tmp_path / "bag")
    kept = read(tmp_path / "bag", "/cmd_vel")
    assert len(kept) >= flushed
    assert set(kept) == {serialize_message(Twist())}


def test_a_folder_that_exists_is_refused_in_one_line(spawn: Spawn, tmp_path: Path) -> None:
    recorder = spawn(RECORDER, path=tmp_path)
    assert recorder.wait() == 1
    assert recorder.output().splitlines() == [
        f"drone_recorder: {tmp_path}: expected a new folder, got an existing one; bags are never overwritten"
    ]
