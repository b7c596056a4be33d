"""The real teleop node on a pseudo-terminal: keys go in, commands are heard over DDS."""

import fcntl
import os
import signal
import struct
import subprocess
import sys
import termios
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any, Self

import pytest
from drone_interfaces.msg import Scene
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from simulation_interfaces.msg import Result, SimulationState
from simulation_interfaces.srv import ResetSimulation, SetSimulationState
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger

from .live import DEADLINE, Graph, Spawn

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
F4 = b"\x1bOS"
REPEAT_RATE = 30.0  # Hz, as a terminal's


class Terminal:
    """A terminal window with the teleop node in it, and what a person sees there."""

    def __init__(self, environment: dict[str, str], *arguments: str) -> None:
        self._person, self._program = os.openpty()
        fcntl.ioctl(self._program, termios.TIOCSWINSZ, struct.pack("4H", 40, 160, 0, 0))
        self.mode_before = self.mode()
        self._shown = bytearray()
        self.process = subprocess.Popen(
            [sys.executable, "-m", "drone_teleop.teleop_node", "--ros-args", *arguments],
            env=environment, stdin=self._program, stdout=self._program, stderr=self._program,
            start_new_session=True, preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
        )
        # The window has to be read all the time: a program that writes into a full one stands still.
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def mode(self) -> list[Any]:
        return termios.tcgetattr(self._program)

    def type(self, keys: bytes) -> None:
        os.write(self._person, keys)

    def shown(self) -> str:
        return self._shown.decode(errors="replace")

    def shows(self, text: str) -> bool:
        return text in self.shown()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self._program)  # the last of its end, upon which the reader finds the end
        self._reader.join()
        os.close(self._person)

    def _read(self) -> None:
        try:
            while data := os.read(self._person, 4096):
                self._shown += data
        except OSError:  # how Linux says that nobody has the other end
            pass


@pytest.fixture(scope="module")
def terminal(spawn: Spawn, graph: Graph) -> Iterator[Terminal]:
    """One node for all tests that leave it running."""
    with Terminal(spawn.environment) as terminal:
        graph.wait_for(partial(terminal.shows, "CTRL-C to quit"), "the help")
        graph.wait_for(lambda: graph.node.count_publishers("cmd_vel"), "teleop in the graph")
        yield terminal


@contextmanager
def holding(graph: Graph, terminal: Terminal, key: bytes) -> Iterator[None]:
    """A key that is down while the graph runs within the block."""
    terminal.type(key)
    timer = graph.node.create_timer(1.0 / REPEAT_RATE, lambda: terminal.type(key))
    try:
        yield
    finally:
        graph.node.destroy_timer(timer)


def test_the_keys_are_on_the_screen(terminal: Terminal) -> None:
    for row in ("u    i    o", "j    k    l", "m    ,    .", "U    I    O", "t : up (+z)", "q/z : ", "F4 (hold)"):
        assert terminal.shows(row)


def test_a_held_key_commands_and_letting_go_stops_once(graph: Graph, terminal: Terminal) -> None:
    twists: list[Twist] = graph.listen(Twist, "cmd_vel")
    holds: list[Bool] = graph.listen(Bool, "ai_drone/hold")
    with holding(graph, terminal, b"u"):
        graph.wait_for(lambda: len(twists) >= 20, "commands")
        assert {(t.linear.x, t.linear.y, t.linear.z, t.angular.z) for t in twists} == {(2.0, 0.0, 0.0, 1.0)}
    graph.wait_for(lambda: twists[-1].linear.x == 0.0, "a stop")
    with holding(graph, terminal, F4):  # time in which there could be more
        graph.wait_for(lambda: len(holds) >= 10, "the AI drone's hold")
    assert [t for t in twists if t.linear.x == 0.0] == [Twist()]
    assert twists[-1] == Twist()


