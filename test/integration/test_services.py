"""Services: scenes are loaded, paused, stepped and reset; wrong requests are rejected and the simulation continues."""

import math
import time
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from drone_interfaces.msg import CollisionEvent, CollisionEvents, Scene
from drone_interfaces.srv import SetCollisionLevel
from geometry_msgs.msg import PoseStamped, Twist, Vector3
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from simulation_interfaces.msg import Resource, Result, SimulationState
from simulation_interfaces.srv import (
    GetSimulationState,
    LoadWorld,
    ResetSimulation,
    SetSimulationState,
    StepSimulation,
)
from visualization_msgs.msg import MarkerArray

from .live import Graph, NodeProcess, Spawn

KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
STEP = 1.0 / 30.0
QUIET = 0.3  # s without a message, after which none is on its way


@pytest.fixture(scope="module", autouse=True)
def sim(spawn: Spawn) -> NodeProcess:
    return spawn("drone_sim.sim_node", scene="hangar")


def seconds(message: Clock) -> float:
    return float(message.clock.sec + 1e-9 * message.clock.nanosec)


def settle(graph: Graph, heard: list[Any]) -> None:
    """Waits until no more messages arrive."""
    count, since = len(heard), time.monotonic()

    def is_quiet() -> bool:
        nonlocal count, since
        if len(heard) != count:
            count, since = len(heard), time.monotonic()
        return time.monotonic() > since + QUIET

    graph.wait_for(is_quiet, "messages to cease")


def set_state(graph: Graph, state: int) -> int:
    request = SetSimulationState.Request(state=SimulationState(state=state))
    return int(graph.call(SetSimulationState, "set_simulation_state", request).result.result)


def load(graph: Graph, uri: str) -> LoadWorld.Response:
    return graph.call(LoadWorld, "load_world", LoadWorld.Request(world_resource=Resource(uri=uri)))


def test_a_scene_is_switched_and_a_broken_one_is_not(graph: Graph, tmp_path: Path) -> None:
    scenes, poses = graph.listen(Scene, "scene", KEPT), graph.listen(PoseStamped, "television/pose")
    graph.wait_for(lambda: scenes, "the first scene")
    assert scenes[0].name == "hangar"

    assert load(graph, "island").result.result == Result.RESULT_OK
    graph.wait_for(lambda: len(scenes) == 2, "the second scene")
    assert scenes[1].name == "island"
    assert scenes[1].hash != scenes[0].hash
    graph.wait_for(lambda: poses, "an object of the second scene")

    broken = tmp_path / "broken.yaml"
    broken.write_text("version: 1\nobjects: {drone: {model: drone, mass: -1}}\n")
    answer = load(graph, str(broken))
    assert answer.result.result == LoadWorld.Response.RESOURCE_PARSE_ERROR
    assert answer.result.error_message.startswith(f"{broken}: objects.drone.mass: ")
    assert load(graph, "").result.result == LoadWorld.Response.NO_RESOURCE
    heard = len(poses)
    graph.wait_for(lambda: len(poses) > heard + 10, "the running scene to go on")
    assert len(scenes) == 2


def test_time_is_paused_stepped_and_reset(graph: Graph) -> None:
    clock = graph.listen(Clock, "/clock")
    graph.wait_for(lambda: clock, "time")
    assert set_state(graph, SimulationState.STATE_PAUSED) == Result.RESULT_OK
    assert set_state(graph, SimulationState.STATE_PAUSED) == SetSimulationState.Response.ALREADY_IN_TARGET_STATE
    state = graph.call(GetSimulationState, "get_simulation_state", GetSimulationState.Request())
    assert state.state.state == SimulationState.STATE_PAUSED

    settle(graph, clock)
    before = seconds(clock[-1])
    answer = graph.call(StepSimulation, "step_simulation", StepSimulation.Request(steps=7))
    assert answer.result.result == Result.RESULT_OK
    graph.wait_for(lambda: seconds(clock[-1]) >= before + 6.5 * STEP, "seven steps")
    settle(graph, clock)
    assert seconds(clock[-1]) == pytest.approx(before + 7 * STEP, abs=1e-6)
    assert len({seconds(message) for message in clock if seconds(message) > before}) == 7

    assert set_state(graph, SimulationState.STATE_PLAYING) == Result.RESULT_OK
    answer = graph.call(StepSimulation, "step_simulation", StepSimulation.Request(steps=7))
    assert answer.result.result == Result.RESULT_OPERATION_FAILED
    graph.wait_for(lambda: seconds(clock[-1]) > before + 20 * STEP, "time to go on")
    latest = seconds(clock[-1])
    assert graph.call(ResetSimulation, "reset_simulation", ResetSimulation.Request()).result.result == Result.RESULT_OK
    graph.wait_for(lambda: seconds(clock[-1]) < latest, "time to start over")


