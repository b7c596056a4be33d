"""The AI node with the real simulation: it flies the patrol of a scene, and comes down while it is held."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest
from drone_interfaces.msg import Scene as SceneMessage
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from simulation_interfaces.msg import Resource, Result
from simulation_interfaces.srv import LoadWorld
from std_msgs.msg import Bool

from .live import Graph, Spawn

SCENE = """
version: 1
effects: {gravity: {}}
objects:
  DRONE:
    model: wood_drone
    pose: [0, 0, 0.2]
    mass: 1.6
    flight: {cmd_vel: DRONE/cmd_vel}
    patrol: {waypoints: [[3, 0, 2], [3, 3, 2.5]], speed: 3, min_height: 1}
  left_rotor: {model: wood_rotor_cw, parent: DRONE, pose: [0.2, 0.2, 0.07], rotor: {direction: 1}}
  right_rotor: {model: wood_rotor_ccw, parent: DRONE, pose: [0.2, -0.2, 0.07], rotor: {direction: 1}}
  floor: {model: hangar_floor, static: true, collision: {level: floor}}
"""
WAYPOINTS = [(3.0, 0.0, 2.0), (3.0, 3.0, 2.5)]
KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def scene_file(folder: Path, drone: str) -> Path:
    """A scene with a drone of that name, which has a patrol."""
    path = folder / f"{drone}.yaml"
    path.write_text(SCENE.replace("DRONE", drone))
    return path


class Drone:
    """The odometry of a drone."""

    def __init__(self, graph: Graph, name: str) -> None:
        self.odometry: list[Odometry] = graph.listen(Odometry, f"{name}/odom")

    def position(self) -> tuple[float, float, float]:
        point = self.odometry[-1].pose.pose.position
        return (point.x, point.y, point.z)

    def at(self, goal: tuple[float, float, float]) -> Callable[[], bool]:
        return lambda: bool(self.odometry) and math.dist(self.position(), goal) < 0.4


@pytest.fixture(scope="module")
def flight(spawn: Spawn, tmp_path_factory: pytest.TempPathFactory) -> None:
    """A drone called 'ranger' in the simulation, and its pilot."""
    spawn("drone_sim.sim_node", scene=scene_file(tmp_path_factory.mktemp("scenes"), "ranger"))
    spawn("drone_ai.ai_node", use_sim_time=True)


@pytest.mark.usefixtures("flight")
def test_it_patrols_lands_while_held_and_resumes(graph: Graph) -> None:
    drone = Drone(graph, "ranger")
    rotors: list[JointState] = graph.listen(JointState, "joint_states")
    hold = graph.publisher(Bool, "ranger/hold")
    for waypoint in WAYPOINTS * 2:
        graph.wait_for(drone.at(waypoint), f"the drone at {waypoint}")
    assert min(rotors[-1].velocity) > 0.0
    with graph.repeating(hold, Bool(data=True), rate=10.0):
        graph.wait_for(lambda: not any(rotors[-1].velocity), "rotors that stand still")
        x, y, z = drone.position()
        assert z < 0.3
        seen = len(drone.odometry)
        graph.wait_for(lambda: len(drone.odometry) > seen + 30, "a second on the ground")
        assert drone.position() == pytest.approx((x, y, z), abs=0.02)
    # nothing more is said: that releases it, too
    graph.wait_for(lambda: drone.position()[2] > 1.0, "the drone in the air")
    assert drone.position()[:2] == pytest.approx((x, y), abs=0.2)
    graph.wait_for(drone.at(WAYPOINTS[0]), "the waypoint where it left")


@pytest.mark.usefixtures("flight")
def test_it_follows_to_another_scene(graph: Graph, tmp_path: Path) -> None:
    request = LoadWorld.Request(world_resource=Resource(uri=str(scene_file(tmp_path, "scout"))))
    loaded = graph.call(LoadWorld, "load_world", request)
    assert loaded.result.result == Result.RESULT_OK, loaded.result.error_message
    graph.wait_for(Drone(graph, "scout").at(WAYPOINTS[1]), "the new drone on its patrol")


def test_a_scene_that_cannot_be_loaded_is_reported_and_survived(graph: Graph, spawn: Spawn, tmp_path: Path) -> None:
    ai = spawn("drone_ai.ai_node", "-r", "__ns:=/other")
    scenes = graph.publisher(SceneMessage, "other/scene", KEPT)
    scenes.publish(SceneMessage(hash="1", uri=str(tmp_path / "missing.yaml")))
    graph.wait_for(lambda: "missing.yaml: No such file" in ai.output(), "the error")
    scenes.publish(SceneMessage(hash="2", uri=str(scene_file(tmp_path, "late"))))
    graph.wait_for(lambda: "flying late" in ai.output(), "the next scene")
