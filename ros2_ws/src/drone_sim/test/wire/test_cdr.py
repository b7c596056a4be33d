"""Bytes written from arrays equal those that ROS itself writes, and are read back as what they were."""

import numpy as np
import pytest
from drone_interfaces.msg import CollisionEvent, CollisionEvents
from geometry_msgs.msg import PoseStamped, TransformStamped
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

from drone_sim.wire import layouts
from drone_sim.wire.cdr import Layout, read_transforms

TIME_NS = 1_234_567_890_123
POSE = np.array([1.5, -2.25, 3.125, 0.1, 0.2, 0.3, 0.9])


def names(count: int) -> list[str]:
    """Names of every length, so that every padding occurs."""
    return ["n" * (i % 9 + 1) + "é" * (i % 2) for i in range(count)]


def assert_same(data: bytes, reference: object) -> None:
    """Equal once read, and as long; the padding that ROS writes is not set to anything."""
    assert deserialize_message(data, type(reference)) == reference
    assert len(data) == len(serialize_message(reference))


def set_stamp(stamp: object) -> None:
    stamp.sec, stamp.nanosec = divmod(TIME_NS, 1_000_000_000)


def set_pose(position: object, rotation: object, pose: np.ndarray) -> None:
    position.x, position.y, position.z, rotation.x, rotation.y, rotation.z, rotation.w = map(float, pose)


def test_clock() -> None:
    message = layouts.clock()
    message.stamp(TIME_NS)
    reference = Clock()
    set_stamp(reference.clock)
    assert_same(bytes(message), reference)


@pytest.mark.parametrize("frame", ["", "w", "world", "a_long_frame_name"])
def test_pose_stamped(frame: str) -> None:
    message = layouts.pose_stamped(frame)
    message.stamp(TIME_NS)
    message.write("pose", POSE)
    reference = PoseStamped()
    reference.header.frame_id = frame
    set_stamp(reference.header.stamp)
    set_pose(reference.pose.position, reference.pose.orientation, POSE)
    assert_same(bytes(message), reference)


def test_odometry() -> None:
    message = layouts.odometry("world", "user_drone")
    message.stamp(TIME_NS)
    message.write("pose", POSE)
    message.write("twist", np.arange(6.0))
    back = deserialize_message(bytes(message), Odometry)
    assert (back.header.frame_id, back.child_frame_id) == ("world", "user_drone")
    assert back.pose.pose.orientation.w == POSE[6]
    assert (back.twist.twist.linear.y, back.twist.twist.angular.z) == (1.0, 5.0)
    assert_same(bytes(message), back)


@pytest.mark.parametrize("count", [0, 1, 2, 17])
def test_transforms_both_ways(count: int) -> None:
    rng = np.random.default_rng(count)
    poses = rng.normal(size=(count, 7))
    message = layouts.transforms(["world"] * count, names(count))
    message.stamp(TIME_NS)
    if count:
        message.write("pose", poses)
    reference = TFMessage()
    for name, pose in zip(names(count), poses, strict=True):
        transform = TransformStamped()
        transform.header.frame_id, transform.child_frame_id = "world", name
        set_stamp(transform.header.stamp)
        set_pose(transform.transform.translation, transform.transform.rotation, pose)
        reference.transforms.append(transform)
    data = serialize_message(reference)
    assert_same(bytes(message), reference)
    for _ in range(2):  # measured the first time, remembered the second
        read = read_transforms(data)
        assert read.children == tuple(names(count))
        assert read.stamp_ns == (TIME_NS if count else 0)
        np.testing.assert_array_equal(read.poses, poses)


def test_transforms_of_equal_length_and_other_names_are_told_apart() -> None:
    for name in ("ab", "cd", "ab"):
        message = layouts.transforms(["world"], [name])
        assert read_transforms(bytes(message)).children == (name,)


@pytest.mark.parametrize("data", [b"", b"\0\1\0\0", b"\0\1\0\0\5\0\0\0", b"\0\0\0\0" + bytes(100)])
def test_other_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(ValueError):
        read_transforms(data)


@pytest.mark.parametrize("count", [1, 3, 8])
def test_joint_state(count: int) -> None:
    message = layouts.joint_state(names(count))
    message.stamp(TIME_NS)
    message.write("position", np.arange(count))
    message.write("velocity", -np.arange(count))
    reference = JointState(name=names(count), position=np.arange(float(count)).tolist(),
                           velocity=(-np.arange(float(count))).tolist())
    set_stamp(reference.header.stamp)
    assert_same(bytes(message), reference)


@pytest.mark.parametrize("frame", ["world", "w", "map", "a_frame"])  # where the first event starts differs
@pytest.mark.parametrize("count", [0, 1, 2, 150])
def test_collision_events(count: int, frame: str) -> None:
    rng = np.random.default_rng(count)
    called = [*names(18), *("a" * n for n in range(20, 28))]
    pairs = rng.integers(len(called), size=(count, 2))
    phase, level = rng.integers(3, size=count), rng.integers(4, size=count)
    numbers = rng.normal(size=(count, 8))
    reference = CollisionEvents(step=(7 << 40) + 5)
    reference.header.frame_id = frame
    set_stamp(reference.header.stamp)
    for (a, b), p, at, row in zip(pairs, phase.tolist(), level.tolist(), numbers.tolist(), strict=True):
        event = CollisionEvent(phase=p, object_a=called[a], object_b=called[b], level=at, depth=row[6], impulse=row[7])
        event.point.x, event.point.y, event.point.z, event.normal.x, event.normal.y, event.normal.z = row[:6]
        reference.events.append(event)
    data = layouts.CollisionEvents(called, frame).message(TIME_NS, reference.step, phase, pairs, level, numbers)
    assert_same(data, reference)


def test_bytes_do_not_change_behind_a_publisher() -> None:
    message = Layout().stamp().message()
    first = bytes(message)
    message.stamp(TIME_NS)
    assert first != bytes(message)
