"""The plots of the hard cases of motion: what was measured over time, for each setting, and the limit."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import style
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

GRID, GREY = "#e6e9ed", "#5b6570"
COLOURS = (style.FIRST, style.SECOND, "#7d5ba6", "#3d9970")
Run = dict[str, Any]
Panel = Callable[[Figure, style.Place, Sequence[Run]], None]
ORDERS = {1: "first order", 2: "second order", 4: "fourth order"}


def empty(figure: Figure, place: style.Place, title: str, across: str, up: str = "") -> Axes:
    axes = figure.add_axes(place)
    axes.set_title(title, fontsize=10.5, loc="left", pad=6, fontweight="bold")
    axes.set_xlabel(across, fontsize=8.5, labelpad=2)
    axes.set_ylabel(up, fontsize=8.5, labelpad=2)
    axes.grid(color=GRID, linewidth=0.8, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(length=2, labelsize=8, colors=GREY)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return axes


def limit(axes: Axes, value: float, text: str) -> None:
    """A line that must not be crossed."""
    axes.axhline(value, color=style.MISSED, linewidth=1.2, linestyle=(0, (5, 3)), zorder=4)
    axes.annotate(text, (1.0, value), xycoords=("axes fraction", "data"), xytext=(-2, 3), textcoords="offset points",
                  ha="right", va="bottom", fontsize=8, color=style.MISSED)


def names(axes: Any, where: str = "best") -> None:
    """Which line is which setting, if there are several."""
    if len(axes.get_legend_handles_labels()[0]) > 1:
        axes.legend(loc=where, frameon=False, fontsize=8, handlelength=1.6, labelcolor=style.INK)


def over_time(figure: Figure, place: style.Place, runs: Sequence[Run], series: str, title: str, up: str,
              bound: float | None = None, text: str = "", log: bool = False, both: bool = False) -> None:
    """One line for each setting; bound: on both sides if `both`."""
    axes = empty(figure, place, title, "time, s", up)
    least = 1e-4 * (bound or 1.0)
    for i, run in enumerate(runs):
        t, values = run["series"]["time_s"], np.array(run["series"][series])
        axes.plot(t[: len(values)], np.maximum(values, least) if log else values, color=COLOURS[i], linewidth=1.6,
                  label=run["setting"], zorder=5 - i, linestyle=("-", (0, (4, 2)))[i % 2])
    if log:
        axes.set_yscale("log")
    if bound is not None:
        limit(axes, bound, text)
        if both:
            limit(axes, -bound, "")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (2.5 if log else 1.0) + (0.0 if log else 0.12 * (high - low)))
    names(axes)


def convergence(figure: Figure, place: style.Place, runs: Sequence[Run], series: str, title: str, up: str) -> None:
    """Error over step, both logarithmic, with the order that was found."""
    axes = empty(figure, place, title, "step, ms", up)
    axes.set(xscale="log", yscale="log")
    for i, run in enumerate(runs):
        step, error = 1000.0 * np.array(run["series"]["step_s"]), np.maximum(run["series"][series], 1e-15)
        scheme = run["setting"].split(",")[0]
        found = f", order {run['series']['order'][0]:.2f}" if series == "attitude_rad" else ""
        axes.plot(step, error, "o-", color=COLOURS[i], linewidth=1.6, markersize=5, label=scheme + found)
    axes.minorticks_off()
    steps = sorted({1000.0 * step for run in runs for step in run["series"]["step_s"]})
    axes.set_xticks(steps, [f"{step:.2g}" for step in steps])
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.35)
    names(axes, "upper left")


def shots(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """How near each of some shots came to the middle of the plate."""
    series = runs[0]["series"]
    speed, near = np.array(series["speed_m_s"]), 100.0 * np.array(series["nearest_m"])
    reached = runs[0]["reached"][0]
    title = f"{reached['value']:.0f} {reached['what']}"
    axes = empty(figure, place, title, "speed, m/s", "nearest to the plate's middle, cm")
    axes.set_xscale("log")
    axes.axhspan(-0.5, 0.5, color="#c9d1da", zorder=1)
    behind = near < 0.0
    axes.plot(speed[~behind], np.minimum(near[~behind], 12.0), "o", markersize=3.5, color=style.FIRST, alpha=0.7,
              zorder=3)
    axes.plot(speed[behind], np.maximum(near[behind], -6.0), "X", markersize=7, color=style.MISSED, zorder=4)
    axes.set_ylim(-7, 12.5)
    axes.text(1000.0, -0.9, "the plate", fontsize=8, color=GREY, ha="right", va="top")
    axes.text(1000.0, -6.5, "behind it", fontsize=8, color=style.MISSED, ha="right")


def slide(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Speed beside Coulomb's."""
    axes = empty(figure, place, "It slides as Coulomb says", "time, s", "speed, cm/s")
    for i, run in enumerate(runs):
        t = np.array(run["series"]["time_s"])
        axes.plot(t, 100.0 * np.array(run["series"]["speed_m_s"]), color=COLOURS[i], linewidth=3.0 - 1.6 * i,
                  label=run["setting"])
    expected = runs[0]["series"]["expected_m_s2"][0]
    axes.plot(t, 100.0 * expected * t, color=style.MISSED, linewidth=1.2, linestyle=(0, (5, 3)), zorder=6,
              label="g (sin a - mu cos a) t")
    names(axes)


