"""Writes lock.txt: the version of every installed package, the message packages built here excepted."""

import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path

HEADER = "# Every package that the other lists bring with them, so that two machines get the same.\n"


def came_from_an_index(name: str) -> bool:
    """False for what the build put into the environment, and for modules that a wheel carries inside it."""
    return (distribution(name).read_text("RECORD") or "").find("WHEEL") >= 0


freeze = subprocess.run([sys.executable, "-m", "pip", "freeze"], capture_output=True, text=True, check=True)
pins = [line for line in freeze.stdout.splitlines() if "==" in line and came_from_an_index(line.split("==")[0])]
Path(__file__).with_name("lock.txt").write_text(HEADER + "\n".join(pins) + "\n")
