"""`python -m drone_sim.bag info out/run1` and `python -m drone_sim.bag recover out/run1`."""

import argparse
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.errors import ReaderError

from drone_sim.bag import BagError, recover


def info(path: Path) -> Table:
    """A table of the topics of a bag, with types, counts and rates. Raises BagError."""
    try:
        with Reader(path) as bag:
            seconds = bag.duration / 1e9
            table = Table(title=f"{path}: {bag.message_count} messages in {seconds:.3f} s", title_justify="left")
            table.add_column("topic", overflow="fold")
            table.add_column("type", overflow="fold")
            table.add_column("messages", justify="right")
            table.add_column("Hz", justify="right")
            for connection in sorted(bag.connections, key=lambda each: each.topic):
                rate = f"{connection.msgcount / seconds:.1f}" if connection.msgcount > 1 and seconds else ""
                table.add_row(connection.topic, connection.msgtype, str(connection.msgcount), rate)
            return table
    except (OSError, ReaderError) as error:
        hint = f"; try: python -m drone_sim.bag recover {path}" if path.is_dir() else ""
        raise BagError(f"{path}: {error}{hint}") from None


def main() -> int:
    """Runs one command; returns the exit status, 1 with one line if the bag cannot be read."""
    parser = argparse.ArgumentParser(prog="python -m drone_sim.bag", description="Inspects and recovers bags.")
    commands = parser.add_subparsers(dest="command", required=True)
    for name, help_text in (
        ("info", "show topics, types, counts and duration"),
        ("recover", "complete a bag whose recorder was killed, from its intact chunks"),
    ):
        commands.add_parser(name, help=help_text, description=help_text).add_argument("path", type=Path, metavar="BAG")
    arguments = parser.parse_args()
    try:
        if arguments.command == "recover":
            print(f"{arguments.path}: {'recovered' if recover(arguments.path) else 'already complete'}")
        else:
            Console().print(info(arguments.path))
    except BagError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
