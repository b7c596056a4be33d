"""Draws a small picture of each effect, formula and simulation, for docs/effects.md: python -m figures.effects."""

import argparse
import math
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from drone_engine import load
from drone_engine.arrays import Floats
from drone_engine.effects import downwash, gusts, wind
from drone_engine.effects.ground_effect import CLOSEST, gain
from drone_engine.effects.noise import streams
from drone_engine.flight.quadrotor import SPEED
from drone_engine.world import World
from figures import DOCS, style
from figures.style import GRAY, GRID

OUT = DOCS / "effects"
SIZE, PLACE = (6.4, 3.0), (0.105, 0.17, 0.865, 0.68)
THIRD = "#7d5ba6"
G = 9.80665
CRATE = "crate: {model: crate, mass: 20, pose: [0, 0, 0]}"
DRONE = "drone: {model: drone, mass: 1.5, pose: [0, 0, 50], flight: {model: quadrotor}}"
PICTURES: dict[str, Callable[[Any], str]] = {}  # by function name; each draws into axes and returns the title


def picture(draw: Callable[[Any], str]) -> Callable[[Any], str]:
    """Registers a function that draws the picture of an effect; a trailing underscore of its name is dropped."""
    PICTURES[draw.__name__] = draw
    return draw


def world(effects: str, objects: str = CRATE, rate: int = 240) -> World:
    """A world with these effects and objects, given as YAML."""
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
        file.write(f"version: 1\nseed: 1\nrates: {{physics: {rate}}}\neffects: {{{effects}}}\nobjects:\n  {objects}\n")
        file.flush()
        return World(load(file.name))


def trajectory(run: World, seconds: float, measure: Callable[[World], Any], every: int = 1) -> tuple[Floats, Floats]:
    """Times, and measure(world) at these times, every `every` steps."""
    times, values = [run.time], [measure(run)]
    while run.time < seconds:
        run.run(every)
        times.append(run.time)
        values.append(measure(run))
    return np.array(times), np.array(values)


def velocity(axis: int) -> Callable[[World], float]:
    """A function that returns a component of the first body's velocity."""
    return lambda run: float(run.state.velocity_w[0, axis])


def line(axes: Any, x: Floats, y: Floats, color: str, name: str = "",
         position: tuple[float, float] = (0.0, 0.0)) -> None:
    """Draws a curve and its name, left-aligned at `position`."""
    axes.plot(x, y, color=color, linewidth=2.0, solid_capstyle="round")
    axes.text(*position, name, color=color, fontsize=9, fontweight="bold", va="center", zorder=5)


def dots(axes: Any, x: Floats, y: Floats, color: str) -> None:
    """Draws simulated values."""
    axes.plot(x, y, "o", markersize=4.5, markerfacecolor="white", markeredgecolor=color, markeredgewidth=1.3, zorder=4)


def labels(axes: Any, x_label: str, y_label: str) -> None:
    """Sets the axis labels."""
    axes.set_xlabel(x_label, fontsize=9, labelpad=2)
    axes.set_ylabel(y_label, fontsize=9, labelpad=3)


@picture
def wind_(axes: Any) -> str:
    """Wind speed over height, for each profile."""
    heights = np.linspace(0.0, 40.0, 300)
    for profile, color, position in (("uniform", style.FAINT, (7.2, 30.0)), ("power", style.FIRST, (8.55, 32.0)),
                                  ("log", style.SECOND, (9.95, 32.0))):
        p = wind.Parameters.model_validate({"profile": profile, "mean": (8.0, 0.0, 0.0)})
        line(axes, np.array([8.0 * p.factor(z) for z in heights]), heights, color, profile, position)
    axes.set(xlim=(4, 11), ylim=(0, 40))
    axes.axhline(10.0, color=GRID, linewidth=1.2, zorder=0)
    labels(axes, "wind, m/s", "height, m")
    return "8 m/s at 10 m, with three wind profiles"


