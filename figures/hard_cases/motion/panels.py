"""Plots of the hard cases of motion: measured values over time for each setting, with their limits."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures import style
from figures.style import GRAY, GRID

COLORS = (style.FIRST, style.SECOND, "#7d5ba6", "#3d9970")
LINES: tuple[dict[str, Any], ...] = (
    {"color": COLORS[0], "linewidth": 2.4, "zorder": 5, "alpha": 0.85},
    {"color": COLORS[1], "linewidth": 1.5, "zorder": 6, "linestyle": (0, (5, 2.5))},
    {"color": COLORS[2], "linewidth": 1.5, "zorder": 7, "linestyle": (0, (1.5, 1.5))})
Run = dict[str, Any]
Panel = Callable[[Figure, style.Place, Sequence[Run]], None]
ORDERS = {1: "first order", 2: "second order", 4: "fourth order"}


def plot_axes(figure: Figure, place: style.Place, title: str, x_label: str, y_label: str = "") -> Axes:
    """Axes with title, labels and grid."""
    axes = figure.add_axes(place)
    axes.set_title(title, fontsize=10.5, loc="left", pad=6, fontweight="bold")
    axes.set_xlabel(x_label, fontsize=8.5, labelpad=2)
    axes.set_ylabel(y_label, fontsize=8.5, labelpad=2)
    axes.grid(color=GRID, linewidth=0.8, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(length=2, labelsize=8, colors=GRAY)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return axes


def limit(axes: Axes, value: float, text: str) -> None:
    """Draws a limit as a dashed line with its text."""
    axes.axhline(value, color=style.MISSED, linewidth=1.2, linestyle=(0, (5, 3)), zorder=4)
    axes.annotate(text, (1.0, value), xycoords=("axes fraction", "data"), xytext=(-2, 3), textcoords="offset points",
                  ha="right", va="bottom", fontsize=8, color=style.MISSED)


def legend(axes: Any, where: str) -> None:
    """Draws the legend of the axes."""
    axes.legend(loc=where, frameon=False, fontsize=8, handlelength=1.6, labelcolor=style.INK)


def over_time(figure: Figure, place: style.Place, runs: Sequence[Run], series: str, title: str, y_label: str,
              bound: float | None = None, text: str = "", log: bool = False, symmetric: bool = False,
              log_time: bool = False, scale: float = 1.0) -> None:
    """Values over time, one curve per setting.

    bound, text: a limit and its label, drawn on both sides of 0 if `symmetric`; log, log_time: logarithmic axes; scale:
    factor of the values.
    """
    axes = plot_axes(figure, place, title, "time, s", y_label)
    least = 1e-4 * (bound or 1.0)
    for i, run in enumerate(runs):
        values = scale * np.array(run["series"][series])
        t = np.array(run["series"]["time_s"])[: len(values)]
        if log:
            values = np.maximum(values, least)
        first = int(log_time)  # without time 0
        axes.plot(t[first:], values[first:], label=run["setting"], **LINES[i])
    if log:
        axes.set_yscale("log")
    if log_time:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    if bound is not None:
        limit(axes, bound, text)
        if symmetric:
            limit(axes, -bound, "")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (2.5 if log else 1.0) + (0.0 if log else 0.08 * (high - low)))


def convergence(figure: Figure, place: style.Place, runs: Sequence[Run], series: str, title: str, y_label: str) -> None:
    """Error over step size, both logarithmic, with the measured order."""
    axes = plot_axes(figure, place, title, "step, ms", y_label)
    axes.set(xscale="log", yscale="log")
    for i, run in enumerate(runs):
        step, error = 1000.0 * np.array(run["series"]["step_s"]), np.maximum(run["series"][series], 1e-15)
        scheme = run["setting"].split(",")[0]
        found = f", order {run['series']['order'][0]:.2f}" if series == "attitude_rad" else ""
        axes.plot(step, error, "o-", color=COLORS[i], linewidth=1.6, markersize=5, label=scheme + found)
    axes.minorticks_off()
    steps = sorted({1000.0 * step for run in runs for step in run["series"]["step_s"]})
    axes.set_xticks(steps, [f"{step:.2g}" for step in steps])
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.35)
    legend(axes, "upper left")


def shots(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Closest distance of some shots to the center of the plate, over their speed."""
    series = runs[0]["series"]
    speed, near = np.array(series["speed_m_s"]), 100.0 * np.array(series["nearest_m"])
    reached = runs[0]["reached"][0]
    title = f"{reached['value']:.0f} {reached['what']}"
    axes = plot_axes(figure, place, title, "speed, m/s", "closest to the plate's center, cm")
    axes.set_xscale("log")
    axes.axhspan(-0.5, 0.5, color="#c9d1da", zorder=1)
    behind = near < 0.0
    axes.plot(speed[~behind], np.minimum(near[~behind], 12.0), "o", markersize=3.5, color=style.FIRST, alpha=0.7,
              zorder=3)
    axes.plot(speed[behind], np.maximum(near[behind], -5.0), "X", markersize=7, color=style.MISSED, zorder=4)
    axes.set(xlim=(0.9, 1100.0), ylim=(-7, 12.5))
    axes.text(1050.0, -0.8, "the plate", fontsize=8, color=GRAY, ha="right", va="top")
    axes.text(1050.0, -6.6, "behind it", fontsize=8, color=style.MISSED, ha="right")
    axes.text(1050.0, 11.2, "12 cm or more", fontsize=8, color=style.FIRST, ha="right", va="top")


