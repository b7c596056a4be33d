"""A person at the terminal: keys become cmd_vel, calls to the AI drone, and requests to the other nodes."""

import math
import signal
import sys
import time
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from drone_interfaces.msg import CollisionEvent, CollisionEvents, Scene
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import FloatingPointRange, Parameter, ParameterDescriptor, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message
from rclpy.signals import SignalHandlerOptions
from simulation_interfaces.msg import Result, SimulationState
from simulation_interfaces.srv import ResetSimulation, SetSimulationState
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, Trigger

from drone_teleop.keys import HELP, Action, Hand
from drone_teleop.screen import Screen
from drone_teleop.terminal import Keyboard

KEY_PERIOD = 0.02  # s between two looks at the keyboard
HOLD_PERIOD = 0.1
ARRIVES_WITHIN = Duration(seconds=0.3)  # or the last word of a process that ends is lost on a busy machine
DEPTH = 3  # of the octrees that drone_sim shows at first
STATUS_PERIOD = 0.2
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
NEWEST = QoSProfile(depth=1)


class TeleopNode(Node):
    """Reads the keyboard and speaks for it. Its timers run on the steady clock, for hands know no simulated time."""

    def __init__(self, keyboard: Keyboard, screen: Screen) -> None:
        super().__init__("drone_teleop")
        self._keyboard = keyboard
        self._screen = screen
        rate = self._number("repeat_rate", 20.0, "Hz at which cmd_vel is published while a key is held", 1.0, 200.0)
        self._drone = self._text("drone", "user_drone", "object whose place and collisions the status line shows")
        self._ai_drone = self._text("ai_drone", "ai_drone", "object that comes down while F4 is held")
        self._hand = Hand(
            speed=self._number("speed", 2.0, "m/s at first", 0.01, 100.0),
            turn=self._number("turn", 1.0, "rad/s at first", 0.01, 100.0),
            delay=self._number("key_delay", 0.6, "s that a press counts until its first repeat", 0.05, 5.0),
            timeout=self._number("key_timeout", 0.15, "s without a repeat after which a key is let go", 0.02, 5.0),
            cooldown=self._number("toggle_cooldown", 0.25, "s of rest that a key needs that asks once", 0.0, 5.0),
            latch=self._flag("latch", False, "moving keys count until another key, not until they are let go"),
        )
        self._cameras: list[str] = []
        self._camera = self._text("camera", "", "camera selected at the start; the scene's first if empty")
        self._position: tuple[float, float, float] | None = None
        self._hit = ""
        self._ai_state = ""
        self._paused = False
        self._shows_debug = False
        self._depth = DEPTH
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
            (1.0 / rate, self._command),
            (HOLD_PERIOD, self._ground),
            (STATUS_PERIOD, self._show_status),
            (1.0, self._diagnose),
        ):
            self.create_timer(period, callback, clock=steady)

    def let_go(self) -> None:
        """Lets go of all keys, says so, and waits until that has arrived."""
        self._hand.release()
        self._command()
        self._ground()
        self._cmd_vel.wait_for_all_acked(ARRIVES_WITHIN)

    def _read_keys(self) -> None:
        for key in self._keyboard.read():
            self._keys += 1
            match self._hand.press(key, time.monotonic()):
                case Action.CAMERA:
                    self._next_camera()
                case Action.PICTURE:
                    self._ask(self._save, Trigger.Request(), self._saved)
                case Action.DEBUG:
                    self._shows_debug = not self._shows_debug
                    self._ask(self._debug, SetBool.Request(data=self._shows_debug), self._was_debug)
                case Action.SHALLOWER | Action.DEEPER as way:
                    self._look(self._depth + (1 if way is Action.DEEPER else -1))
                case Action.RESET:
                    self._ask(self._reset, ResetSimulation.Request(), self._was_reset)
                case Action.PAUSE:
                    wanted = SimulationState.STATE_PLAYING if self._paused else SimulationState.STATE_PAUSED
                    request = SetSimulationState.Request(state=SimulationState(state=wanted))
                    self._ask(self._set_state, request, self._was_paused)

    def _command(self) -> None:
        velocity = self._hand.velocity(time.monotonic())
        if velocity is not None:
            twist = Twist()
            twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.z = velocity
            self._cmd_vel.publish(twist)

    def _ground(self) -> None:
        grounds = self._hand.grounds(time.monotonic())
        if grounds is not None:
            self._hold.publish(Bool(data=grounds))

    def _next_camera(self) -> None:
        if not self._cameras:
            self._screen.say("no cameras: the scene is not here yet, or has none")
            return
        self._camera = self._cameras[(self._cameras.index(self._camera) + 1) % len(self._cameras)]
        self._select.publish(String(data=self._camera))

    def _ask(self, client: Any, request: Any, answered: Any) -> None:
        """Calls a service without waiting for its answer, which goes to `answered`."""
        if not client.service_is_ready():
            self._screen.say(f"nobody offers {client.srv_name}")
            return
        client.call_async(request).add_done_callback(lambda future: answered(future.result()))

    def _saved(self, answer: Trigger.Response) -> None:
        self._screen.say(f"saved {answer.message}" if answer.success else f"no picture: {answer.message}")

    def _look(self, depth: int) -> None:
        """Asks for octrees of another depth; drone_sim knows how deep is too deep."""
        value = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=depth)
        request = SetParameters.Request(parameters=[Parameter(name="debug_depth", value=value)])
        self._ask(self._parameters, request, lambda answer: self._has_looked(depth, answer))

    def _has_looked(self, depth: int, answer: SetParameters.Response) -> None:
        if answer.results[0].successful:
            self._depth = depth
            self._screen.say(f"octrees {depth} deep")
        else:
            self._screen.say(f"octrees stay {self._depth} deep: {answer.results[0].reason}")

    def _was_debug(self, answer: SetBool.Response) -> None:
        self._screen.say(answer.message)

    def _was_reset(self, answer: ResetSimulation.Response) -> None:
        if answer.result.result == Result.RESULT_OK:
            self._hit = ""
            self._screen.say("started over")
        else:
            self._screen.say(f"not started over: {answer.result.error_message}")

    def _was_paused(self, answer: SetSimulationState.Response) -> None:
        # Somebody else may have paused or continued; then this key's next press does what it says.
        if answer.result.result in (Result.RESULT_OK, SetSimulationState.Response.ALREADY_IN_TARGET_STATE):
            self._paused = not self._paused
        else:
            self._screen.say(f"neither paused nor continued: {answer.result.error_message}")

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
        if self._drone.encode() not in data:  # reading thousands of events takes longer than the step they are of
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
        parts = [f"speed {self._hand.speed:.2f} turn {self._hand.turn:.2f}"]
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

    def _diagnose(self) -> None:
        values = {"keys read": self._keys, "speed": self._hand.speed, "turn": self._hand.turn, "camera": self._camera}
        status = DiagnosticStatus(
            level=DiagnosticStatus.OK,
            name="drone_teleop: keyboard",
            message="reading keys",
            values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
        )
        diagnostics = DiagnosticArray(status=[status])
        diagnostics.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(diagnostics)

    def _number(self, name: str, default: float, description: str, low: float, high: float) -> float:
        limits = [FloatingPointRange(from_value=low, to_value=high)]
        descriptor = ParameterDescriptor(description=description, floating_point_range=limits, read_only=True)
        return float(self.declare_parameter(name, default, descriptor).value)

    def _text(self, name: str, default: str, description: str) -> str:
        descriptor = ParameterDescriptor(description=description, read_only=True)
        return str(self.declare_parameter(name, default, descriptor).value)

    def _flag(self, name: str, default: bool, description: str) -> bool:
        descriptor = ParameterDescriptor(description=description, read_only=True)
        return bool(self.declare_parameter(name, default, descriptor).value)


ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)


def _interrupt(*_: Any) -> None:
    """The first of the signals ends the node in good order, and no second one disturbs that."""
    for number in ENDS:
        signal.signal(number, lambda *_: None)  # not SIG_IGN, of which Python complains if one is pending already
    raise KeyboardInterrupt


def main(args: list[str] | None = None) -> int:
    """Runs the node until Ctrl-C; status 2 where there are no keys to read."""
    if not sys.stdin.isatty():
        print("drone_teleop: stdin is not a terminal, so there are no keys to read", file=sys.stderr)
        return 2
    screen = Screen(sys.stdout)
    try:
        for number in ENDS:
            signal.signal(number, _interrupt)
        # rclpy's own handlers would end the context before the drone is told to stop.
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        with Keyboard(sys.stdin.fileno()) as keyboard:
            node = TeleopNode(keyboard, screen)
            try:
                screen.say(HELP)
                rclpy.spin(node)
            finally:
                node.let_go()
                screen.close()
    except (KeyboardInterrupt, EOFError):
        pass
    except (InvalidParameterTypeException, InvalidParameterValueException) as error:
        print(f"drone_teleop: {error}", file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
