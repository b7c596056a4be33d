"""A thousand falling crates, published and received."""

import time

import numpy as np
import pytest
from drone_interfaces.msg import CollisionEvent, CollisionEvents
from geometry_msgs.msg import PoseStamped
from rclpy.serialization import deserialize_message
from tf2_msgs.msg import TFMessage

from drone_sim.wire.cdr import SECOND, Transforms, read_transforms

from .live import Graph, Spawn

CRATES = {f"crate_{i}" for i in range(1024)}
SECONDS = 4.0  # of simulated time: they all have met something by then


@pytest.fixture(scope="module", autouse=True)
def sim(spawn: Spawn) -> None:
    spawn("drone_sim.sim_node", scene="crates")


def test_a_thousand_crates_fall_in_time(graph: Graph) -> None:
    heard = graph.listen(TFMessage, "tf", raw=True)
    met = graph.listen(CollisionEvents, "collisions", raw=True)
    graph.wait_for(lambda: heard, "the first transforms")
    arrival = time.monotonic()
    first = read_transforms(heard[0])

    def latest() -> Transforms:
        return read_transforms(heard[-1])

    deadline = 2.0 * SECONDS  # half of real time, as the machine may be busy
    graph.wait_for(lambda: latest().stamp_ns >= first.stamp_ns + SECONDS * SECOND, f"{SECONDS:g} s", deadline)
    assert time.monotonic() - arrival < deadline

    states = [read_transforms(message) for message in heard]
    for state in states:
        assert set(state.children) >= CRATES
        assert np.isfinite(state.poses).all()
    height = np.array([pose[2] for child, pose in zip(latest().children, latest().poses, strict=True)
                       if child in CRATES])
    assert (height > -0.5).all()
    last = deserialize_message(met[-1], CollisionEvents)
    touching = {name for event in last.events if event.phase != CollisionEvent.END
                for name in (event.object_a, event.object_b)}
    assert len(touching & CRATES) > 1000


def test_a_pose_is_published_to_its_subscriber(graph: Graph) -> None:
    poses = graph.listen(PoseStamped, "crate_1023/pose")
    graph.wait_for(lambda: len(poses) > 2, "poses of one crate")
    assert poses[-1].header.frame_id == "world"
