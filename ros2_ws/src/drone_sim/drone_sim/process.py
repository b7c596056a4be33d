"""How a node's process runs: spins until the node is done or a signal asks for the end, and leaves nothing torn.

rclpy's own signal handlers end the context under whatever callback is running, which then fails in the middle of
what it publishes or writes. Here a signal only sets a future, and the callback that is running is the last.
"""

import signal
import sys
import threading
from collections.abc import Callable

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

ENDS = (signal.SIGINT, signal.SIGTERM)


def run(name: str, make_node: Callable[[Future], Node], args: list[str] | None, *errors: type[Exception]) -> int:
    """Makes a node and spins it; the future that it is given ends it. Returns the exit status.

    An error of the given types, when it is made or while it runs, is one line that begins with the name, and status 1.
    """
    stop = Future()
    # Waited for in a thread of their own: a spinning main thread would not look at them before its next callback.
    signal.pthread_sigmask(signal.SIG_BLOCK, ENDS)
    threading.Thread(target=lambda: stop.set_result(signal.sigwait(ENDS)), name="signals", daemon=True).start()
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = make_node(stop)
        try:
            rclpy.spin_until_future_complete(node, stop)
        finally:
            node.destroy_node()
    except errors as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    return 0
