"""The simulation node: commands in, poses and collisions out."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drone_interfaces.msg import CollisionEvent, CollisionEvents
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist, Vector3
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from drone_engine.collision.placement import set_all_axes
from drone_engine.geometry.mesh import bounds
from drone_engine.scene import loading as scenes

from .live import Graph, Spawn

DEEPEST = 0.005  # m that a drone may get into a wall
MEADOW = Path(__file__).with_name("meadow.yaml")
FORWARD = Twist(linear=Vector3(x=3.0))
FAST = Twist(linear=Vector3(x=6.0))
UP = Twist(linear=Vector3(z=2.0))
KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BACK = Twist(linear=Vector3(x=-2.0))


@pytest.fixture(scope="module", autouse=True)
def sim(spawn: Spawn) -> None:
    spawn("drone_sim.sim_node", scene=MEADOW)


def listen(graph: Graph, kind: type[Any], topic: str) -> list[Any]:
    """The messages of a topic from now on; waits for the first one."""
    heard = graph.listen(kind, topic)
    graph.wait_for(lambda: heard, f"a message on {topic}")
    return heard


@pytest.fixture
def odometry(graph: Graph) -> Callable[[str], list[Odometry]]:
    """The odometry of a drone."""
    return lambda drone: listen(graph, Odometry, f"{drone}/odom")


@pytest.fixture
def poses(graph: Graph) -> Callable[[str], list[PoseStamped]]:
    """The poses of an object."""
    return lambda name: listen(graph, PoseStamped, f"{name}/pose")


def stamp(message: Odometry) -> float:
    return float(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)


def speed(message: Odometry) -> float:
    velocity = message.twist.twist.linear
    return math.hypot(velocity.x, velocity.y, velocity.z)


def test_a_drone_follows_commands_and_stops_when_they_stop(
    graph: Graph, odometry: Callable[[str], list[Odometry]], poses: Callable[[str], list[PoseStamped]]
) -> None:
    flown, placed = odometry("user_drone"), poses("user_drone")
    commands = graph.publisher(Twist, "cmd_vel")
    start = placed[-1].pose.position
    with graph.repeating(commands, UP):
        graph.wait_for(lambda: placed[-1].pose.position.z > start.z + 1.0, "the drone to rise")
    with graph.repeating(commands, FORWARD):
        graph.wait_for(lambda: placed[-1].pose.position.x > start.x + 3.0, "the drone to fly forward")
        ahead = flown[-1]
        assert ahead.twist.twist.linear.x == pytest.approx(3.0, abs=0.5)
        assert abs(placed[-1].pose.position.y - start.y) < 0.3
    graph.wait_for(lambda: speed(flown[-1]) < 0.05, "the drone to stop by itself")
    told_last = stamp(ahead)
    assert 0.4 < stamp(flown[-1]) - told_last < 3.0
    place = flown[-1].pose.pose.position
    graph.wait_for(lambda: stamp(flown[-1]) > told_last + 5.0, "five more seconds")
    end = flown[-1].pose.pose.position
    assert math.dist((place.x, place.y, place.z), (end.x, end.y, end.z)) < 0.1
    assert end.z > start.z + 0.5


def test_turns_left_for_a_positive_yaw_rate(graph: Graph, odometry: Callable[[str], list[Odometry]]) -> None:
    flown = odometry("user_drone")
    commands = graph.publisher(Twist, "cmd_vel")
    with graph.repeating(commands, Twist(angular=Vector3(z=1.0))):
        graph.wait_for(lambda: flown[-1].twist.twist.angular.z > 0.9, "the drone to turn")


@pytest.fixture
def meetings(graph: Graph) -> Callable[[str, str], Iterator[CollisionEvent]]:
    """All events so far of two objects."""
    heard = graph.listen(CollisionEvents, "collisions")

    def between(one: str, other: str) -> Iterator[CollisionEvent]:
        return (event for message in heard for event in message.events
                if {event.object_a, event.object_b} == {one, other})

    return between


def test_pushes_the_television_and_is_pushed_back(
    graph: Graph,
    odometry: Callable[[str], list[Odometry]],
    poses: Callable[[str], list[PoseStamped]],
    meetings: Callable[[str, str], Iterator[CollisionEvent]],
) -> None:
    flown, television = odometry("pusher"), poses("television")
    start = television[-1].pose.position
    commands = graph.publisher(Twist, "pusher/cmd_vel")

    def phases() -> set[int]:
        return {event.phase for event in meetings("pusher", "television")}

    def slowed_down() -> bool:
        speeds = [message.twist.twist.linear.x for message in flown]
        fastest = max(speeds)
        return min(speeds[speeds.index(fastest):]) < 0.5 * fastest

    with graph.repeating(commands, FAST):
        graph.wait_for(lambda: CollisionEvent.PERSIST in phases(), "the drone to meet the television")
        graph.wait_for(lambda: television[-1].pose.position.x > start.x + 0.02, "the television to move")
        graph.wait_for(slowed_down, "the push back")
    with graph.repeating(commands, BACK):
        graph.wait_for(lambda: CollisionEvent.END in phases(), "the drone to let go")
    met = next(meetings("pusher", "television"))
    assert met.phase == CollisionEvent.BEGIN
    assert met.impulse > 0.0
    away = met.normal.x if met.object_a == "pusher" else -met.normal.x
    assert away > 0.9  # the normal points at the television


def furthest_x(message: Odometry, low: np.ndarray, high: np.ndarray) -> float:
    """The greatest x in the world of a box with the corners low and high in the frame of the message's body, m."""
    position, turn = message.pose.pose.position, message.pose.pose.orientation
    axes = np.empty((1, 3, 3))
    set_all_axes(np.array([[turn.x, turn.y, turn.z, turn.w]]), axes)  # type: ignore[no-untyped-call]
    x = axes[0, :, 0]
    return float(position.x + x @ (low + high) / 2 + np.abs(x) @ (high - low) / 2)


