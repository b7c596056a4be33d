"""Draws a picture for each hard case of motion from docs/hard_cases/motion.json: what moves, and what it reached.

python figures/motion_hard_cases.py [NAME ...]
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import motion_shapes
import style
from matplotlib.figure import Figure
from motion_panels import PANELS

OUT = Path(__file__).parents[1] / "docs" / "hard_cases"
SHAPES: dict[str, Callable[[Figure], None]] = {
    "tumble": motion_shapes.tumble, "spin": motion_shapes.spin, "stack": motion_shapes.stack,
    "mass_ratio": motion_shapes.mass_ratio, "bounce": motion_shapes.bounce, "plate": motion_shapes.plate,
    "corner": motion_shapes.corner, "inside": motion_shapes.inside, "sticks": motion_shapes.slope,
    "slides": motion_shapes.slope, "island": motion_shapes.island, "repeats": motion_shapes.heap,
    "stall": motion_shapes.clock}


def draw(name: str, case: dict[str, Any]) -> Figure:
    """What moves on the left, one or two panels on the right."""
    figure = style.sheet(case["title"], f"{case['tries']} Held to: {case['held_to']}.")
    SHAPES[name](figure)
    for panel, place in zip(PANELS[name], motion_shapes.places(len(PANELS[name])), strict=True):
        panel(figure, place, case["runs"])
    return figure


def main() -> None:
    parser = argparse.ArgumentParser(prog="motion_hard_cases", description="Draws the hard cases of motion.")
    parser.add_argument("names", nargs="*", choices=[*SHAPES, []], metavar="NAME", help=f"which: {', '.join(SHAPES)}")
    parser.add_argument("--out", type=Path, default=OUT, help="folder to read from and to write to")
    options = parser.parse_args()
    cases = json.loads((options.out / "motion.json").read_text())["cases"]
    for name in options.names or SHAPES:
        path = options.out / f"motion_{name}.png"
        style.save(draw(name, cases[name]), path)
        print(path)


if __name__ == "__main__":
    main()
