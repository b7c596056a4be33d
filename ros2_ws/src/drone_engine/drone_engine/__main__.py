"""The command `drone_engine`, or `python -m drone_engine`: reports on scenes, without running any node."""

import argparse
import sys

from drone_engine.explain import __main__ as explain
from drone_engine.explain import step


def main() -> int:
    """Runs the command named by the first argument; returns its exit status."""
    commands = {"explain": explain.main, "step": step.main}
    parser = argparse.ArgumentParser(prog="drone_engine", description="Reports on scenes, without running any node.")
    parser.add_argument("command", choices=commands,
                        help="explain: what a scene enables and what it costs; step: the stages of a step")
    parser.add_argument("rest", nargs=argparse.REMAINDER, metavar="...",
                        help="its arguments; see drone_engine COMMAND --help")
    options = parser.parse_args()
    return commands[options.command](options.rest)


if __name__ == "__main__":
    sys.exit(main())
