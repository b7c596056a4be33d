"""The node around the world: commands in, poses and events out, time kept."""

import math
import sys

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from drone_interfaces.msg import CollisionEvents
from drone_interfaces.msg import Scene as SceneMessage
from drone_interfaces.srv import SetCollisionLevel
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from rosgraph_msgs.msg import Clock as ClockMessage
from sensor_msgs.msg import JointState
from simulation_interfaces.msg import Result, SimulationState
from simulation_interfaces.srv import GetSimulationState, LoadWorld, ResetSimulation, SetSimulationState, StepSimulation
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from drone_engine import cache
from drone_engine.geometry.mesh import MeshError
from drone_engine.scene.schema import SceneError, load
from drone_engine.world import World
from drone_sim.node.pacing import Pacer, Share
from drone_sim.node.process import NO_CALLBACKS, run
from drone_sim.node.subscribers import Audience
from drone_sim.wire.markers import DEEPEST, DEPTH, Markers
from drone_sim.wire.messages import diagnostics, scene_message
from drone_sim.wire.telemetry import Telemetry, Type

CLASSES = {Type.CLOCK: ClockMessage, Type.POSE: PoseStamped, Type.ODOMETRY: Odometry, Type.TRANSFORMS: TFMessage,
           Type.JOINTS: JointState, Type.COLLISIONS: CollisionEvents}
KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # for whoever joins later
RELIABLE = QoSProfile(depth=100)
MOST_STEPS = 10_000  # of one call; nothing else is answered meanwhile
MARKER_RATE = 60.0  # Hz of simulated time at most, and only while somebody looks
MARKER_SHARE = 0.1  # of wall time that they may take; those of a thousand bodies come less often
MARKERS_IN_PAUSE = 0.2  # s of wall time
LONGEST_WAIT = 10.0  # s of wall time for those that must miss nothing
UNPACED_SLICE = 0.005  # s of wall time between looks at the subscriptions when running as fast as it can


