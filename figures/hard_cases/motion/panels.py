"""The plots of the hard cases of motion: what was measured over time, for each setting, and the limit."""

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


def empty(figure: Figure, place: style.Place, title: str, across: str, up: str = "") -> Axes:
    axes = figure.add_axes(place)
    axes.set_title(title, fontsize=10.5, loc="left", pad=6, fontweight="bold")
    axes.set_xlabel(across, fontsize=8.5, labelpad=2)
    axes.set_ylabel(up, fontsize=8.5, labelpad=2)
    axes.grid(color=GRID, linewidth=0.8, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(length=2, labelsize=8, colors=GRAY)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return axes


def limit(axes: Axes, value: float, text: str) -> None:
    """A line that must not be crossed."""
    axes.axhline(value, color=style.MISSED, linewidth=1.2, linestyle=(0, (5, 3)), zorder=4)
    axes.annotate(text, (1.0, value), xycoords=("axes fraction", "data"), xytext=(-2, 3), textcoords="offset points",
                  ha="right", va="bottom", fontsize=8, color=style.MISSED)


def names(axes: Any, where: str) -> None:
    axes.legend(loc=where, frameon=False, fontsize=8, handlelength=1.6, labelcolor=style.INK)


def over_time(figure: Figure, place: style.Place, runs: Sequence[Run], series: str, title: str, up: str,
              bound: float | None = None, text: str = "", log: bool = False, both: bool = False, late: bool = True,
              scale: float = 1.0) -> None:
    """One line for each setting. bound: on both sides if `both`; log: of the values; late: time is linear, else not;
    scale: of the values, to the unit that is shown."""
    axes = empty(figure, place, title, "time, s", up)
    least = 1e-4 * (bound or 1.0)
    for i, run in enumerate(runs):
        values = scale * np.array(run["series"][series])
        t = np.array(run["series"]["time_s"])[: len(values)]
        axes.plot(t[not late :], (np.maximum(values, least) if log else values)[not late :], label=run["setting"],
                  **LINES[i])
    if log:
        axes.set_yscale("log")
    if not late:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    if bound is not None:
        limit(axes, bound, text)
        if both:
            limit(axes, -bound, "")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (2.5 if log else 1.0) + (0.0 if log else 0.08 * (high - low)))


def convergence(figure: Figure, place: style.Place, runs: Sequence[Run], series: str, title: str, up: str) -> None:
    """Error over step, both logarithmic, with the order that was found."""
    axes = empty(figure, place, title, "step, ms", up)
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
    axes.plot(speed[behind], np.maximum(near[behind], -5.0), "X", markersize=7, color=style.MISSED, zorder=4)
    axes.set(xlim=(0.9, 1100.0), ylim=(-7, 12.5))
    axes.text(1050.0, -0.8, "the plate", fontsize=8, color=GRAY, ha="right", va="top")
    axes.text(1050.0, -6.6, "behind it", fontsize=8, color=style.MISSED, ha="right")
    axes.text(1050.0, 11.2, "12 cm or more", fontsize=8, color=style.FIRST, ha="right", va="top")


