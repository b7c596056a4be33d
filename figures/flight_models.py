"""Draws the response of the flight models to a command: python -m figures.flight_models."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from drone_engine import load
from drone_engine.arrays import Floats
from drone_engine.flight.quadrotor import SPEED
from drone_engine.math.poses import rotate_all
from drone_engine.world import World
from figures import DOCS, style
from figures.style import tidy

OUT = DOCS / "images" / "flight_models.png"
RATE = 240  # Hz
WAIT, STOP, END = 0.25, 2.0, 4.5  # s: first command, last command, end of the picture
COMMANDED_SPEED = 4.0  # m/s
SCENE = """version: 1
rates: {{physics: {rate}}}
dynamics: {{substeps: 1}}
effects: {{gravity: {{}}{lag}}}
objects: {{drone: {{model: drone, pose: [0, 0, 1], mass: 1.4, flight: {{model: {model}}}}}}}
"""
MODELS = {"direct": ("direct", "", "#efa22f"), "quadrotor": ("quadrotor", ", motor_lag: {}", "#2f6db3"),
          "quadrotor without motor lag": ("quadrotor", "", "#d1495b")}


def fly(model: str, lag: str) -> tuple[Floats, Floats, Floats]:
    """Forward speed (n,), tilt (n,) in degrees and rates of the front and rear rotors (n, 2), a row per step."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "flight.yaml"
        path.write_text(SCENE.format(rate=RATE, model=model, lag=lag))
        world = World(load(path))
    samples = []
    for i in range(round(END * RATE)):
        world.step({"drone": (COMMANDED_SPEED, 0.0, 0.0, 0.0)} if WAIT <= i / RATE < STOP else {})
        up = rotate_all(world.state.orientation_w[0], np.array([0.0, 0.0, 1.0]))
        rotors = world.state.memory[SPEED][0] if SPEED in world.state.memory else np.zeros(4)
        samples.append((world.state.velocity_w[0, 0], np.degrees(np.arctan2(up[0], up[2])), rotors[0], rotors[1]))
    speed, tilt, *rates = np.array(samples).T
    return speed, tilt, np.stack(rates, axis=1)


def main() -> None:
    """Draws the picture."""
    figure = style.sheet("Response to a command", f"The flight models get the command {COMMANDED_SPEED:g} m/s forward "
                         f"until {STOP:g} s. Half a second later the command times out and they stop.")
    time = np.arange(round(END * RATE)) / RATE
    places = [(0.065, 0.13, 0.385, 0.6), (0.53, 0.53, 0.45, 0.2), (0.53, 0.13, 0.45, 0.225)]
    speeds, tilts, rotors = (figure.add_axes(place) for place in places)
    speeds.plot([0, WAIT, WAIT, STOP + 0.5, STOP + 0.5, END], np.array([0, 0, 1, 1, 0, 0]) * COMMANDED_SPEED,
                color="#b9c0c9", linewidth=1.3, linestyle=(0, (4, 2.5)))
    for name, (model, lag, color) in MODELS.items():
        speed, tilt, rates = fly(model, lag)
        dashes: Any = (0, (5, 2)) if name.endswith("lag") else "-"
        speeds.plot(time, speed, color=color, linewidth=1.9, linestyle=dashes, label=name)
        tilts.plot(time, tilt, color=color, linewidth=1.9, linestyle=dashes)
        if model == "quadrotor":
            for which in range(2):
                rotors.plot(time, rates[:, which], color=color, linewidth=1.5, linestyle=dashes,
                            alpha=1.0 if which else 0.55)
    for axes, title in ((speeds, "Forward speed, m/s"), (tilts, "Tilt forward, degrees"),
                        (rotors, "Rates of the rear (strong) and front (pale) rotors, rad/s")):
        axes.set_title(title, fontsize=10.5, loc="left", pad=6, fontweight="bold")
        axes.set_xlim(0, END)
        tidy(axes)
    rotors.set_xlim(WAIT - 0.05, WAIT + 0.85)
    for axes in (speeds, rotors):
        axes.set_xlabel("time, s", fontsize=9, labelpad=2)
    figure.legend(*speeds.get_legend_handles_labels(), loc="upper right", bbox_to_anchor=(0.985, 0.985), frameon=False,
                  fontsize=9.5, ncols=3)
    style.save(figure, OUT)
    print(OUT)


if __name__ == "__main__":
    main()