def test_a_building_stops_the_drone(
    graph: Graph,
    odometry: Callable[[str], list[Odometry]],
    meetings: Callable[[str, str], Iterator[CollisionEvent]],
) -> None:
    flown, moving = odometry("rammer"), graph.listen(TFMessage, "tf")

    def stands() -> TransformStamped:
        """The transform of the barn, as whoever joins now is told."""
        heard = graph.listen(TFMessage, "tf_static", KEPT)
        graph.wait_for(lambda: heard, "what does not move")
        (found,) = (each for message in heard for each in message.transforms if each.child_frame_id == "barn")
        return found

    start = stands()
    commands = graph.publisher(Twist, "rammer/cmd_vel")
    with graph.repeating(commands, FORWARD):
        graph.wait_for(lambda: list(meetings("rammer", "barn")), "the drone to meet the barn")
        met = next(meetings("rammer", "barn"))
        time_met = stamp(flown[-1])
        graph.wait_for(lambda: stamp(flown[-1]) > time_met + 1.0, "a second of pushing")
    scene = scenes.load(MEADOW)
    drone, barn = (bounds(scene.model_path(name)) for name in ("rammer", "barn"))
    wall = start.transform.translation.x + barn[0][0]
    assert met.point.x == pytest.approx(wall, abs=0.1)  # known a step ahead, at 3 m/s and 30 Hz
    assert max(furthest_x(message, *drone) for message in flown) == pytest.approx(wall, abs=DEEPEST)

    assert stands().transform == start.transform
    moved = {each.child_frame_id for message in moving for each in message.transforms}
    assert "rammer" in moved
    assert "barn" not in moved
    topics = dict(graph.node.get_topic_names_and_types())
    assert "/rammer/odom" in topics
    assert "/barn/pose" not in topics
