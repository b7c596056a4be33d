"""The command line of `topic list`, `topic info`, `topic echo`, `topic hz` and `topic pub`."""

import argparse
import os
import sys

import rclpy
from rclpy.executors import ExternalShutdownException

from drone_sim.node import DDS_PROFILE
from drone_sim.topic.commands import TopicError, echo, hz, info, list_topics, pub


def parser() -> argparse.ArgumentParser:
    """The parser of the command line; each command sets `run` to its function."""
    root = argparse.ArgumentParser(prog="topic", description="Inspects and publishes topics.")
    commands = root.add_subparsers(dest="command", required=True, metavar="COMMAND")

    command = commands.add_parser("list", help="list all topics")
    command.add_argument("-t", "--types", action="store_true", help="with their types")
    command.set_defaults(run=list_topics)

    command = commands.add_parser("info", help="show the type, publishers and subscribers of a topic")
    command.add_argument("topic")
    command.set_defaults(run=info)

    command = commands.add_parser("echo", help="print the messages of a topic")
    command.add_argument("topic")
    command.add_argument("type", nargs="?", help="such as geometry_msgs/msg/Twist; by default that of the topic")
    command.add_argument("--once", dest="count", action="store_const", const=1, help="one message only")
    command.add_argument("--count", type=_positive_integer, metavar="N", help="N messages only")
    command.add_argument("--field", metavar="A.B", help="this field only, such as pose.position")
    command.add_argument("--full", action="store_true", help="do not shorten long arrays and strings")
    command.set_defaults(run=echo)

    command = commands.add_parser("hz", help="measure the rate of a topic in wall time")
    command.add_argument("topic")
    command.add_argument("--window", type=_positive_integer, default=1000, metavar="N",
                         help="average over the last N messages (default: %(default)s)")
    command.set_defaults(run=hz)

    command = commands.add_parser(
        "pub", help="publish a message repeatedly",
        epilog="example: topic pub cmd_vel geometry_msgs/msg/Twist '{linear: {x: 1.0}}'",
    )
    command.add_argument("topic")
    command.add_argument("type", help="such as geometry_msgs/msg/Twist")
    command.add_argument("message", nargs="?", default="{}", metavar="YAML",
                         help="its fields; the others keep their defaults")
    command.add_argument("--rate", type=_positive_number, default=10.0, metavar="HZ", help="default: %(default)s")
    command.add_argument("--once", action="store_true", help="one message, once there is a subscriber")
    command.set_defaults(run=pub)
    return root


def _positive_integer(text: str) -> int:
    if not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"expected an integer above 0, got '{text}'")
    return int(text)


def _positive_number(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not 0.0 < number < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number above 0, got '{text}'")
    return number


def main() -> int:
    """Runs one command; returns the exit status, 1 with one line for an unknown topic, type or field."""
    arguments = parser().parse_args()
    os.environ.setdefault("AMENT_PREFIX_PATH", sys.prefix)
    os.environ.setdefault("FASTRTPS_DEFAULT_PROFILES_FILE", str(DDS_PROFILE))
    rclpy.init()
    node = rclpy.create_node(f"topic_{os.getpid()}", start_parameter_services=False, enable_rosout=False)
    try:
        arguments.run(node, arguments)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except BrokenPipeError:  # `topic list | head -1`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except TopicError as error:
        print(f"topic: {error}", file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
