"""Real processes, and a node of the test in the ROS graph that they form."""

import ctypes
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Self, TypeVar

import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

T = TypeVar("T")

PR_SET_PDEATHSIG = 1  # of linux/prctl.h
prctl = ctypes.CDLL(None).prctl  # looked up here: a forked child of a multithreaded process must not take locks

DEADLINE = 120.0  # s; only a test that fails waits so long. The first start on a machine compiles kernels


def _die_with_the_test() -> None:
    """Has the kernel kill the process when the test ends, so that it cannot reach the nodes of the next test."""
    prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


class NodeProcess:
    """A process in its own process group, with its output. As a context manager it ends with the block."""

    def __init__(self, name: str, command: list[str], environment: dict[str, str]) -> None:
        self.name = name
        self.ended_by_test = False
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - a file, unlike a pipe, is never full
        self._process = subprocess.Popen(
            command, env=environment, start_new_session=True, preexec_fn=_die_with_the_test,
            stdin=subprocess.DEVNULL, stdout=self._log, stderr=subprocess.STDOUT,
        )

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    def output(self) -> str:
        """All that the process has written so far."""
        return os.pread(self._log.fileno(), 1 << 24, 0).decode(errors="replace")

    def child(self, module: str) -> int:
        """The process that it has started for a Python module; 0 if there is none."""
        for pid in Path(f"/proc/{self.pid}/task/{self.pid}/children").read_text().split():
            if module in Path(f"/proc/{pid}/cmdline").read_text().split("\0"):
                return int(pid)
        return 0

    def send(self, number: signal.Signals) -> None:
        """Sends a signal to the process; its end is then not an error."""
        self.ended_by_test = True
        self._process.send_signal(number)

    def wait(self, timeout: float = DEADLINE) -> int:
        """Waits for the end and returns the exit status, -N after signal N."""
        self.ended_by_test = True
        try:
            return self._process.wait(timeout)
        except subprocess.TimeoutExpired:
            pytest.fail(f"{self.name} has not ended within {timeout:g} s")

    def interrupt(self, timeout: float = DEADLINE) -> int:
        """Ctrl-C: SIGINT, then the exit status."""
        self.send(signal.SIGINT)
        return self.wait(timeout)

    def kill(self) -> None:
        """SIGKILL to the whole group, if anything of it is left."""
        self.ended_by_test = True
        with suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        self._process.wait()

    def ended(self) -> bool:
        """Whether it has ended."""
        return self._process.poll() is not None

    def died(self) -> bool:
        """Whether it ended with an error by itself."""
        return not self.ended_by_test and self._process.poll() not in (None, 0)

    def state(self) -> str:
        """Running, or the exit status."""
        status = self._process.poll()
        return "running" if status is None else f"exit status {status}"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()


class Spawn:
    """Starts processes in one ROS domain."""

    def __init__(self, domain_id: int) -> None:
        self.processes: list[NodeProcess] = []
        self.environment = os.environ | {"ROS_DOMAIN_ID": str(domain_id), "PYTHONUNBUFFERED": "1"}

    def __call__(self, module: str, *ros_arguments: str, **parameters: Any) -> NodeProcess:
        """A node: `spawn("drone_sim.sim_node", "-r", "__ns:=/a", scene="island")`."""
        command = [sys.executable, "-m", module, "--ros-args", *ros_arguments]
        for name, value in parameters.items():
            command += ["-p", f"{name}:={json.dumps(value, default=str)}"]
        return self.command(module, command)

    def command(self, name: str, command: list[str], **environment: str) -> NodeProcess:
        """Any other program, with additional environment variables."""
        self.processes.append(NodeProcess(name, command, self.environment | environment))
        return self.processes[-1]


class Graph:
    """A node of the test in the graph of the processes; its callbacks run within `wait_for`."""

    def __init__(self, domain_id: int, processes: list[NodeProcess]) -> None:
        self._processes = processes
        self._context = Context()
        rclpy.init(context=self._context, domain_id=domain_id)
        self.node: Node = rclpy.create_node("test", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._subscriptions: list[Subscription] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)

    def listen(self, kind: type[Any], topic: str, qos: QoSProfile | int = 100, raw: bool = False) -> list[Any]:
        """Subscribes until the test ends; the list grows by every message that arrives (CDR bytes if `raw`)."""
        heard: list[Any] = []
        self._subscriptions.append(self.node.create_subscription(kind, topic, heard.append, qos, raw=raw))
        return heard

    def stop_listening(self) -> None:
        """Ends all subscriptions, so that their messages do not delay those of the next test."""
        while self._subscriptions:
            self.node.destroy_subscription(self._subscriptions.pop())

    def publisher(self, kind: type[Any], topic: str, qos: QoSProfile | int = 10) -> Publisher:
        """A publisher that has at least one subscriber by the time that this returns."""
        publisher = self.node.create_publisher(kind, topic, qos)
        self.wait_for(publisher.get_subscription_count, f"a subscriber of {topic}")
        return publisher

    @contextmanager
    def repeating(self, publisher: Publisher, message: Any, rate: float = 20.0) -> Iterator[None]:
        """Within the block, and while `wait_for` runs, publishes the message again and again, at a rate in Hz."""
        publisher.publish(message)
        timer = self.node.create_timer(1.0 / rate, lambda: publisher.publish(message))
        try:
            yield
        finally:
            self.node.destroy_timer(timer)

    def call(self, kind: type[Any], service: str, request: Any, timeout: float = DEADLINE) -> Any:
        """Calls a service as soon as it is there and returns its answer."""
        client = self.node.create_client(kind, service)
        self.wait_for(client.service_is_ready, f"service {service}", timeout)
        future = client.call_async(request)
        self.wait_for(future.done, f"an answer of {service}", timeout)
        self.node.destroy_client(client)
        return future.result()

    def wait_for(self, predicate: Callable[[], T], what: str = "", timeout: float = DEADLINE) -> T:
        """Lets the graph run until the predicate is true, and returns what it gave.

        Fails the test after `timeout` s, and at once if a process has died.
        """
        deadline = time.monotonic() + timeout
        while not (found := predicate()):
            if dead := [process.name for process in self._processes if process.died()]:
                pytest.fail(f"{', '.join(dead)} died while waiting for {what or predicate}")
            if time.monotonic() > deadline:
                pytest.fail(f"{what or predicate}: not within {timeout:g} s")
            self._executor.spin_once(timeout_sec=0.05)
        return found
