"""Plots of error over CPU time of the collision levels, from docs/accuracy/collision.json.

    python -m figures.accuracy.collision
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from figures import DOCS, style
from figures.style import GRAY, length, number, tidy

OUT = DOCS / "accuracy"
COLORS = {"sphere": "#efa22f", "obb": "#d1495b", "octree": "#7d5ba6", "triangle": "#2f6db3"}
SAMPLES = {"flights": "poses from flights", "random": "random poses near touch"}
LEFT, RIGHT = (0.075, 0.125, 0.405, 0.63), (0.575, 0.125, 0.405, 0.63)
HALO = [withStroke(linewidth=3.5, foreground="white", alpha=0.85)]


def panel(figure: Figure, place: style.Place, samples: dict[str, Any], cost: str, error: str, title: str, x_label: str,
          y_label: str, note: Callable[[dict[str, Any]], str], none: str) -> None:
    """Error over CPU time, both logarithmic, for all levels and samples.

    cost, error: keys of the values; note: a remark per level; none: label of the line at the bottom, which has the
    values without an error.
    """
    axes = figure.add_axes(place)
    points = {(sample, level): (n[cost], n[error]) for sample, levels in samples.items() for level, n in levels.items()}
    wrong = [y for _, y in points.values() if y]
    floor = 10 ** (np.log10(min(wrong)) - 0.75)
    axes.set(xscale="log", yscale="log", ylim=(floor * 0.55, max(wrong) * 2.4))
    low, high = min(x for x, _ in points.values()), max(x for x, _ in points.values())
    axes.set_xlim(low / 1.9, high * 1.9)
    axes.axhspan(floor * 0.55, floor * 1.75, color="#eef3f9", zorder=0)
    axes.text(low / 1.75, floor, none, va="center", fontsize=8.5, color=COLORS["triangle"], fontweight="bold")
    for sample in samples:
        line = [(x, y or floor) for (s, _), (x, y) in points.items() if s == sample]
        axes.plot(*zip(*line, strict=True), color="#b9c0c9", linewidth=1.1, zorder=2,
                  linestyle="-" if sample == "flights" else (0, (4, 2.5)))
    for (sample, level), (x, y) in points.items():
        face = COLORS[level] if sample == "flights" else "white"
        axes.plot(x, y or floor, "o", markersize=9.5, markerfacecolor=face, markeredgecolor=COLORS[level],
                  markeredgewidth=2.0, zorder=4)
    for level, color in COLORS.items():
        ends = [(x, y or floor) for (_, name), (x, y) in points.items() if name == level]
        left = max(ends)[0] > low**0.35 * high**0.65
        x, offset = (min(ends)[0], -12) if left else (max(ends)[0], 12)
        y = float(np.prod([end[1] for end in ends])) ** (1.0 / len(ends))
        for text, rise, size, ink, weight in ((level, 6.0, 10.5, color, "bold"),
                                               (note(samples["flights"][level]), -6.5, 8.5, GRAY, "normal")):
            axes.annotate(text, (x, y), xytext=(offset, rise), textcoords="offset points", color=ink, fontsize=size,
                          fontweight=weight, va="center", ha="right" if left else "left", zorder=5,
                          path_effects=[] if level == "triangle" else HALO)
    axes.set_title(title, fontsize=11, loc="left", pad=7, fontweight="bold")
    axes.set_xlabel(x_label, fontsize=9, labelpad=3)
    axes.set_ylabel(y_label, fontsize=9, labelpad=4)
    tidy(axes)
    axes.xaxis.set_major_formatter(lambda value, _: number(value))
    axes.yaxis.set_major_formatter(lambda value, _: length(value) if value > 1.8 * floor else "")
    axes.yaxis.set_tick_params(which="minor", length=0)
    axes.xaxis.set_minor_formatter(lambda *_: "")


def levels(result: dict[str, Any]) -> Figure:
    """All poses together: error over time per query."""
    figure = style.sheet("Cost of accuracy in collision", "Each level refines the one before it: a bounding sphere per "
                         "body, a bounding box, small boxes around the surface, the triangles of the surface.")
    samples = result["samples"]
    panel(figure, LEFT, samples, "question_us", "gap_mean", "Intersection test", "CPU time per test, µs",
          "distance at the first hit, mean",
          lambda n: f"{100 * n['false'] / n['poses']:.0f} % wrong answers", "exact")
    panel(figure, RIGHT, samples, "answer_us", "depth_median", "Contacts",
          "CPU time of the contacts of a pair, µs", "error of the depth, median",
          lambda n: f"normal error {n['normal_median']:.0f}°" if n["normal_median"] else
          f"no contact in {100 * n['silent'] / n['contacts']:.1f} %", "reference")
    marks = [Line2D([], [], marker="o", markersize=8, markeredgewidth=1.8, markeredgecolor=style.FAINT, color="#b9c0c9",
                    markerfacecolor=style.FAINT if sample == "flights" else "white",
                    linestyle="-" if sample == "flights" else (0, (4, 2.5)), label=label)
             for sample, label in SAMPLES.items()]
    figure.legend(handles=marks, loc="upper right", bbox_to_anchor=(0.985, 0.985), frameon=False, fontsize=9, ncols=2)
    return figure


def models(result: dict[str, Any]) -> Figure:
    """Distance at the first hit of each level, by model."""
    found = result["models"]["flights"]
    rows = sorted((name for name, n in found.items() if n["obb"]["alarms"]), key=lambda m: found[m]["obb"]["gap_mean"])
    figure = style.sheet("Distance at the first hit of each level", "The mean distance of the surfaces at the first "
                         "hit, on flights toward each object and past it. Hollow and slanted objects have the largest "
                         "distances; the triangle level reports a hit at the touch.")
    axes = figure.add_axes((0.12, 0.115, 0.86, 0.655))
    for y, model in enumerate(rows):
        gaps = {level: found[model][level]["gap_mean"] for level in COLORS if level != "triangle"}
        known = [gap for gap in gaps.values() if gap]
        axes.plot([min(known), max(known)], [y, y], color="#d5dae0", linewidth=2.2, zorder=1, solid_capstyle="round")
        for level, gap in gaps.items():
            if gap:
                axes.plot(gap, y, "o", markersize=8, color=COLORS[level], zorder=3)
    axes.set(xscale="log", ylim=(-0.7, len(rows) - 0.3))
    axes.set_yticks(range(len(rows)), [model.replace("_", " ") for model in rows])
    axes.set_xlabel("distance of the surfaces", fontsize=9, labelpad=2)
    tidy(axes)
    axes.xaxis.set_major_formatter(lambda value, _: length(value))
    axes.tick_params(axis="y", labelsize=9, colors=style.INK)
    handles = [Line2D([], [], marker="o", linestyle="", color=COLORS[level], markersize=8, label=level)
               for level in reversed(list(COLORS)[:3])]
    figure.legend(handles=handles, loc="upper right", bbox_to_anchor=(0.985, 0.985), frameon=False, fontsize=9.5,
                  ncols=3)
    return figure


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m figures.accuracy.collision",
                                     description="Plots error over CPU time of the collision levels.")
    parser.add_argument("--out", type=Path, default=OUT, help="folder with collision.json, and for the pictures")
    options = parser.parse_args()
    result = json.loads((options.out / "collision.json").read_text())
    for name, draw in (("collision", levels), ("collision_models", models)):
        style.save(draw(result), options.out / f"{name}.png")
        print(options.out / f"{name}.png")


if __name__ == "__main__":
    main()
