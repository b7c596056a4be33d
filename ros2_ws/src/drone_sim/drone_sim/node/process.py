"""How a node's process runs: spins until the node is done or a signal asks for the end, and leaves nothing torn.

rclpy's own signal handlers end the context under whatever callback is running, which then fails in the middle of
what it publishes or writes. Here a signal only sets a future, and the callback that is running is the last.
"""

import logging
import os
import signal
import sys
import threading
from collections.abc import Callable

import rclpy
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

ENDS = (signal.SIGINT, signal.SIGTERM)
# A publisher's events would be asked for in every round of the executor, which takes long where there are many; a
# subscriber that wants more than is offered is warned in its own process.
NO_CALLBACKS = PublisherEventCallbacks(use_default_callbacks=False)
PARAMETER_ERRORS = (InvalidParameterTypeException, InvalidParameterValueException)


class NodeLog(logging.Handler):
    """What modules that know no ROS warn of, as lines of a node's log; else nobody would see them."""

    def __init__(self, log: RcutilsLogger) -> None:
        super().__init__(logging.WARNING)
        self._log = log

    def emit(self, record: logging.LogRecord) -> None:
        self._log.warning(record.getMessage())


def run(name: str, make_node: Callable[[Future], Node], args: list[str] | None, *errors: type[Exception]) -> int:
    """Makes a node and spins it; the future that it is given ends it. Returns the exit status.

    An error of the given types, or a parameter that cannot be, is one line that begins with the name, and status 1.
    """
    stop = Future()
    for number in ENDS:  # while the node is being made: kernels may be compiling, which nobody should wait for
        signal.signal(number, signal.default_int_handler)
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = make_node(stop)
        try:
            _watch(stop)
            rclpy.spin_until_future_complete(node, stop)
        finally:
            node.destroy_node()
    except KeyboardInterrupt:
        pass
    except (*errors, *PARAMETER_ERRORS) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    return 0


def _watch(stop: Future) -> None:
    """From here on a signal sets the future. Python runs handlers in the main thread only, which may be asleep in a
    wait of ROS; so another thread reads from the pipe into which the interpreter writes each signal at once."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    for number in ENDS:
        signal.signal(number, lambda *_: None)
    signal.set_wakeup_fd(writer)
    threading.Thread(target=lambda: (os.read(reader, 1), stop.set_result(None)), name="signals", daemon=True).start()