@picture
def gusts_(axes: Any) -> str:
    """Gust velocities over time."""
    dt, n = 0.02, 1500
    awake, position, still = np.array([1, 0]), np.array([[0.0, 0.0, 10.0]]), np.zeros((1, 3))
    mean = np.array([[8.0, 0.0, 0.0]])
    memory, gust, step, samples = np.zeros((1, 5)), np.zeros((1, 3)), np.zeros(1, np.int64), []
    for k in range(2 * n):
        step[0] = k
        gusts.stir(awake, position, still, mean, streams(4, "gusts", ["drone"]), step, 7.7, 0.0, dt, memory, gust)
        samples.append(gust[0].copy())
    times, values = dt * np.arange(n), np.array(samples[n:])
    sigma, sigma_w = gusts.scales(10.0, 7.7)[2:]
    for c, color, name, shift in ((2, THIRD, "up", -5.0), (1, style.SECOND, "across", 0.0),
                                   (0, style.FIRST, "along\nthe wind", 5.0)):
        spread = sigma_w if c == 2 else sigma
        axes.axhspan(shift - spread, shift + spread, color=color, alpha=0.09, linewidth=0)
        axes.axhline(shift, color=GRID, linewidth=0.9, zorder=0)
        axes.plot(times, values[:, c] + shift, color=color, linewidth=1.3)
        axes.text(30.3, shift, name, color=color, fontsize=9, fontweight="bold", va="center")
    axes.set(xlim=(0, 30), ylim=(-8.5, 8.5), yticks=[-7, -5, -3, -2, 0, 2, 3, 5, 7],
             yticklabels=["−2", "0", "2", "−2", "0", "2", "−2", "0", "2"])
    axes.set_position((PLACE[0], PLACE[1], 0.74, PLACE[3]))
    labels(axes, "time, s", "gust, m/s")
    return "Hovering at 10 m in 15 knots; bands: one standard deviation"


@picture
def downwash_(axes: Any) -> str:
    """Air speed below a quadrotor."""
    x_values, z_values = np.linspace(-0.8, 0.8, 241), np.linspace(-0.25, 4.0, 400)
    thrust, rotors = 1.5 * G / 4, [(x, y) for x in (-0.19, 0.19) for y in (-0.19, 0.19)]

    def speed(x: float, z: float) -> float:
        """In the plane of two of the rotors."""
        return math.sqrt(sum(downwash.pressure(thrust, 1.225, 0.117, 0.094, z, (x - at) ** 2 + (0.19 - y) ** 2)
                             for at, y in rotors)) if z > 0.0 else 0.0

    air = np.array([[speed(x, z) for z in z_values] for x in x_values])
    colors = LinearSegmentedColormap.from_list("air", ["#ffffff", "#cfe0f2", style.FIRST, "#1d3f68"])
    extent = (z_values[0], z_values[-1], x_values[0], x_values[-1])
    shown = axes.imshow(air, extent=extent, origin="lower", aspect="auto",
                        cmap=colors, interpolation="bilinear")
    lines = axes.contour(z_values, x_values, air, levels=[1, 2, 4, 8], colors=style.INK, linewidths=0.6, alpha=0.7)
    axes.clabel(lines, fmt="%g", fontsize=8, manual=[(3.2, 0.6), (2.9, 0.42), (3.3, 0.18), (1.2, 0.2)])
    for side in (-0.19, 0.19):
        axes.plot([0, 0], [side - 0.117, side + 0.117], color=style.INK, linewidth=2.5, solid_capstyle="round")
    axes.set_position((PLACE[0], PLACE[1], 0.78, PLACE[3]))
    bar = axes.figure.colorbar(shown, cax=axes.figure.add_axes((0.90, PLACE[1], 0.017, PLACE[3])))
    bar.outline.set_visible(False)
    bar.ax.set_title("m/s", fontsize=8.5, color=GRAY)
    bar.ax.tick_params(length=2, labelsize=8.5, colors=GRAY)
    labels(axes, "below the rotors, m", "from their center, m")
    return "Air below a hovering quadrotor of 1.5 kg: four jets merge into one"


@picture
def gravity_(axes: Any) -> str:
    """Height of a falling crate."""
    t = np.linspace(0.0, 2.0, 100)
    line(axes, t, -0.5 * G * t**2, style.FIRST, "−g t² / 2", (1.2, -5.0))
    dots(axes, *trajectory(world("gravity: {}", rate=30), 1.99, lambda w: w.pose("crate")[2], 4), style.FIRST)
    labels(axes, "time, s", "height, m")
    return "Free fall for 2 s; dots: simulation"