def test_f4_holds_the_ai_drone_and_releases_it_once(graph: Graph, terminal: Terminal) -> None:
    holds: list[Bool] = graph.listen(Bool, "ai_drone/hold")
    twists: list[Twist] = graph.listen(Twist, "cmd_vel")
    with holding(graph, terminal, F4):
        graph.wait_for(lambda: len(holds) >= 10, "hold")
        assert all(hold.data for hold in holds)
    graph.wait_for(lambda: not holds[-1].data, "release")
    said = len(holds)
    with holding(graph, terminal, b"b"):
        graph.wait_for(lambda: len(twists) >= 10, "commands")
    assert len(holds) == said
    assert twists[-1].linear.z == -2.0


def test_tab_goes_round_the_cameras_of_the_scene(graph: Graph, terminal: Terminal) -> None:
    graph.publisher(Scene, "scene", LATCHED).publish(Scene(name="two", hash="1", cameras=["chase", "tower"]))
    selected: list[String] = graph.listen(String, "camera/select", LATCHED)
    timer = graph.node.create_timer(0.3, lambda: terminal.type(b"\t"))
    graph.wait_for(lambda: len(selected) >= 3, "three selections")
    graph.node.destroy_timer(timer)
    assert [s.data for s in selected[:3]] == ["tower", "chase", "tower"]
    last = selected[-1].data
    graph.wait_for(partial(terminal.shows, f"camera {last}"), "its name on the screen")


def test_keys_ask_the_other_nodes_and_their_answers_are_shown(graph: Graph, terminal: Terminal) -> None:
    asked: list[Any] = []

    def answer(request: Any, response: Any) -> Any:
        asked.append(request)
        if isinstance(response, Trigger.Response):
            response.success, response.message = True, "out/picture.png"
        elif isinstance(response, SetParameters.Response):
            response.results = [SetParametersResult(successful=True)]
        else:
            response.result.result = Result.RESULT_OK
        return response

    for kind, name, key, shown in (
        (Trigger, "drone_render/save_image", b"p", "saved out/picture.png"),
        (SetParameters, "drone_sim/set_parameters", b"]", "octree depth 4"),
        (ResetSimulation, "reset_simulation", b"r", "simulation reset"),
        (SetSimulationState, "set_simulation_state", b" ", "PAUSED"),
    ):
        graph.node.create_service(kind, name, answer)
        timer = graph.node.create_timer(0.3, partial(terminal.type, key))  # until teleop has found the service
        graph.wait_for(lambda: asked, name)
        graph.node.destroy_timer(timer)
        graph.wait_for(partial(terminal.shows, shown), shown)
        request = asked.pop()
        assert isinstance(request, kind.Request)
    assert request.state.state == SimulationState.STATE_PAUSED


TWO_AT_ONCE = (signal.SIGSTOP, signal.SIGINT, signal.SIGTERM, signal.SIGCONT)


@pytest.mark.parametrize(
    "ends", [(b"\x03",), (signal.SIGINT,), (signal.SIGTERM,), (signal.SIGHUP,), (signal.SIGQUIT,), TWO_AT_ONCE]
)
def test_it_ends_well_stops_the_drone_and_restores_the_terminal(
    graph: Graph, spawn: Spawn, ends: tuple[bytes | signal.Signals, ...]
) -> None:
    twists: list[Twist] = graph.listen(Twist, "quick/cmd_vel")
    with Terminal(spawn.environment, "-r", "__ns:=/quick", "-p", "latch:=true") as terminal:
        graph.wait_for(partial(terminal.shows, "CTRL-C to quit"), "the help")
        assert terminal.mode() != terminal.mode_before
        terminal.type(b"i")
        graph.wait_for(lambda: twists, "commands")
        for end in ends:
            if isinstance(end, bytes):
                terminal.type(end)
            else:
                terminal.process.send_signal(end)
        assert terminal.process.wait(DEADLINE) == 0
        assert terminal.mode() == terminal.mode_before
        graph.wait_for(lambda: twists[-1] == Twist(), "a stop")
        assert not terminal.shows("Error")


def test_without_a_terminal_it_says_so(spawn: Spawn) -> None:
    process = spawn("drone_teleop.teleop_node")
    assert process.wait() == 2
    assert process.output() == "drone_teleop: stdin: expected a terminal to read keys from, got none\n"
