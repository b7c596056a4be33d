"""`topic list`, `topic info`, `topic echo`, `topic hz`, `topic pub`: what one types most, without a ROS install."""

import argparse
import os
import sys
from pathlib import Path

import rclpy
from rclpy.executors import ExternalShutdownException

from .commands import TopicError, echo, hz, info, list_topics, pub


def parser() -> argparse.ArgumentParser:
    """The command line."""
    root = argparse.ArgumentParser(prog="topic", description="Looks at the topics of the running nodes.")
    commands = root.add_subparsers(dest="command", required=True, metavar="COMMAND")

    command = commands.add_parser("list", help="the topics that there are")
    command.add_argument("-t", "--types", action="store_true", help="with their types")
    command.set_defaults(run=list_topics)

    command = commands.add_parser("info", help="who publishes a topic and who listens")
    command.add_argument("topic")
    command.set_defaults(run=info)

    command = commands.add_parser("echo", help="print the messages of a topic")
    command.add_argument("topic")
    command.add_argument("type", nargs="?", help="like geometry_msgs/msg/Twist; looked up if not given")
    command.add_argument("--once", dest="count", action="store_const", const=1, help="only one message")
    command.add_argument("--count", type=_positive_integer, metavar="N", help="only N messages")
    command.add_argument("--field", metavar="A.B", help="only this field, like pose.position")
    command.add_argument("--full", action="store_true", help="do not shorten long arrays and strings")
    command.set_defaults(run=echo)

    command = commands.add_parser("hz", help="how often messages arrive, by the clock on the wall")
    command.add_argument("topic")
    command.add_argument("--window", type=_positive_integer, default=1000, metavar="N",
                         help="look at the last N messages (default: %(default)s)")
    command.set_defaults(run=hz)

    command = commands.add_parser(
        "pub", help="publish a message again and again",
        epilog="example: topic pub cmd_vel geometry_msgs/msg/Twist '{linear: {x: 1.0}}'",
    )
    command.add_argument("topic")
    command.add_argument("type", help="like geometry_msgs/msg/Twist")
    command.add_argument("message", nargs="?", default="{}", metavar="YAML",
                         help="fields that are not given keep their defaults")
    command.add_argument("--rate", type=_positive_number, default=10.0, metavar="HZ", help="default: %(default)s")
    command.add_argument("--once", action="store_true", help="one message, as soon as somebody listens")
    command.set_defaults(run=pub)
    return root


def _positive_integer(text: str) -> int:
    if not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"a whole number above 0 is needed, not '{text}'")
    return int(text)


def _positive_number(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not 0.0 < number < float("inf"):
        raise argparse.ArgumentTypeError(f"a number above 0 is needed, not '{text}'")
    return number


def main() -> int:
    """Exit status 1 and one line if there is no such topic, type or field."""
    arguments = parser().parse_args()
    os.environ.setdefault("AMENT_PREFIX_PATH", sys.prefix)
    os.environ.setdefault("FASTRTPS_DEFAULT_PROFILES_FILE", str(Path(__file__).parents[1] / "fastdds.xml"))
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