def drifts(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """How far each thing that can move is from where it came to rest."""
    axes = empty(figure, place, "Everything that can move", "simulated time, h", "moved since it came to rest, mm")
    series = runs[0]["series"]
    for i, name in enumerate(name for name in series if name.endswith("_mm")):
        away = np.maximum(np.array(series[name]), 1e-12)
        axes.plot(np.array(series["time_s"]) / 3600.0, away, linewidth=1.5, color=colormaps["tab10"](i),
                  label=name.removesuffix("_mm").replace("_", " "))
    axes.set_yscale("log")
    axes.set_ylim(5e-13, 30.0)
    limit(axes, 1.0, "1 mm")
    axes.legend(loc="center right", frameon=False, fontsize=8, ncols=2)


def twice(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Heights in both worlds, one over the other."""
    series = runs[0]["series"]
    t, first, second = np.array(series["time_s"]), np.array(series["first_m"]), np.array(series["second_m"])
    differ = sum(one["value"] for run in runs for one in run["reached"])
    axes = empty(figure, place, f"{differ:.0f} states differ", "time, s", "heights of 24 crates and the drone, m")
    axes.plot(t, first, color=style.FIRST, linewidth=2.2, alpha=0.55)
    axes.plot(t[::6], second[::6], ".", color=style.SECOND, markersize=3.2)
    axes.plot([], [], color=style.FIRST, linewidth=2.2, label="once")
    axes.plot([], [], ".", color=style.SECOND, label="again")
    names(axes, "upper right")


def late(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Simulated time and the lag that is reported, over the wall clock."""
    series = runs[0]["series"]
    axes = empty(figure, place, "Simulated time goes on where it was", "wall clock, s", "s")
    axes.plot(series["wall_s"], series["wall_s"], color=GREY, linewidth=1.0, linestyle=(0, (2, 2)), label="wall clock")
    axes.plot(series["wall_s"], series["time_s"], color=style.FIRST, linewidth=2.0, label="simulated time")
    axes.plot(series["wall_s"], series["lag_s"], color=style.MISSED, linewidth=1.6, label="lag reported")
    names(axes, "upper left")


PANELS: dict[str, tuple[Panel, ...]] = {
    "tumble": (partial(convergence, series="attitude_rad", title="Attitude after 10 s", up="error, rad"),
               partial(convergence, series="position_m", title="Position after 10 s", up="error, m")),
    "spin": (partial(over_time, series="energy_percent", title="Energy", up="change, %", bound=0.1, text="0.1 %",
                     both=True),
             partial(over_time, series="momentum_percent", title="Angular momentum", up="change, %", bound=0.1,
                     text="0.1 %", log=True)),
    "stack": (partial(over_time, series="moved_mm", title="The top box", up="moved, mm", bound=1.0, text="1 mm"),
              partial(over_time, series="energy_mJ", title="Total energy", up="over the start, mJ")),
    "mass_ratio": (partial(over_time, series="depth_percent", title="Deepest penetration", up="of the smaller box, %",
                           bound=1.0, text="1 %", log=True),),
    "bounce": (partial(over_time, series="height_m", title="Height", up="m"),
               partial(over_time, series="energy_percent", title="Energy", up="change, %", bound=1.0, text="1 %",
                       both=True)),
    "plate": (shots,),
    "corner": (partial(over_time, series="depth_mm", title="Penetration", up="mm", bound=1.0, text="1 mm", log=True),
               partial(over_time, series="speed_cm_s", title="Speed", up="cm/s", bound=1.0, text="1 cm/s", log=True)),
    "inside": (partial(over_time, series="speed_m_s", title="The fastest of 48 crates", up="m/s", bound=1.0,
                       text="1 m/s"),),
    "sticks": (partial(over_time, series="path_m", title="The way down", up="m", bound=0.001, text="1 mm"),),
    "slides": (slide,),
    "island": (drifts,),
    "repeats": (twice,),
    "stall": (late,),
}