@picture
def drag_(axes: Any) -> str:
    """Speed of falling crates."""
    t = np.linspace(0.0, 12.0, 200)
    for mass, color in ((20.0, style.FIRST), (5.0, style.SECOND)):
        run = world("gravity: {}, drag: {}", CRATE.replace("20", f"{mass:g}"), 30)
        half = run.model.bodies.half[0]
        final = math.sqrt(2 * mass * G / (1.225 * 4 * half[0] * half[1]))
        line(axes, t, final * np.tanh(G * t / final), color, f"{mass:g} kg", (9.3, final - 1.6))
        dots(axes, *trajectory(run, 12.0, lambda w: -w.state.velocity_w[0, 2], 18), color)
        axes.axhline(final, color=color, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.set(xlim=(0, 12), ylim=(0, None))
    labels(axes, "time, s", "speed of the fall, m/s")
    return "Falling crates: v = v∞ tanh(g t / v∞); dots: simulation"


@picture
def linear_drag_(axes: Any) -> str:
    """Decaying speed."""
    t = np.linspace(0.0, 6.0, 200)
    for axis, rate, color, name, position in ((0, 0.544, style.FIRST, "forwards, 0.544 /s", (0.15, 2.9)),
                                           (1, 0.386, style.SECOND, "sideways, 0.386 /s", (1.7, 6.3))):
        run = world("linear_drag: {bodies: all}", rate=60)
        run.state.velocity_w[0, axis] = 10.0
        line(axes, t, 10.0 * np.exp(-rate * t), color, name, position)
        dots(axes, *trajectory(run, 6.0, velocity(axis), 24), color)
    axes.set(xlim=(0, 6), ylim=(0, 10.4))
    labels(axes, "time, s", "speed, m/s")
    return "Decay from 10 m/s; dots: simulation"


@picture
def ground_effect_(axes: Any) -> str:
    """Thrust ratio over height."""
    heights = np.linspace(0.0, 3.0, 400)
    for speed, color, name, up in ((0.0, style.FIRST, "hovering", 1.32), (1.0, style.SECOND, "V = vᵢ", 1.16),
                                    (2.0, THIRD, "V = 2 vᵢ", 1.07)):
        ratio = np.array([1 + gain(1.0, z, speed, 1.0) for z in heights])
        line(axes, heights, ratio, color, name, (0.55 if speed == 0.0 else 0.04, up))
    axes.axvspan(0, CLOSEST, color="#eef1f5", zorder=0)
    axes.text(CLOSEST / 2, 1.24, "not\nmeasured", fontsize=8.5, color=GRAY, ha="center", va="center")
    axes.set(xlim=(0, 3), ylim=(1.0, 1.36))
    labels(axes, "height of the rotor, z / R", "thrust, T / T∞")
    return "A rotor near the ground, at constant power"


@picture
def water_(axes: Any) -> str:
    """Height of floating crates."""
    for density, color, position in ((150, style.FIRST, (2.3, 0.75)), (500, style.SECOND, (1.5, -0.95)),
                                 (900, THIRD, (4.2, -1.9))):
        run = world("gravity: {}, drag: {}, water: {density: 1000}", CRATE)
        volume = 8 * run.model.bodies.half[0].prod()
        run = world("gravity: {}, drag: {}, water: {density: 1000}",
                    f"crate: {{model: crate, mass: {density * volume}, pose: [0, 0, 1, 0.4, 0.2, 0]}}")
        t, z = trajectory(run, 12.0, lambda w: w.state.position_w[0, 2], 4)
        line(axes, t, z, color, f"{density} kg/m³", position)
    axes.axhline(0.0, color=style.FIRST, linewidth=0.8)
    axes.axhspan(-3.0, 0.0, color=style.FIRST, alpha=0.07, linewidth=0)
    axes.set(xlim=(0, 12), ylim=(-2.3, 1.6))
    labels(axes, "time, s", "height of the center, m")
    return "Crates of three densities, dropped into fresh water"


@picture
def motor_lag_(axes: Any) -> str:
    """Rotor rates after a command."""
    for effects, color, name, position in (
            ("gravity: {}", style.SECOND, "without", (0.115, 832.0)),
            ("gravity: {}, motor_lag: {up: 0.05, down: 0.1}", style.FIRST, "with 50 ms up and 100 ms down",
             (0.26, 810.0))):
        run = world(effects, DRONE, 500)
        rates = []
        for k in range(400):
            run.step({"drone": (0.0, 0.0, 2.0 if k > 50 else 0.0, 0.0)})
            rates.append(run.state.memory[SPEED][0, 0])
        line(axes, np.arange(400) / 500, np.array(rates), color, name, position)
    labels(axes, "time, s", "rate of a rotor, rad/s")
    return "A rotor of a quadrotor with a climb command at 0.1 s"


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m figures.effects",
                                     description="Draws a small picture of each effect.")
    parser.add_argument("--out", type=Path, default=OUT, help="folder for the pictures")
    parser.add_argument("names", nargs="*", metavar="EFFECT", help="all of them if none is named")
    options = parser.parse_args()
    for key, draw in PICTURES.items():
        name = key.removesuffix("_")
        if options.names and name not in options.names:
            continue
        figure = Figure(SIZE, dpi=style.DPI, facecolor="white")
        axes = figure.add_axes(PLACE)
        title = draw(axes)
        figure.text(0.02, 0.965, title, fontsize=11, fontweight="bold", va="top")
        if name != "downwash":
            axes.grid(color=GRID, linewidth=0.8, zorder=0)
        axes.set_axisbelow(True)
        axes.tick_params(length=2, labelsize=8.5, colors=GRAY)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        style.save(figure, options.out / f"{name}.png")
        print(options.out / f"{name}.png")


if __name__ == "__main__":
    main()
