"""The process of a node: spins until the node is done or a signal asks it to end. Every node's `main` calls `run`.

rclpy's own signal handlers shut the context down under the callback that is running, which then fails in the middle
of what it publishes or writes. Here a signal only sets a `Stop`, and the callback that is running is the last one.
"""

import logging
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from typing import TypeVar

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from drone_sim.node.parameters import ParameterError

N = TypeVar("N", bound=Node)

END_SIGNALS = (signal.SIGINT, signal.SIGTERM)
LAST_CALLBACK = 1.0  # s that a callback in another thread may still take once its node stops


class Stop:
    """Request that the process of a node ends, set by a signal or by the node itself.

    `interrupted` is True once SIGINT (Ctrl-C) has arrived: work that is not finished is then cut short.
    """

    def __init__(self) -> None:
        self.future = Future()
        self.interrupted = False

    def set(self) -> None:
        """Requests the end; may be called repeatedly and from any thread."""
        if not self.future.done():
            self.future.set_result(None)

    def is_set(self) -> bool:
        """Whether the end has been requested."""
        return bool(self.future.done())


class NodeLog(logging.Handler):
    """Forwards warnings of Python's `logging` to a node's log, for modules that do not import ROS."""

    def __init__(self, log: RcutilsLogger) -> None:
        super().__init__(logging.WARNING)
        self._log = log

    def emit(self, record: logging.LogRecord) -> None:
        """Logs one record as a warning of the node."""
        self._log.warning(record.getMessage())


def spin(node: Node, stop: Stop) -> None:
    """Runs the callbacks of a node in this thread until `stop` is set."""
    rclpy.spin_until_future_complete(node, stop.future)


@contextmanager
def spinning(node: Node, stop: Stop) -> Iterator[None]:
    """Runs the callbacks of a node in another thread within the block.

    An exception in a callback sets `stop` and is raised at the end of the block.
    """
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    result = ThreadPoolExecutor(1, "ros").submit(executor.spin)
    result.add_done_callback(lambda _: stop.set())
    try:
        yield
    finally:
        executor.shutdown(timeout_sec=LAST_CALLBACK)
    with suppress(ExternalShutdownException):
        result.result()


def run(
    name: str, make_node: Callable[[Stop], N], args: list[str] | None, *errors: type[Exception],
    work: Callable[[N, Stop], None] = spin, end_signals: Sequence[signal.Signals] = END_SIGNALS,
) -> int:
    """Makes a node, runs `work(node, stop)` until it returns, destroys the node; returns the exit status.

    name: of the node, the first word of an error. work: has to return soon after `stop` is set. An exception of the
    types `errors` or a ParameterError becomes one line on stderr and status 1; its traceback is logged at level debug.
    """
    stop = Stop()
    for number in end_signals:  # until the node exists a signal interrupts: compiling kernels may take a minute
        signal.signal(number, signal.default_int_handler)
    log = NodeLog(get_logger(name))
    logging.getLogger().addHandler(log)
    expected: tuple[type[Exception], ...] = (*errors, ParameterError)
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        node = make_node(stop)
        try:
            _set_on_signal(stop, end_signals)
            work(node, stop)
        finally:
            node.destroy_node()
    except KeyboardInterrupt:
        pass
    except expected as error:
        get_logger(name).debug(traceback.format_exc())
        print(f"{name}: {error}", file=sys.stderr)
        return 1
    finally:
        logging.getLogger().removeHandler(log)
        rclpy.try_shutdown()
    return 0


def _set_on_signal(stop: Stop, signals: Sequence[signal.Signals]) -> None:
    """From here on a signal sets `stop` and does nothing else.

    Python runs signal handlers in the main thread only, which may be waiting inside ROS. So another thread reads the
    pipe into which the interpreter writes the number of each signal at once.
    """
    reader, writer = os.pipe()
    os.set_blocking(writer, False)

    def watch() -> None:
        while True:
            numbers = os.read(reader, 64)
            stop.interrupted |= signal.SIGINT in numbers
            if set(signals) & set(numbers):
                stop.set()

    for number in signals:
        signal.signal(number, lambda *_: None)
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    threading.Thread(target=watch, name="signals", daemon=True).start()
