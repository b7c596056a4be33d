"""The teleoperation node: keys become cmd_vel, hold messages for the AI drone, and calls of other nodes' services."""

import math
import signal
import sys
import time
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from drone_interfaces.msg import CollisionEvent, CollisionEvents, Scene
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from simulation_interfaces.msg import Result, SimulationState
from simulation_interfaces.srv import ResetSimulation, SetSimulationState
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, Trigger

from drone_sim.node.parameters import Parameters
from drone_sim.node.process import END_SIGNALS, Stop, run, spin
from drone_sim.node.qos import LATCHED, NEWEST
from drone_sim.wire import debug_depth
from drone_teleop.keys import HELP, Action, Controls
from drone_teleop.screen import Screen
from drone_teleop.terminal import Keyboard

KEY_PERIOD = 0.02  # s between two reads of the keyboard
HOLD_PERIOD = 0.1  # s between two hold messages
STATUS_PERIOD = 0.2  # s between two updates of the status line
LAST_STOP = Duration(seconds=0.3)  # to wait for the stop to arrive; it may be lost if the process ends at once


class TeleopNode(Node):
    """Reads keys and publishes commands. Its timers run on the steady clock: keys are pressed in real time.

    Raises ParameterError for a wrong parameter.
    """

    def __init__(self, stop: Stop) -> None:
        super().__init__("drone_teleop")
        self._stop = stop
        self._keyboard = Keyboard(sys.stdin.fileno())
        self._screen = Screen(sys.stdout)
        read = Parameters(self)
        rate = read.number("repeat_rate", 20.0, 1.0, 200.0, "Hz at which cmd_vel is published while a key is held")
        self._drone = read.text("drone", "user_drone", "object whose position and collisions the status line shows")
        self._ai_drone = read.text("ai_drone", "ai_drone", "object that lands while F4 is held")
        self._controls = Controls(
            speed=read.number("speed", 2.0, 0.01, 100.0, "initial linear speed, m/s"),
            turn=read.number("turn", 1.0, 0.01, 100.0, "initial angular speed, rad/s"),
            delay=read.number("key_delay", 0.6, 0.05, 5.0, "s that a press counts as held until its first repeat"),
            timeout=read.number("key_timeout", 0.15, 0.02, 5.0, "s without a repeat after which a key is released"),
            cooldown=read.number("toggle_cooldown", 0.25, 0.0, 5.0, "s between presses that both trigger an action"),
            latch=read.flag("latch", False, "a moving key counts until another key is pressed, not until its release"),
        )
        self._cameras: list[str] = []
        self._camera = read.text("camera", "", "camera selected at the start; if empty, the scene's first")
        self._position: tuple[float, float, float] | None = None
        self._hit = ""
        self._ai_state = ""
        self._paused = False
        self._shows_debug = False
        self._depth = debug_depth.DEFAULT
        self._keys = 0

        self._cmd_vel = self.create_publisher(Twist, "cmd_vel", 10)
        self._hold = self.create_publisher(Bool, f"{self._ai_drone}/hold", 10)
        self._select = self.create_publisher(String, "camera/select", LATCHED)
        self._diagnostics = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        self._save = self.create_client(Trigger, "drone_render/save_image")
        self._debug = self.create_client(SetBool, "drone_render/show_debug")
        self._parameters = self.create_client(SetParameters, "drone_sim/set_parameters")
        self._reset = self.create_client(ResetSimulation, "reset_simulation")
        self._set_state = self.create_client(SetSimulationState, "set_simulation_state")
        self.create_subscription(Scene, "scene", self._on_scene, LATCHED)
        self.create_subscription(String, "camera/select", self._on_camera, LATCHED)
        self.create_subscription(Odometry, f"{self._drone}/odom", self._on_odometry, NEWEST)
        self.create_subscription(CollisionEvents, "collisions", self._on_collisions, 100, raw=True)
        self.create_subscription(DiagnosticArray, "diagnostics", self._on_diagnostics, 10)

        steady = Clock(clock_type=ClockType.STEADY_TIME)
        for period, callback in (
            (KEY_PERIOD, self._read_keys),
            (1.0 / rate, self._publish_command),
            (HOLD_PERIOD, self._publish_hold),
            (STATUS_PERIOD, self._show_status),
            (1.0, self._publish_diagnostics),
        ):
            self.create_timer(period, callback, clock=steady)

    def run(self, stop: Stop) -> None:
        """Reads keys until `stop` is set; then stops the drone and restores the terminal."""
        with self._keyboard:
            self._screen.print(HELP)
            try:
                spin(self, stop)
            finally:
                self._controls.release()
                self._publish_command()
                self._publish_hold()
                self._cmd_vel.wait_for_all_acked(LAST_STOP)
                self._screen.close()

    def _read_keys(self) -> None:
        try:
            keys = self._keyboard.read()
        except EOFError:  # the terminal window was closed
            self._stop.set()
            return
        for key in keys:
            self._keys += 1
            match self._controls.press(key, time.monotonic()):
                case Action.CAMERA:
                    self._next_camera()
                case Action.IMAGE:
                    self._call(self._save, Trigger.Request(), self._on_saved)
                case Action.DEBUG:
                    self._shows_debug = not self._shows_debug
                    self._call(self._debug, SetBool.Request(data=self._shows_debug), self._on_debug)
                case Action.SHALLOWER | Action.DEEPER as action:
                    self._set_depth(self._depth + (1 if action is Action.DEEPER else -1))
                case Action.RESET:
                    self._call(self._reset, ResetSimulation.Request(), self._on_reset)
                case Action.PAUSE:
                    wanted = SimulationState.STATE_PLAYING if self._paused else SimulationState.STATE_PAUSED
                    request = SetSimulationState.Request(state=SimulationState(state=wanted))
                    self._call(self._set_state, request, self._on_paused)

    def _publish_command(self) -> None:
        velocity = self._controls.velocity(time.monotonic())
        if velocity is not None:
            twist = Twist()
            twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.z = velocity
            self._cmd_vel.publish(twist)

    def _publish_hold(self) -> None:
        hold = self._controls.hold(time.monotonic())
        if hold is not None:
            self._hold.publish(Bool(data=hold))

    def _next_camera(self) -> None:
        if not self._cameras:
            self._screen.print("no camera: the scene has none, or has not been received yet")
            return
        self._camera = self._cameras[(self._cameras.index(self._camera) + 1) % len(self._cameras)]
        self._select.publish(String(data=self._camera))

    def _call(self, client: Any, request: Any, on_response: Any) -> None:
        """Calls a service without waiting; `on_response` receives the response."""
        if not client.service_is_ready():
            self._screen.print(f"service {client.srv_name} is not available")
            return
        client.call_async(request).add_done_callback(lambda future: on_response(future.result()))

    def _on_saved(self, response: Trigger.Response) -> None:
        self._screen.print(f"saved {response.message}" if response.success else f"no image saved: {response.message}")

    def _set_depth(self, depth: int) -> None:
        """Sets the debug_depth of drone_sim, which rejects a depth outside of its range."""
        value = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=depth)
        request = SetParameters.Request(parameters=[Parameter(name="debug_depth", value=value)])
        self._call(self._parameters, request, lambda response: self._on_depth(depth, response))

    def _on_depth(self, depth: int, response: SetParameters.Response) -> None:
        if response.results[0].successful:
            self._depth = depth
            self._screen.print(f"octree depth {depth}")
        else:
            self._screen.print(f"octree depth stays {self._depth}: {response.results[0].reason}")

    def _on_debug(self, response: SetBool.Response) -> None:
        self._screen.print(response.message)

    def _on_reset(self, response: ResetSimulation.Response) -> None:
        if response.result.result == Result.RESULT_OK:
            self._hit = ""
            self._screen.print("simulation reset")
        else:
            self._screen.print(f"not reset: {response.result.error_message}")

    def _on_paused(self, response: SetSimulationState.Response) -> None:
        # Another node may have paused or continued; then the next press of the key does what it should.
        if response.result.result in (Result.RESULT_OK, SetSimulationState.Response.ALREADY_IN_TARGET_STATE):
            self._paused = not self._paused
        else:
            self._screen.print(f"not paused or continued: {response.result.error_message}")

    def _on_scene(self, scene: Scene) -> None:
        self._cameras = list(scene.cameras)
        self._hit = ""
        self._paused = False
        if self._camera not in self._cameras:
            self._camera = next(iter(self._cameras), "")

    def _on_camera(self, selected: String) -> None:
        if not self._cameras or selected.data in self._cameras:
            self._camera = selected.data

    def _on_odometry(self, odometry: Odometry) -> None:
        position = odometry.pose.pose.position
        self._position = (position.x, position.y, position.z)

    def _on_collisions(self, data: bytes) -> None:
        if self._drone.encode() not in data:  # deserializing thousands of events takes longer than their step
            return
        for event in deserialize_message(data, CollisionEvents).events:
            pair = (event.object_a, event.object_b)
            if event.phase == CollisionEvent.BEGIN and self._drone in pair:
                self._hit = pair[1 - pair.index(self._drone)]

    def _on_diagnostics(self, diagnostics: DiagnosticArray) -> None:
        for status in diagnostics.status:
            if status.name == f"drone_ai: {self._ai_drone}":
                self._ai_state = status.message

    def _show_status(self) -> None:
        parts = [f"speed {self._controls.speed:.2f} turn {self._controls.turn:.2f}"]
        if self._paused:
            parts.insert(0, "PAUSED")
        if self._position is not None and all(map(math.isfinite, self._position)):
            parts.append("at {:.1f} {:.1f} {:.1f}".format(*self._position))
        if self._camera:
            parts.append(f"camera {self._camera}")
        if self._ai_state:
            parts.append(f"{self._ai_drone} {self._ai_state}")
        if self._hit:
            parts.append(f"last hit {self._hit}")
        self._screen.status(" | ".join(parts))

    def _publish_diagnostics(self) -> None:
        controls = self._controls
        values = {"keys read": self._keys, "speed": controls.speed, "turn": controls.turn, "camera": self._camera}
        status = DiagnosticStatus(
            level=DiagnosticStatus.OK,
            name="drone_teleop: keyboard",
            message="reading keys",
            values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
        )
        diagnostics = DiagnosticArray(status=[status])
        diagnostics.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(diagnostics)


def main(args: list[str] | None = None) -> int:
    """Runs the node until a signal or the loss of its terminal; returns the exit status, 2 without a terminal."""
    if not sys.stdin.isatty():
        print("drone_teleop: stdin: expected a terminal to read keys from, got none", file=sys.stderr)
        return 2
    signals = (*END_SIGNALS, signal.SIGHUP, signal.SIGQUIT)
    return run("drone_teleop", TeleopNode, args, work=TeleopNode.run, end_signals=signals)


if __name__ == "__main__":
    sys.exit(main())