class SimNode(Node):
    """Runs one scene; another can be loaded while it runs. Sets `finished` once the duration has been reached."""

    def __init__(self, finished: Future) -> None:
        super().__init__("drone_sim")
        self._finished = finished
        self._factor = self._number("rtf", 1.0, 1000.0, "simulated s per wall s; 0: as fast as it can")
        self._duration = self._number("duration", 0.0, 1e9, "simulated s after which the node ends; 0: never")
        scene = str(self.declare_parameter("scene", "island", ParameterDescriptor(
            description="a scene among the assets, by name, or a scene file", read_only=True)).value)
        self._awaited = int(self.declare_parameter("listeners", 0, ParameterDescriptor(
            description="subscribers of tf without which time does not start, so that they miss nothing",
            read_only=True)).value)
        self.declare_parameter("debug_depth", DEPTH, ParameterDescriptor(
            description="of the octrees on debug/markers, 0 for their roots alone",
            integer_range=[IntegerRange(from_value=0, to_value=DEEPEST, step=1)]))
        self._wall = Clock(clock_type=ClockType.STEADY_TIME)
        self._state = SimulationState.STATE_LOADING_WORLD
        self._rejected = 0
        self._showing = Share(MARKER_SHARE)
        self._publishing = 0.0  # s of wall time since the last report
        self._timer: rclpy.timer.Timer | None = None
        self._outputs: dict[str, rclpy.publisher.Publisher] = {}
        self._inputs: list[rclpy.subscription.Subscription] = []
        self._scene_output = self.create_publisher(SceneMessage, "scene", KEPT)
        self._static_output = self.create_publisher(TFMessage, "tf_static", KEPT)
        self._marker_output = self.create_publisher(MarkerArray, "debug/markers", 1)
        self._diagnostics_output = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        for service, name, answer in ((LoadWorld, "load_world", self._on_load),
                                      (ResetSimulation, "reset_simulation", self._on_reset),
                                      (GetSimulationState, "get_simulation_state", self._on_get_state),
                                      (SetSimulationState, "set_simulation_state", self._on_set_state),
                                      (StepSimulation, "step_simulation", self._on_step),
                                      (SetCollisionLevel, "set_collision_level", self._on_set_level)):
            self.create_service(service, name, answer)
        self._run(self._build(scene))
        self.create_timer(1.0, self._report, clock=self._wall)
        self.create_timer(MARKERS_IN_PAUSE, self._show_in_pause, clock=self._wall)

    def _number(self, name: str, default: float, most: float, description: str) -> float:
        limits = FloatingPointRange(from_value=0.0, to_value=most)
        descriptor = ParameterDescriptor(description=description, floating_point_range=[limits], read_only=True)
        return float(self.declare_parameter(name, default, descriptor).value)

    # Scenes

    def _build(self, name: str) -> World:
        """A world that is ready to step. Raises SceneError or MeshError."""
        world = World(load(name), timed=True)
        first_time = not cache.compiled_before()

        def report(done: int, total: int, stage: str) -> None:
            if first_time:
                self.get_logger().info(f"compiling, once for this machine: {done + 1} of {total}, {stage}")

        world.compile(report)
        return world

    def _run(self, world: World) -> None:
        """Replaces whatever runs."""
        for subscription in self._inputs:
            self.destroy_subscription(subscription)
        self._world, self._telemetry, self._markers = world, Telemetry(world), Markers(world)
        topics = self._telemetry.topics
        for topic in self._outputs.keys() - topics.keys():
            self.destroy_publisher(self._outputs.pop(topic))
        for topic in topics.keys() - self._outputs.keys():
            self._outputs[topic] = self.create_publisher(CLASSES[topics[topic]], topic, RELIABLE,
                                                         event_callbacks=NO_CALLBACKS)
        self._audience = Audience({topic: output.get_subscription_count for topic, output in self._outputs.items()})
        self._inputs = [self.create_subscription(Twist, flight.cmd_vel,
                                                 lambda twist, name=name: self._on_command(name, twist), 10)
                        for name, thing in world.scene.objects.items() if (flight := thing.flight)]
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
            self._look_for_listeners()
        if not self._is_running():
            return
        if self._pacer:
            for _ in range(self._pacer.due(self._now())):
                self._step()
        else:
            end = self._now() + UNPACED_SLICE
            while self._now() < end and not self._finished.done():
                self._step()

    def _is_running(self) -> bool:
        """Whether time goes on: nobody has stopped it, and those are there that must miss nothing."""
        return self._state == SimulationState.STATE_PLAYING and not self._awaited

    def _look_for_listeners(self) -> None:
        """Lets time start when enough listen to tf, or have been waited for long enough."""
        late = self._now() > self._loaded + LONGEST_WAIT
        if late or self._outputs["tf"].get_subscription_count() >= self._awaited:
            if late:
                self.get_logger().warning(f"tf: fewer than {self._awaited} listen after {LONGEST_WAIT:g} s; going on")
            self._awaited = 0
            self._restart_clock()
            self._publish()

    def _step(self) -> None:
        if self._finished.done():
            return
        self._world.step()
        self._publish()
        if self._duration and self._world.time >= self._duration - 0.5 * self._world.dt:
            self._finished.set_result(None)

    def _publish(self) -> None:
        start = self._now()
        self._audience.look()
        for topic, message in self._telemetry.messages(self._audience.heard):
            self._outputs[topic].publish(message)
        if int(self._world.state.step[0]) % max(1, math.ceil(self._world.scene.rates.physics / MARKER_RATE)) == 0:
            self._show()
        self._publishing += self._now() - start

    def _show(self) -> None:
        """Publishes what the collision detection sees, if somebody looks."""
        if self._marker_output.get_subscription_count() and self._showing.due(start := self._now()):
            depth = self.get_parameter("debug_depth").get_parameter_value().integer_value
            self._marker_output.publish(self._markers.message(self._telemetry.time_ns, depth))
            self._showing.took(start, self._now())

    def _show_in_pause(self) -> None:
        """For who begins to look, or looks deeper, while nothing moves."""
        if not self._is_running():
            self._show()

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
                                     error_message="world_resource.resource_string: scenes are files; give a uri")
            return response
        if not uri:
            response.result = Result(result=LoadWorld.Response.NO_RESOURCE,
                                     error_message="world_resource.uri: expected a scene's name or file")
            return response
        try:
            self._run(self._build(uri))
        except (SceneError, MeshError) as error:
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
                                     error_message="scope: only all (255) or the default (0) can be reset")
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
            self._finished.set_result(None)
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
            response.result = Result(result=SetSimulationState.Response.INCORRECT_TRANSITION,
                                     error_message="state: expected stopped (0), playing (1), paused (2) or quitting")
        return response

    def _on_step(self, request: StepSimulation.Request, response: StepSimulation.Response) -> object:
        if self._state != SimulationState.STATE_PAUSED:
            response.result = Result(result=Result.RESULT_OPERATION_FAILED,
                                     error_message="the simulation is not paused")
            return response
        if request.steps > MOST_STEPS:
            response.result = Result(result=Result.RESULT_OPERATION_FAILED,
                                     error_message=f"steps: at most {MOST_STEPS} at once, got {request.steps}")
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
            self._pacer.restart()  # reading meshes takes a while
        response.success = True
        return response

    # Diagnostics

    def _report(self) -> None:
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
    return run("drone_sim", SimNode, args, SceneError, MeshError)


if __name__ == "__main__":
    sys.exit(main())
