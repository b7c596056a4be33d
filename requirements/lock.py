"""Writes lock.txt: the version of every installed package, except the message packages built in this repository."""

import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path

HEADER = "# Versions of all dependencies of the other lists, so that every machine gets the same.\n"


def came_from_an_index(name: str) -> bool:
    """Whether a package was installed from an index: not built here, and not vendored in another wheel."""
    return (distribution(name).read_text("RECORD") or "").find("WHEEL") >= 0


freeze = subprocess.run([sys.executable, "-m", "pip", "freeze"], capture_output=True, text=True, check=True)
pins = [line for line in freeze.stdout.splitlines() if "==" in line and came_from_an_index(line.split("==")[0])]
Path(__file__).with_name("lock.txt").write_text(HEADER + "\n".join(pins) + "\n")
