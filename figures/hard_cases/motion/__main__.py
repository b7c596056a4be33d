"""Draws a picture for each hard case of motion from docs/hard_cases/motion.json.

    python -m figures.hard_cases.motion [NAME ...]
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from figures import DOCS, style
from figures.hard_cases.motion import shapes
from figures.hard_cases.motion.panels import PANELS

OUT = DOCS / "hard_cases"
HOLDS = "#2f8f5b"
SHAPES: dict[str, Callable[[Figure], None]] = {
    "tumble": shapes.tumble, "spin": shapes.spin, "stack": shapes.stack,
    "mass_ratio": shapes.mass_ratio, "bounce": shapes.bounce, "plate": shapes.plate,
    "corner": shapes.corner, "corner_quadrotor": shapes.corner, "inside": shapes.inside,
    "sticks": shapes.slope,
    "slides": shapes.slope, "island": shapes.island, "repeats": shapes.heap,
    "stall": shapes.clock}


def draw(name: str, case: dict[str, Any]) -> Figure:
    """The sketch on the left, one or two plots on the right."""
    figure = style.sheet(case["title"], f"{case['tries']} Criterion: {case['held_to']}.")
    SHAPES[name](figure)
    holds = all(one["met"] for run in case["runs"] for one in run["reached"])
    style.label(figure, 0.985, 0.945, "meets its limits" if holds else "known failure", ha="right", fontsize=10.5,
                fontweight="bold", color=HOLDS if holds else style.MISSED)
    for panel, place in zip(PANELS[name], shapes.panel_places(len(PANELS[name])), strict=True):
        panel(figure, place, case["runs"])
    meanings = {label: line for axes in figure.axes
                for line, label in zip(*axes.get_legend_handles_labels(), strict=True) if not axes.get_legend()}
    if len(meanings) > 1:
        figure.legend(meanings.values(), meanings.keys(), loc="lower right", ncols=min(len(meanings), 4),
                      frameon=False, fontsize=8.5, bbox_to_anchor=(0.995, -0.01), columnspacing=1.4)
    return figure


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m figures.hard_cases.motion",
                                     description="Draws the hard cases of motion.")
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
