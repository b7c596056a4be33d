"""The simulation node: steps a world at the pace of the wall clock, takes commands, publishes poses and events."""

import math
import sys

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from drone_interfaces.msg import CollisionEvents
from drone_interfaces.msg import Scene as SceneMessage
from drone_interfaces.srv import SetCollisionLevel
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rosgraph_msgs.msg import Clock as ClockMessage
from sensor_msgs.msg import JointState
from simulation_interfaces.msg import Result, SimulationState
from simulation_interfaces.srv import GetSimulationState, LoadWorld, ResetSimulation, SetSimulationState, StepSimulation
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from drone_engine import SceneError, kernel_cache, load
from drone_engine.behavior import BehaviorError
from drone_engine.geometry.mesh import MeshError
from drone_engine.world import World
from drone_sim.node.pacing import Pacer, Share
from drone_sim.node.parameters import Parameters
from drone_sim.node.process import Stop, run
from drone_sim.node.qos import LATCHED, NO_CALLBACKS, RELIABLE
from drone_sim.node.subscribers import Subscribers
from drone_sim.wire import debug_depth
from drone_sim.wire.markers import Markers
from drone_sim.wire.messages import diagnostics, scene_message
from drone_sim.wire.telemetry import Telemetry, Type

CLASSES = {Type.CLOCK: ClockMessage, Type.POSE: PoseStamped, Type.ODOMETRY: Odometry, Type.TRANSFORMS: TFMessage,
           Type.JOINTS: JointState, Type.COLLISIONS: CollisionEvents}
MOST_STEPS = 10_000  # of one call of step_simulation; the node answers nothing else meanwhile
MARKER_RATE = 60.0  # Hz of simulated time at most, and only while debug/markers has subscribers
MARKER_SHARE = 0.1  # of wall time that markers may take; those of a thousand bodies are published less often
MARKERS_IN_PAUSE = 0.2  # s of wall time between two messages while the simulation is paused
LONGEST_WAIT = 10.0  # s of wall time to wait for the subscribers of tf that must not miss a message
UNPACED_SLICE = 0.005  # s of wall time that one callback steps for when running as fast as possible


