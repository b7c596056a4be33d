"""Bags: every reader returns the messages that were written, even after the writer was killed."""

import multiprocessing
import os
import resource
import signal
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from drone_sim.bag import BagError, BagWriter, Topic, recover
from drone_sim.wire.message_types import UnknownTypeError, definition, message_class, type_hash

STORE = get_typestore(Stores.ROS2_JAZZY)
TWIST = "geometry_msgs/msg/Twist"
TWIST_HASH = "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"  # of public Jazzy
TOPIC = Topic("/cmd_vel", TWIST, definition(TWIST), type_hash(TWIST))
STORAGES = pytest.mark.parametrize("storage", ["mcap", "sqlite3"])


def messages(count: int) -> list[bytes]:
    """Different Twists, serialized."""
    vector, twist = STORE.types["geometry_msgs/msg/Vector3"], STORE.types[TWIST]
    return [
        bytes(STORE.serialize_cdr(twist(vector(float(i), 0.0, 0.0), vector(0.0, 0.0, -i / 7)), TWIST))
        for i in range(count)
    ]


def read(path: Path) -> list[tuple[str, int, bytes]]:
    with Reader(path) as bag:
        return [(connection.topic, time, bytes(data)) for connection, time, data in bag.messages()]


def write_and_die(path: Path, storage: str, repeats: int = 1, largest_file: int | None = None) -> None:
    """Writes 35 messages so many times, with a flush after every tenth one, and ends as by kill -9.

    largest_file: bytes that a file of this process may have.
    """
    if largest_file is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file))
    bag = BagWriter(path, storage)
    bag.add_topic(TOPIC)
    for time, data in enumerate(messages(35) * repeats):
        bag.write(TOPIC.name, time, data)
        if time % 10 == 9:
            bag.flush()
    os.kill(os.getpid(), signal.SIGKILL)


def exit_status(*arguments: object) -> int | None:
    """The exit status of a process that runs `write_and_die`, -N after signal N."""
    process = multiprocessing.get_context("fork").Process(target=write_and_die, args=arguments)
    process.start()
    process.join()
    return process.exitcode


def killed(path: Path, storage: str) -> None:
    """A bag whose writer was killed; its last five messages were not flushed."""
    assert exit_status(path, storage) == -signal.SIGKILL


def test_definitions_and_hashes_are_those_of_public_jazzy() -> None:
    assert type_hash(TWIST) == TWIST_HASH
    for name in ("tf2_msgs/msg/TFMessage", "sensor_msgs/msg/Image", "nav_msgs/msg/Odometry"):
        assert type_hash(name) == STORE.hash_rihs01(name)
    assert "MSG: geometry_msgs/Vector3\n" in definition(TWIST)
    assert message_class(TWIST).__name__ == "Twist"


@pytest.mark.parametrize("name", ["geometry_msgs/msg/Twits", "nowhere/msg/Twist", "Twist", "geometry_msgs/srv/Twist"])
def test_an_unknown_type_is_named(name: str) -> None:
    with pytest.raises(UnknownTypeError, match=name):
        message_class(name)
    with pytest.raises(UnknownTypeError, match=name):
        type_hash(name)


@STORAGES
def test_what_goes_in_comes_out_of_rosbags(tmp_path: Path, storage: str) -> None:
    path = tmp_path / "bag"
    with BagWriter(path, storage) as bag:
        bag.add_topic(TOPIC)
        for time, data in enumerate(messages(100)):
            bag.write(TOPIC.name, time * 1000, data)
    assert read(path) == [(TOPIC.name, time * 1000, data) for time, data in enumerate(messages(100))]
    with AnyReader([path]) as reader:
        assert reader.connections[0].digest == TWIST_HASH
        assert reader.duration == 99_001
        connection, _, data = list(reader.messages())[7]
        assert reader.deserialize(data, connection.msgtype).linear.x == 7.0


def test_what_goes_in_comes_out_of_mcap_decoded(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag") as bag:
        bag.add_topic(TOPIC)
        for time, data in enumerate(messages(100)):
            bag.write(TOPIC.name, time, data)
    with (tmp_path / "bag" / "bag.mcap").open("rb") as stream:
        decoded = list(make_reader(stream, True, [DecoderFactory()]).iter_decoded_messages())
    assert [each.message.data for each in decoded] == messages(100)
    assert [each.decoded_message.linear.x for each in decoded] == list(range(100))
    assert decoded[0].channel.metadata["topic_type_hash"] == TWIST_HASH


@STORAGES
def test_an_empty_bag_opens(tmp_path: Path, storage: str) -> None:
    BagWriter(tmp_path / "bag", storage).close()
    assert read(tmp_path / "bag") == []


@STORAGES
def test_after_a_kill_all_whole_chunks_are_there(tmp_path: Path, storage: str) -> None:
    path = tmp_path / "bag"
    killed(path, storage)
    assert recover(path)
    assert read(path) == [(TOPIC.name, time, data) for time, data in enumerate(messages(30))]
    with Reader(path) as bag:
        assert bag.message_count == 30
        assert bag.connections[0].digest == TWIST_HASH
    assert not recover(path)
    assert sorted(each.suffix for each in path.iterdir()) == [".db3" if storage == "sqlite3" else ".mcap", ".yaml"]


def test_wherever_the_file_breaks_off_the_chunks_before_are_recovered(tmp_path: Path) -> None:
    killed(tmp_path / "bag", "mcap")
    whole = (tmp_path / "bag" / "bag.mcap").read_bytes()
    counts = set()
    for size in range(len(whole), 30, -37):
        (tmp_path / "bag" / "bag.mcap").write_bytes(whole[:size])
        assert recover(tmp_path / "bag")
        kept = [data for _, _, data in read(tmp_path / "bag")]
        assert kept == messages(len(kept))
        counts.add(len(kept))
    assert counts == {0, 10, 20, 30}


def test_a_bag_that_is_being_written_is_left_alone(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag"), pytest.raises(BagError, match="another process is writing"):
        recover(tmp_path / "bag")


def test_a_bag_is_never_overwritten(tmp_path: Path) -> None:
    with pytest.raises(BagError, match="expected a new folder"):
        BagWriter(tmp_path)
    with pytest.raises(BagError, match="mcap, sqlite3"):
        BagWriter(tmp_path / "bag", "bag3")
    assert not (tmp_path / "bag").exists()


@STORAGES
def test_a_full_disk_is_reported_in_one_line(tmp_path: Path, storage: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert exit_status(tmp_path / "bag", storage, 100, 50_000) == 1
    last = capfd.readouterr().err.splitlines()[-1]
    assert last.startswith(f"drone_sim.bag.storage.BagError: {tmp_path / 'bag'}: ")
    assert recover(tmp_path / "bag")
    assert len(read(tmp_path / "bag")) > 100
