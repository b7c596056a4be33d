"""Plots of the cost of accuracy in motion, from docs/accuracy/dynamics.json: python -m figures.accuracy.motion."""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures import DOCS, style
from figures.style import GRAY, length, number, tidy

OUT = DOCS / "accuracy"
LINES: dict[str, dict[str, Any]] = {
    "semi implicit euler": {"color": "#7fa8d6", "marker": "o"},
    "midpoint": {"color": "#1f5fa8", "marker": "o", "linewidth": 2.2},
    "rk4": {"color": "#7d5ba6", "marker": "o"},
    "sub-steps": {"color": "#1f5fa8", "marker": "D", "linestyle": (0, (4, 2)), "markerfacecolor": "white"},
    "MuJoCo": {"color": "#efa22f", "marker": "s"},
    "MuJoCo RK4": {"color": "#efa22f", "marker": "s", "linestyle": (0, (1.5, 1.5)), "markerfacecolor": "white"},
    "PyBullet": {"color": "#d1495b", "marker": "^"},
}
NAMES = {"semi implicit euler": "semi-implicit Euler", "midpoint": "midpoint, the default",
         "sub-steps": "midpoint, more sub-steps", "MuJoCo": "MuJoCo, Euler"}
LEAST = 1e-12  # m, rad: smaller errors are rounding
HEIGHT = 7.4  # inches


def panel(axes: Axes, lines: dict[str, Any], error: str, title: str, y_label: str, unit: str) -> None:
    """One problem: each curve runs from large steps on the left to small ones; error: key of the values."""
    for name, points in lines.items():
        cost = [point["cost_ms"] for point in points]
        errors = [max(point[error], LEAST) for point in points]
        axes.plot(cost, errors, **({"linewidth": 1.5, "markersize": 4.5} | LINES[name]), label=NAMES.get(name, name),
                  zorder=5 if name in ("midpoint", "sub-steps") else 4)
    axes.set(xscale="log", yscale="log")
    axes.set_title(title, fontsize=10.5, loc="left", pad=6, fontweight="bold")
    axes.set_ylabel(y_label, fontsize=8.5, labelpad=3)
    tidy(axes)
    axes.xaxis.set_major_formatter(lambda value, _: number(value))
    axes.yaxis.set_major_formatter(lambda value, _: _named(value, unit))
    axes.minorticks_off()
    axes.tick_params(labelsize=8)


def _named(value: float, unit: str) -> str:
    if unit == "rad":
        return f"{value:.0e} rad".replace("e-0", "e-").replace("1e+00", "1") if value < 0.01 else f"{value:g} rad"
    if value >= 0.0009:
        return length(value)
    factor, unit = next((f, u) for f, u in ((1e6, "µm"), (1e9, "nm"), (1e12, "pm"), (1e15, "fm")) if value * f > 0.9)
    return f"{value * factor:.3g} {unit}"


def diagrams(result: dict[str, Any]) -> Figure:
    """Six panels: the position errors of all problems, and the attitude error of the tumbling box."""
    figure = style.sheet("Cost of accuracy in motion", "Error at the end over CPU time per simulated second. Each "
                         "line goes from large steps to small ones; lower and further left is better.")
    figure.set_size_inches(style.WIDTH, HEIGHT)
    for line, y in zip(figure.texts, (0.975, 0.925), strict=True):
        line.set_y(y)
    problems = result["problems"]
    chosen = (("flight", "position", "Free flight, 10 s: position"), ("flight", "attitude", "Tumbling, 10 s: attitude"),
              ("quadrotor", "position", "Quadrotor, motor lag, 2 s"), ("bounce", "position", "Bounces, 4 s"),
              ("incline", "position", "Slide down a slope, 4 s"), ("stack", "position", "Stack of ten, 10 s"))
    for i, (name, error, title) in enumerate(chosen):
        axes = figure.add_axes((0.082 + 0.326 * (i % 3), 0.565 - 0.4 * (i // 3), 0.25, 0.285))
        unit = "m" if error == "position" else "rad"
        panel(axes, problems[name]["lines"], error, title, "error" if i % 3 == 0 else "", unit)
        if i // 3:
            axes.set_xlabel("ms of CPU time per simulated s", fontsize=8.5, labelpad=3)
        if i == 0:
            publish(axes, result["published"])
    handles = dict(zip(*reversed(figure.axes[0].get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles.keys(), loc="lower center", ncols=4, frameon=False, fontsize=8.5,
                  bbox_to_anchor=(0.5, -0.004), columnspacing=2.2, handlelength=2.2)
    return figure


def publish(axes: Axes, published: list[list[Any]]) -> None:
    """Draws the published results of Gazebo's benchmark 'boxes'."""
    for i, (_, _, error, cost) in enumerate(published):
        axes.plot(cost, error, "x", color=style.INK, markersize=5.5, markeredgewidth=1.5, zorder=6,
                  label="published: ODE, Bullet, Simbody" if i == 0 else None)
    for text, place in (("1 ms", (60.0, 0.2)), ("0.1 ms", (550.0, 0.0011))):
        axes.text(*place, text, fontsize=7, color=GRAY, ha="center")


def effects(result: dict[str, Any]) -> Figure:
    """CPU time of each effect, and its influence on a flight."""
    figure = style.sheet("Cost and influence of each effect", "CPU time that an effect adds to a step, and the "
                         "distance between the ends of a reference flight with and without it. Effects that a scene "
                         "does not use cost nothing.")
    found = sorted(result["effects"].items(), key=lambda item: -item[1]["off_m"])
    rows = np.arange(len(found))[::-1]
    panels = ((0.16, "us", "CPU time per step, µs", "#7fa8d6", lambda v: f"{v:.2f} µs" if v >= 0.05 else "< 0.05 µs"),
              (0.60, "off_m", "change without it", "#efa22f", _distance))
    for left, key, title, color, describe in panels:
        axes = figure.add_axes((left, 0.12, 0.36, 0.6))
        values = np.array([cost[key] for _, cost in found])
        if key == "off_m":
            axes.set_xscale("log")
            values = np.maximum(values, 1e-4)
            axes.set_xlim(min(values) / 3, max(values) * 6)
        else:
            axes.set_xlim(0, max(values) * 1.25)
        axes.barh(rows, np.maximum(values, 0.0), height=0.62, color=color, zorder=3)
        for row, (_, cost), value in zip(rows, found, values, strict=True):
            axes.annotate(describe(cost[key]), (max(value, 0.0), row), xytext=(4, 0), textcoords="offset points",
                          va="center", fontsize=8.5, color=style.INK)
        axes.set_title(title, fontsize=10.5, loc="left", pad=6, fontweight="bold")
        axes.set_yticks(rows, [name.replace("_", " ") for name, _ in found] if key == "us" else [])
        tidy(axes)
        axes.grid(axis="y", visible=False)
        axes.tick_params(axis="y", length=0, labelsize=9.5, colors=style.INK)
    figure.axes[1].xaxis.set_major_formatter(lambda value, _: _named(value, "m"))
    return figure


def _distance(meters: float) -> str:
    return length(meters) if meters >= 1e-3 else "none" if meters == 0.0 else _named(meters, "m")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m figures.accuracy.motion", description=__doc__)
    parser.add_argument("--out", type=Path, default=OUT, help="folder with dynamics.json, and for the pictures")
    options = parser.parse_args()
    result = json.loads((options.out / "dynamics.json").read_text())
    for name, draw in (("dynamics", diagrams), ("dynamics_effects", effects)):
        style.save(draw(result), options.out / f"{name}.png")
        print(options.out / f"{name}.png")


if __name__ == "__main__":
    main()