class SimNode(Node):
    """Runs one scene; `load_world` replaces it while the node runs. Sets `stop` at the end of the duration.

    Raises SceneError, MeshError or BehaviorError if the first scene cannot be loaded, ParameterError for a wrong
    parameter. A BehaviorError in a step ends the node, because the scene is no longer the one that was described.
    """

    def __init__(self, stop: Stop) -> None:
        super().__init__("drone_sim")
        self._stop = stop
        read = Parameters(self)
        self._factor = read.number("rtf", 1.0, 0.0, 1000.0, "real-time factor, simulated s per wall s; 0: unlimited")
        self._duration = read.number("duration", 0.0, 0.0, 1e9, "simulated s after which the node ends; 0: never")
        scene = read.text("scene", "island", "name of a scene among the assets, or a scene file")
        self._awaited = read.integer("listeners", 0, 0, 1000, "subscribers of tf to wait for before time starts, so "
                                     "that they receive every step")
        read.integer("debug_depth", debug_depth.DEFAULT, 0, debug_depth.DEEPEST,
                     "depth of the octrees on debug/markers, 0 for their roots alone", read_only=False)
        self._wall = Clock(clock_type=ClockType.STEADY_TIME)
        self._state = SimulationState.STATE_LOADING_WORLD
        self._rejected = 0
        self._marker_share = Share(MARKER_SHARE)
        self._publishing = 0.0  # s of wall time since the last report
        self._timer: rclpy.timer.Timer | None = None
        self._outputs: dict[str, rclpy.publisher.Publisher] = {}
        self._inputs: list[rclpy.subscription.Subscription] = []
        self._scene_output = self.create_publisher(SceneMessage, "scene", LATCHED)
        self._static_output = self.create_publisher(TFMessage, "tf_static", LATCHED)
        self._marker_output = self.create_publisher(MarkerArray, "debug/markers", 1)
        self._diagnostics_output = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        for service, name, answer in ((LoadWorld, "load_world", self._on_load),
                                      (ResetSimulation, "reset_simulation", self._on_reset),
                                      (GetSimulationState, "get_simulation_state", self._on_get_state),
                                      (SetSimulationState, "set_simulation_state", self._on_set_state),
                                      (StepSimulation, "step_simulation", self._on_step),
                                      (SetCollisionLevel, "set_collision_level", self._on_set_level)):
            self.create_service(service, name, answer)
        self._start(self._build(scene))
        self.create_timer(1.0, self._publish_diagnostics, clock=self._wall)
        self.create_timer(MARKERS_IN_PAUSE, self._publish_markers_in_pause, clock=self._wall)

    # Scenes

    def _build(self, name: str) -> World:
        """Loads and compiles a world. Raises SceneError, MeshError or BehaviorError."""
        world = World(load(name), timed=True)
        first_time = not kernel_cache.compiled_before()

        def report(done: int, total: int, stage: str) -> None:
            if first_time:
                self.get_logger().info(f"compiling (first run only): {done + 1} of {total}, {stage}")

        world.compile(report)
        return world

    def _start(self, world: World) -> None:
        """Runs this world from now on, with its publishers and subscriptions in place of those of the last one."""
        for subscription in self._inputs:
            self.destroy_subscription(subscription)
        self._world, self._telemetry, self._markers = world, Telemetry(world), Markers(world)
        topics = self._telemetry.topics
        for topic in self._outputs.keys() - topics.keys():
            self.destroy_publisher(self._outputs.pop(topic))
        for topic in topics.keys() - self._outputs.keys():
            self._outputs[topic] = self.create_publisher(CLASSES[topics[topic]], topic, RELIABLE,
                                                         event_callbacks=NO_CALLBACKS)
        self._subscribers = Subscribers(
            {topic: output.get_subscription_count for topic, output in self._outputs.items()})
        self._inputs = [self.create_subscription(Twist, flight.cmd_vel,
                                                 lambda twist, name=name: self._on_command(name, twist), 10)
                        for name, item in world.scene.objects.items() if (flight := item.flight)]
        self._state = SimulationState.STATE_PLAYING
        self._loaded = self._now()
        self._restart_clock()
        self._scene_output.publish(scene_message(world))
        self._static_output.publish(self._telemetry.static(0))
        self._publish()
        self.get_logger().info(f"scene '{world.scene.name}': {world.model.bodies.count} bodies, "
                               f"physics at {world.scene.rates.physics:g} Hz")

    def _restart_clock(self) -> None:
        self._pacer = Pacer(self._world.scene.rates.physics, self._factor) if self._factor else None
        if self._timer:
            self.destroy_timer(self._timer)
        period = self._pacer.period if self._pacer else UNPACED_SLICE
        self._timer = self.create_timer(period, self._on_time, clock=self._wall)
        self._reported = (self._now(), int(self._world.state.step[0]))

    def _now(self) -> float:
        return float(self._wall.now().nanoseconds) * 1e-9

    # Time

    def _on_time(self) -> None:
        if self._awaited:
            self._wait_for_subscribers()
        if not self._is_running():
            return
        if self._pacer:
            for _ in range(self._pacer.due(self._now())):
                self._step()
        else:
            end = self._now() + UNPACED_SLICE
            while self._now() < end and not self._stop.is_set():
                self._step()

    def _is_running(self) -> bool:
        """Whether time advances: the simulation is not paused, and does not wait for subscribers of tf."""
        return self._state == SimulationState.STATE_PLAYING and not self._awaited

    def _wait_for_subscribers(self) -> None:
        """Starts time once tf has enough subscribers, or after LONGEST_WAIT."""
        late = self._now() > self._loaded + LONGEST_WAIT
        count = self._outputs["tf"].get_subscription_count()
        if late or count >= self._awaited:
            if late:
                self.get_logger().warning(f"tf: expected {self._awaited} subscribers within {LONGEST_WAIT:g} s, "
                                          f"got {count}; starting without the rest")
            self._awaited = 0
            self._restart_clock()
            self._publish()

    def _step(self) -> None:
        if self._stop.is_set():
            return
        self._world.step()
        self._publish()
        if self._duration and self._world.time >= self._duration - 0.5 * self._world.dt:
            self._stop.set()

    def _publish(self) -> None:
        start = self._now()
        self._subscribers.refresh()
        for topic, message in self._telemetry.messages(self._subscribers.topics):
            self._outputs[topic].publish(message)
        if int(self._world.state.step[0]) % max(1, math.ceil(self._world.scene.rates.physics / MARKER_RATE)) == 0:
            self._publish_markers()
        self._publishing += self._now() - start

    def _publish_markers(self) -> None:
        """Publishes the debug view of the collision detection if it has subscribers."""
        if self._marker_output.get_subscription_count() and self._marker_share.due(start := self._now()):
            depth = self.get_parameter("debug_depth").get_parameter_value().integer_value
            self._marker_output.publish(self._markers.message(self._telemetry.time_ns, depth))
            self._marker_share.took(start, self._now())

    def _publish_markers_in_pause(self) -> None:
        """Serves late subscribers, and changes of debug_depth, while nothing moves."""
        if not self._is_running():
            self._publish_markers()

    # Commands

    def _on_command(self, drone: str, twist: Twist) -> None:
        try:
            self._world.command(drone, (twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.z))
        except ValueError:
            self._rejected += 1
            topic = self._world.scene.objects[drone].flight.cmd_vel  # type: ignore[union-attr]
            self.get_logger().warning(f"{topic}: rejected a Twist with NaN or infinite numbers",
                                      throttle_duration_sec=1.0)

    # Services

    def _on_load(self, request: LoadWorld.Request, response: LoadWorld.Response) -> LoadWorld.Response:
        uri = request.world_resource.uri.removeprefix("file://")
        if not uri and request.world_resource.resource_string:
            response.result = Result(result=LoadWorld.Response.UNSUPPORTED_FORMAT,
                                     error_message="world_resource: expected a uri, got the text of a scene")
            return response
        if not uri:
            response.result = Result(result=LoadWorld.Response.NO_RESOURCE,
                                     error_message="world_resource.uri: expected a scene's name or file, got ''")
            return response
        try:
            self._start(self._build(uri))
        except (SceneError, MeshError, BehaviorError) as error:
            self.get_logger().error(f"load_world: {error}")
            response.result = Result(result=LoadWorld.Response.RESOURCE_PARSE_ERROR, error_message=str(error))
            return response
        response.result = Result(result=Result.RESULT_OK)
        response.world.name = self._world.scene.name
        response.world.world_resource.uri = str(self._world.scene.path)
        response.world.description = self._world.scene.description
        return response

    def _on_reset(self, request: ResetSimulation.Request, response: ResetSimulation.Response) -> object:
        if request.scope not in (ResetSimulation.Request.SCOPE_DEFAULT, ResetSimulation.Request.SCOPE_ALL):
            response.result = Result(result=Result.RESULT_FEATURE_UNSUPPORTED,
                                     error_message=f"scope: expected the default (0) or all (255), got {request.scope}")
            return response
        self._world.reset()
        self._restart_clock()
        self._publish()
        response.result = Result(result=Result.RESULT_OK)
        return response

    def _on_get_state(self, _: GetSimulationState.Request, response: GetSimulationState.Response) -> object:
        response.state.state = self._state
        response.result = Result(result=Result.RESULT_OK)
        return response

    def _on_set_state(self, request: SetSimulationState.Request, response: SetSimulationState.Response) -> object:
        wanted = request.state.state
        if wanted == self._state:
            response.result = Result(result=SetSimulationState.Response.ALREADY_IN_TARGET_STATE)
        elif wanted == SimulationState.STATE_QUITTING:
            self._stop.set()
            response.result = Result(result=Result.RESULT_OK)
        elif wanted in (SimulationState.STATE_PLAYING, SimulationState.STATE_PAUSED, SimulationState.STATE_STOPPED):
            self._state = wanted
            if wanted == SimulationState.STATE_STOPPED:
                self._world.reset()
                self._publish()
                self._restart_clock()
            elif self._pacer:
                self._pacer.restart()
            response.result = Result(result=Result.RESULT_OK)
        else:
            expected = "stopped (0), playing (1), paused (2) or quitting (3)"
            response.result = Result(result=SetSimulationState.Response.INCORRECT_TRANSITION,
                                     error_message=f"state: expected {expected}, got {wanted}")
        return response

    def _on_step(self, request: StepSimulation.Request, response: StepSimulation.Response) -> object:
        if self._state != SimulationState.STATE_PAUSED:
            response.result = Result(result=Result.RESULT_OPERATION_FAILED,
                                     error_message="step_simulation: expected a paused simulation, got a running one")
            return response
        if request.steps > MOST_STEPS:
            response.result = Result(result=Result.RESULT_OPERATION_FAILED,
                                     error_message=f"steps: expected at most {MOST_STEPS}, got {request.steps}")
            return response
        for _ in range(request.steps):
            self._step()
        response.result = Result(result=Result.RESULT_OK)
        return response

    def _on_set_level(self, request: SetCollisionLevel.Request, response: SetCollisionLevel.Response) -> object:
        try:
            self._world.set_collision_level(request.level, request.a, request.b)
        except ValueError as error:
            response.message = str(error)
            return response
        if self._pacer:
            self._pacer.restart()  # loading meshes takes a while
        response.success = True
        return response

    # Diagnostics

    def _publish_diagnostics(self) -> None:
        now, step = self._now(), int(self._world.state.step[0])
        (before, last), self._reported = self._reported, (now, step)
        rate = (step - last) / (now - before) if now > before else 0.0
        asked = self._factor * self._world.scene.rates.physics if self._is_running() else 0.0
        lag = self._pacer.lag if self._pacer else 0.0
        publishing, self._publishing = self._publishing, 0.0
        self._diagnostics_output.publish(diagnostics(
            self._world, self._telemetry.time_ns, rate=rate, asked=asked, rejected=self._rejected, lag=lag,
            publishing_us=1e6 * publishing / max(step - last, 1)))


def main(args: list[str] | None = None) -> int:
    """Runs the node until its duration is over or a signal ends it; returns the exit status."""
    return run("drone_sim", SimNode, args, SceneError, MeshError, BehaviorError)


if __name__ == "__main__":
    sys.exit(main())