def slide(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Speed beside Coulomb's."""
    axes = empty(figure, place, "Speed", "time, s", "cm/s")
    t = np.array(runs[0]["series"]["time_s"])
    for i, run in enumerate(runs):
        axes.plot(t, 100.0 * np.array(run["series"]["speed_m_s"]), label=run["setting"], **LINES[i])
    expected = runs[0]["series"]["expected_m_s2"][0]
    axes.plot(t[::12], 100.0 * expected * t[::12], "o", color=style.MISSED, markersize=4, zorder=8,
              label="Coulomb: g (sin a - µ cos a) t")


def drifts(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """How far each thing that can move is from where it came to rest."""
    series = runs[0]["series"]
    most = max(one["value"] for one in runs[0]["reached"] if one["unit"] == "mm")
    axes = empty(figure, place, f"Moved since it came to rest: {most:.1g} mm at most", "simulated time, h", "mm")
    for i, name in enumerate(name for name in series if name.endswith("_mm")):
        away = np.maximum(np.array(series[name]), 1e-15)
        axes.plot(np.array(series["time_s"]) / 3600.0, away, linewidth=1.5, color=colormaps["tab10"](i),
                  label=name.removesuffix("_mm").replace("_", " "))
    axes.set_yscale("log")
    axes.set_ylim(5e-16, 30.0)
    limit(axes, 1.0, "1 mm")


def twice(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Heights in both worlds, one over the other."""
    series = runs[0]["series"]
    t, first, second = np.array(series["time_s"]), np.array(series["first_m"]), np.array(series["second_m"])
    differ = sum(one["value"] for run in runs for one in run["reached"])
    axes = empty(figure, place, f"{differ:.0f} states differ", "time, s", "heights of crates and of the drone, m")
    for i in range(first.shape[1]):
        once, again = ("once", "again") if i == 0 else (None, None)
        axes.plot(t, first[:, i], color=style.FIRST, linewidth=2.6, alpha=0.55, label=once)
        axes.plot(t[::2], second[::2, i], ".", color=style.SECOND, markersize=3.4, label=again)


def late(figure: Figure, place: style.Place, runs: Sequence[Run]) -> None:
    """Simulated time and the lag that is reported, over the wall clock."""
    series = runs[0]["series"]
    axes = empty(figure, place, "Simulated time goes on where it was", "wall clock, s", "s")
    axes.plot(series["wall_s"], series["wall_s"], color=GRAY, linewidth=1.0, linestyle=(0, (2, 2)), label="wall clock")
    for name, color, label in (("time_s", style.FIRST, "simulated time"), ("lag_s", style.MISSED, "lag reported")):
        axes.plot(series["wall_s"], series[name], color=color, linewidth=2.0, label=label, drawstyle="steps-post")


CORNER: tuple[Panel, ...] = (
    partial(over_time, series="depth_mm", title="Penetration", up="mm", bound=1.0, text="1 mm", log=True, late=False),
    partial(over_time, series="speed_cm_s", title="Speed", up="cm/s", bound=1.0, text="1 cm/s", log=True, late=False))
PANELS: dict[str, tuple[Panel, ...]] = {
    "tumble": (partial(convergence, series="attitude_rad", title="Attitude after 10 s", up="error, rad"),
               partial(convergence, series="position_m", title="Position after 10 s", up="error, m")),
    "spin": (partial(over_time, series="energy_percent", title="Energy", up="change, %", bound=0.1, text="0.1 %",
                     both=True, late=False),
             partial(over_time, series="momentum_percent", title="Angular momentum", up="change, %", bound=0.1,
                     text="0.1 %", log=True, late=False)),
    "stack": (partial(over_time, series="moved_mm", title="The top box", up="moved, mm", bound=1.0, text="1 mm",
                      late=False),
              partial(over_time, series="energy_mJ", title="Total energy", up="over the start, mJ", late=False)),
    "mass_ratio": (partial(over_time, series="depth_percent", title="Deepest penetration", up="of the smaller box, %",
                           bound=1.0, text="1 %", log=True, late=False),),
    "bounce": (partial(over_time, series="height_m", title="Height", up="m"),
               partial(over_time, series="energy_percent", title="Energy", up="change, %", bound=1.0, text="1 %",
                       both=True)),
    "plate": (shots,),
    "corner": CORNER,
    "corner_quadrotor": CORNER,
    "inside": (partial(over_time, series="speed_m_s", title="The fastest of 48 crates", up="m/s", bound=1.0,
                       text="1 m/s"),),
    "sticks": (partial(over_time, series="path_m", title="The way down", up="mm", scale=1000.0, bound=1.0,
                       text="1 mm"),),
    "slides": (slide,),
    "island": (drifts,),
    "repeats": (twice,),
    "stall": (late,),
}
