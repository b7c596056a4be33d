"""The command `drone_engine`, or `python -m drone_engine`: looks at scenes without running any node."""

import argparse
import sys

from drone_engine.explain import __main__ as explain
from drone_engine.explain import step


def main() -> int:
    """Runs the command that is named first."""
    commands = {"explain": explain.main, "step": step.main}
    parser = argparse.ArgumentParser(prog="drone_engine", description="Looks at scenes without running the nodes.")
    parser.add_argument("command", choices=commands,
                        help="explain: what a scene switches on, and what it costs; step: the stages of a step")
    parser.add_argument("rest", nargs=argparse.REMAINDER, metavar="...", help="drone_engine COMMAND --help tells")
    options = parser.parse_args()
    return commands[options.command](options.rest)


if __name__ == "__main__":
    sys.exit(main())
