"""The AI node: flies every drone of the scene that has a patrol, and lands those that are held."""

import math
import sys

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from drone_interfaces.msg import Scene
from geometry_msgs.msg import Twist, Vector3
from nav_msgs.msg import Odometry
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from std_msgs.msg import Bool

from drone_ai.pilot import Observation, Pilot
from drone_engine import SceneError, load
from drone_engine.math.quaternion import matrix
from drone_engine.scene.schema import Flight, Patrol
from drone_sim.node.parameters import Parameters
from drone_sim.node.process import run
from drone_sim.node.qos import LATCHED, NEWEST


class PilotedDrone:
    """One drone and its pilot: publishes a command for each odometry message."""

    def __init__(self, node: Node, name: str, patrol: Patrol, flight: Flight, hold_timeout: float) -> None:
        self.name = name
        self.pilot = Pilot(
            patrol.waypoints, min(patrol.speed, flight.max_speed), patrol.min_height, min(1.0, flight.max_yaw_rate)
        )
        self.ignored = 0  # odometry messages that are not finite
        self._clock = node.get_clock()
        self._hold_timeout = hold_timeout
        self._held_at = -math.inf  # s; -inf while released
        self._command = node.create_publisher(Twist, flight.cmd_vel, NEWEST)
        self._subscriptions = [
            node.create_subscription(Bool, f"{name}/hold", self._on_hold, NEWEST),
            node.create_subscription(Odometry, f"{name}/odom", self._on_odometry, NEWEST),
        ]

    def is_held(self) -> bool:
        """Whether the last message on <drone>/hold is true and younger than the timeout, in the node's time."""
        return 0.0 <= self._now() - self._held_at < self._hold_timeout

    def close(self, node: Node) -> None:
        """Destroys the subscriptions and the publisher."""
        for subscription in self._subscriptions:
            node.destroy_subscription(subscription)
        node.destroy_publisher(self._command)

    def _now(self) -> float:
        return float(self._clock.now().nanoseconds) * 1e-9

    def _on_hold(self, hold: Bool) -> None:
        self._held_at = self._now() if hold.data else -math.inf

    def _on_odometry(self, odometry: Odometry) -> None:
        command = self.pilot.fly(_observation(odometry), self.is_held())
        if command is None:
            self.ignored += 1
            return
        x, y, z = command.velocity_b
        linear, angular = Vector3(x=x, y=y, z=z), Vector3(z=command.yaw_rate)
        self._command.publish(Twist(linear=linear, angular=angular))


class AiNode(Node):
    """Runs one pilot for each drone of the scene that has a patrol. Raises ParameterError for a wrong parameter."""

    def __init__(self) -> None:
        super().__init__("drone_ai")
        self._hold_timeout = Parameters(self).number(
            "hold_timeout", 0.5, 0.05, 10.0, "s without a message on <drone>/hold after which the drone is released")
        self._drones: list[PilotedDrone] = []
        self._hash = ""
        self._diagnostics = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        self.create_subscription(Scene, "scene", self._on_scene, LATCHED)
        self.create_timer(1.0, self._publish_diagnostics, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _on_scene(self, message: Scene) -> None:
        if message.hash == self._hash:
            return
        self._hash = message.hash
        for drone in self._drones:
            drone.close(self)
        self._drones = []
        try:
            scene = load(message.uri)
        except SceneError as error:
            self.get_logger().error(str(error))
            return
        self._drones = [
            PilotedDrone(self, name, item.patrol, item.flight, self._hold_timeout)
            for name, item in scene.objects.items()
            if item.patrol and item.flight
        ]
        names = ", ".join(drone.name for drone in self._drones)
        text = f"{scene.name}: flying {names}" if names else f"{scene.name}: no object has a patrol"
        self.get_logger().info(text)

    def _publish_diagnostics(self) -> None:
        diagnostics = DiagnosticArray(status=[_status(drone) for drone in self._drones])
        diagnostics.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(diagnostics)


def _status(drone: PilotedDrone) -> DiagnosticStatus:
    pilot = drone.pilot
    values = {"waypoint": pilot.waypoint, "held": drone.is_held(), "broken odometry": drone.ignored}
    return DiagnosticStatus(
        level=DiagnosticStatus.WARN if drone.ignored else DiagnosticStatus.OK,
        name=f"drone_ai: {drone.name}",
        message=pilot.state.value,
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )


def _observation(odometry: Odometry) -> Observation:
    """The pilot's input from an odometry message, whose velocity is in the body frame."""
    stamp, pose, velocity = odometry.header.stamp, odometry.pose.pose, odometry.twist.twist.linear
    q = pose.orientation
    m00, _, _, m10, _, _, m20, m21, m22 = matrix(q.x, q.y, q.z, q.w)
    return Observation(
        time=stamp.sec + stamp.nanosec * 1e-9,
        position_w=(pose.position.x, pose.position.y, pose.position.z),
        yaw=math.atan2(m10, m00),  # heading of the body's x axis, rad
        climb_rate=float(m20 * velocity.x + m21 * velocity.y + m22 * velocity.z),
    )


def main(args: list[str] | None = None) -> int:
    """Runs the node until a signal ends it; returns the exit status."""
    return run("drone_ai", lambda _: AiNode(), args)


if __name__ == "__main__":
    sys.exit(main())
