"""A run of start.py with a recorder: the bag holds the published messages, byte for byte."""

import os
import signal
import sys
from pathlib import Path

import pytest
from geometry_msgs.msg import PoseStamped
from rosbags.highlevel import AnyReader
from tf2_msgs.msg import TFMessage

from .live import Graph, NodeProcess, Spawn

MEADOW = Path(__file__).with_name("meadow.yaml")
START = Path(__file__).parents[2] / "ros2_ws" / "start.py"
DISCOVERY = 10  # messages
HEARD = {"/user_drone/pose": PoseStamped, "/television/pose": PoseStamped, "/tf": TFMessage}


def record(spawn: Spawn, folder: Path, *options: str) -> NodeProcess:
    """A run that records into folder/bag."""
    return spawn.command("start.py", [
        sys.executable, str(START), "--scene", str(MEADOW), "--record", str(folder / "bag"), "--no-teleop",
        "--no-render", "--log-dir", str(folder / "log"), *options,
    ])


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_the_bag_holds_what_was_heard(graph: Graph, spawn: Spawn, tmp_path: Path, storage: str) -> None:
    run = record(spawn, tmp_path, "--storage", storage)
    heard = {topic: graph.listen(kind, topic, raw=True) for topic, kind in HEARD.items()}
    graph.wait_for((tmp_path / "bag").is_dir, "the bag")
    graph.wait_for(lambda: all(len(messages) >= 100 for messages in heard.values()), "100 messages of each topic")
    assert run.interrupt() == 0

    kept: dict[str, list[bytes]] = {topic: [] for topic in HEARD}
    with AnyReader([tmp_path / "bag"]) as reader:
        types = {connection.topic: connection.msgtype for connection in reader.connections}
        for connection, _, data in reader.messages():
            if connection.topic in kept:
                kept[connection.topic].append(bytes(data))
    assert {"/clock", "/scene", "/tf_static", "/collisions", "/user_drone/odom"} <= types.keys()
    for topic, arrived in heard.items():
        assert types[topic] == f"{HEARD[topic].__module__.split('.')[0]}/msg/{HEARD[topic].__name__}"
        live = [bytes(message) for message in arrived]
        # Either may have joined first or left last; in between nothing is missing or different.
        in_bag = set(kept[topic])
        # The first messages may be lost while either is still being discovered.
        common = [message for message in live if message in in_bag][DISCOVERY:]
        assert len(common) > 50
        for messages in (live, kept[topic]):
            first = messages.index(common[0])
            assert messages[first : first + len(common)] == common


def test_the_bag_of_a_killed_recorder_is_completed(graph: Graph, spawn: Spawn, tmp_path: Path) -> None:
    run = record(spawn, tmp_path)
    heard = graph.listen(PoseStamped, "user_drone/pose", raw=True)
    graph.wait_for(lambda: len(heard) >= 150, "150 poses")
    os.kill(graph.wait_for(lambda: run.child("drone_sim.recorder_node"), "the recorder"), signal.SIGKILL)
    graph.wait_for(lambda: "drone_recorder was killed by SIGKILL" in run.output(), "the death to be reported")
    assert run.interrupt() == 1
    assert "recovered" in run.output().splitlines()[-1]
    with AnyReader([tmp_path / "bag"]) as reader:
        poses = [connection for connection in reader.connections if connection.topic == "/user_drone/pose"]
        assert {bytes(data) for _, _, data in reader.messages(poses)} & {bytes(message) for message in heard}