def slide(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Speed of the crate beside that of Coulomb friction."""
    axes = plot_axes(figure, place, "Speed", "time, s", "cm/s")
    t = np.array(runs[0]["series"]["time_s"])
    for i, run in enumerate(runs):
        axes.plot(t, 100.0 * np.array(run["series"]["speed_m_s"]), label=run["setting"], **LINES[i])
    expected = runs[0]["series"]["expected_m_s2"][0]
    axes.plot(t[::12], 100.0 * expected * t[::12], "o", color=style.MISSED, markersize=4, zorder=8,
              label="Coulomb: g (sin a - µ cos a) t")


def drifts(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Distance of each movable object from the place where it came to rest."""
    series = runs[0]["series"]
    most = max(one["value"] for one in runs[0]["reached"] if one["unit"] == "mm")
    axes = plot_axes(figure, place, f"Drift since the start of rest: at most {most:.1g} mm", "simulated time, h", "mm")
    for i, name in enumerate(name for name in series if name.endswith("_mm")):
        distance = np.maximum(np.array(series[name]), 1e-15)
        axes.plot(np.array(series["time_s"]) / 3600.0, distance, linewidth=1.5, color=colormaps["tab10"](i),
                  label=name.removesuffix("_mm").replace("_", " "))
    axes.set_yscale("log")
    axes.set_ylim(5e-16, 30.0)
    limit(axes, 1.0, "1 mm")


def both_runs(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Heights in both worlds, drawn over each other."""
    series = runs[0]["series"]
    t, first, second = np.array(series["time_s"]), np.array(series["first_m"]), np.array(series["second_m"])
    differ = sum(one["value"] for run in runs for one in run["reached"])
    axes = plot_axes(figure, place, f"{differ:.0f} states differ", "time, s", "heights of crates and drone, m")
    for i in range(first.shape[1]):
        once, again = ("first run", "second run") if i == 0 else (None, None)
        axes.plot(t, first[:, i], color=style.FIRST, linewidth=2.6, alpha=0.55, label=once)
        axes.plot(t[::2], second[::2, i], ".", color=style.SECOND, markersize=3.4, label=again)


def stalled_clock(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Simulated time and reported lag over the wall clock."""
    series = runs[0]["series"]
    axes = plot_axes(figure, place, "Simulated time continues without a jump", "wall clock, s", "s")
    axes.plot(series["wall_s"], series["wall_s"], color=GRAY, linewidth=1.0, linestyle=(0, (2, 2)), label="wall clock")
    for name, color, label in (("time_s", style.FIRST, "simulated time"), ("lag_s", style.MISSED, "lag reported")):
        axes.plot(series["wall_s"], series[name], color=color, linewidth=2.0, label=label, drawstyle="steps-post")


CORNER: tuple[Panel, ...] = (
    partial(over_time, series="depth_mm", title="Penetration", y_label="mm", bound=1.0, text="1 mm", log=True,
            log_time=True),
    partial(over_time, series="speed_cm_s", title="Speed", y_label="cm/s", bound=1.0, text="1 cm/s", log=True,
            log_time=True))
PANELS: dict[str, tuple[Panel, ...]] = {
    "tumble": (partial(convergence, series="attitude_rad", title="Attitude after 10 s", y_label="error, rad"),
               partial(convergence, series="position_m", title="Position after 10 s", y_label="error, m")),
    "spin": (partial(over_time, series="energy_percent", title="Energy", y_label="change, %", bound=0.1, text="0.1 %",
                     symmetric=True, log_time=True),
             partial(over_time, series="momentum_percent", title="Angular momentum", y_label="change, %", bound=0.1,
                     text="0.1 %", log=True, log_time=True)),
    "stack": (partial(over_time, series="moved_mm", title="Top box", y_label="motion, mm", bound=1.0, text="1 mm",
                      log_time=True),
              partial(over_time, series="energy_mJ", title="Total energy", y_label="above the start, mJ",
                      log_time=True)),
    "mass_ratio": (partial(over_time, series="depth_percent", title="Deepest penetration",
                           y_label="of the smaller box, %", bound=1.0, text="1 %", log=True, log_time=True),),
    "bounce": (partial(over_time, series="height_m", title="Height", y_label="m"),
               partial(over_time, series="energy_percent", title="Energy", y_label="change, %", bound=1.0, text="1 %",
                       symmetric=True)),
    "plate": (shots,),
    "corner": CORNER,
    "corner_quadrotor": CORNER,
    "inside": (partial(over_time, series="speed_m_s", title="Fastest of 48 crates", y_label="m/s", bound=1.0,
                       text="1 m/s"),),
    "sticks": (partial(over_time, series="path_m", title="Distance down the slope", y_label="mm", scale=1000.0,
                       bound=1.0, text="1 mm"),),
    "slides": (slide,),
    "island": (drifts,),
    "repeats": (both_runs,),
    "stall": (stalled_clock,),
}