def test_the_debug_view_is_published_to_subscribers(graph: Graph) -> None:
    seen = graph.listen(MarkerArray, "debug/markers")
    graph.wait_for(lambda: seen and any(marker.ns == "contacts" for marker in seen[-1].markers), "contacts")
    box = next(marker for marker in seen[-1].markers if marker.ns == "boxes" and marker.header.frame_id == "crate_0")
    assert len(box.points) == 24


def test_octrees_are_shown_as_deep_as_a_parameter_says_in_a_pause_as_well(graph: Graph) -> None:
    answer = graph.call(SetCollisionLevel, "set_collision_level", SetCollisionLevel.Request(level="octree"))
    assert answer.success, answer.message
    assert set_state(graph, SimulationState.STATE_PAUSED) == Result.RESULT_OK
    seen = graph.listen(MarkerArray, "debug/markers")

    def look(depth: int) -> bool:
        value = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=depth)
        request = SetParameters.Request(parameters=[Parameter(name="debug_depth", value=value)])
        return bool(graph.call(SetParameters, "drone_sim/set_parameters", request).results[0].successful)

    def nodes() -> int:
        return max([len(marker.points) // 24 for marker in seen[-1].markers if marker.ns == "octrees"], default=0)

    assert look(0)
    graph.wait_for(lambda: seen and nodes() == 1, "the roots")
    assert look(2)
    graph.wait_for(lambda: nodes() > 8, "what is below them")
    assert not look(7)
    assert set_state(graph, SimulationState.STATE_PLAYING) == Result.RESULT_OK


def test_the_collision_level_is_changed_and_events_name_it(graph: Graph) -> None:
    events = graph.listen(CollisionEvents, "collisions")
    assert load(graph, "hangar").result.result == Result.RESULT_OK

    def floor_of(crate: str) -> int:
        last = [event for event in events[-1].events if {event.object_a, event.object_b} == {crate, "floor"}]
        return last[0].level if last else -1

    graph.wait_for(lambda: events and floor_of("crate_0") == CollisionEvent.LEVEL_OBB, "a crate on the floor")
    request = SetCollisionLevel.Request(level="sphere", a="crate_0")
    answer = graph.call(SetCollisionLevel, "set_collision_level", request)
    assert answer.success, answer.message
    graph.wait_for(lambda: floor_of("crate_0") == CollisionEvent.LEVEL_SPHERE, "its sphere on the floor")
    assert floor_of("crate_1") == CollisionEvent.LEVEL_OBB

    answer = graph.call(SetCollisionLevel, "set_collision_level", SetCollisionLevel.Request(level="box"))
    assert not answer.success
    assert answer.message == "level: expected one of sphere, obb, octree, triangle, got 'box'"


def test_diagnostics_report_the_time_of_each_stage(graph: Graph, sim: NodeProcess) -> None:
    reports = graph.listen(DiagnosticArray, "diagnostics")

    def stages() -> dict[str, float]:
        values = reports[-1].status[0].values if reports else []
        return {value.key.removesuffix(", us per step"): float(value.value) for value in values
                if value.key.endswith(", us per step")}

    graph.wait_for(lambda: stages().get("motion", 0.0) > 0.0, "the time that motion takes")
    assert {"broad phase", "motion: gravity"} <= set(stages())


def test_a_twist_that_is_not_finite_is_counted_and_ignored(graph: Graph, sim: NodeProcess) -> None:
    poses = graph.listen(PoseStamped, "user_drone/pose")
    reports = graph.listen(DiagnosticArray, "diagnostics")
    pilot = graph.publisher(Twist, "cmd_vel")

    def rejected() -> int:
        values = {value.key: value.value for value in reports[-1].status[0].values} if reports else {}
        return int(values.get("commands rejected", 0))

    with graph.repeating(pilot, Twist(linear=Vector3(x=math.nan, z=math.inf)), rate=50.0):
        graph.wait_for(lambda: rejected() > 10, "rejections to be counted")
    assert "cmd_vel: rejected a Twist with NaN or infinite numbers" in sim.output()
    position = poses[-1].pose.position
    assert all(map(math.isfinite, (position.x, position.y, position.z)))
    with graph.repeating(pilot, Twist(linear=Vector3(x=2.0))):
        graph.wait_for(lambda: poses[-1].pose.position.x > position.x + 0.5, "the drone to obey what is finite")
