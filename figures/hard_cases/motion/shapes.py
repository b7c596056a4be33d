"""Sketches of the hard cases of motion, drawn on the left of each picture."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from drone_engine.arrays import Floats
from figures import style

LEFT = (-0.005, 0.03, 0.36, 0.74)
GROUND = "#c9d1da"
ARROW = style.MISSED


def panel_places(count: int) -> list[style.Place]:
    """Figure coordinates of one or two panels."""
    if count == 1:
        return [(0.435, 0.185, 0.545, 0.565)]
    return [(0.405, 0.185, 0.25, 0.565), (0.735, 0.185, 0.25, 0.565)]


def rotated(axis: int, angle: float) -> Floats:
    """Axes, one per row, of a box that is rotated about a world axis by an angle in rad."""
    c, s = math.cos(angle), math.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rows = np.eye(3)
    rows[i, i], rows[i, j], rows[j, i], rows[j, j] = c, s, -s, c
    return rows


def ground(axes: Any, half: float, z: float = 0.0) -> None:
    """Draws a square of floor."""
    corners = half * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) + [0, 0, z]
    style.draw_faces(axes, [corners], GROUND, 0.45, 0.6, 0)


def arrow(axes: Any, start: tuple[float, float, float], by: tuple[float, float, float], color: str = ARROW) -> None:
    """Draws an arrow from `start`."""
    axes.quiver(*start, *by, color=color, linewidth=1.6, arrow_length_ratio=0.28, zorder=8)


def tumble(figure: Figure) -> None:
    """A tumbling box on its path."""
    axes = style.space(figure, LEFT, (-4, -2, -3), (4, 14, 9), (12, -40), 1.5)
    for k, t in enumerate(np.linspace(0.0, 1.0, 4)):
        rows = rotated(1, 1.7 * t) @ rotated(0, 1.1 * t)
        middle = np.array([0.0, 1.0 + 11.0 * t, 3.0 + 13.0 * t - 13.5 * t * t])
        style.draw_box(axes, middle, rows, 0.5 * np.array([1.0, 4.0, 9.0]) * 0.62, style.FIRST, 0.15 + 0.12 * k)
    path = np.array([[0.0, 1.0 + 11.0 * t, 3.0 + 13.0 * t - 13.5 * t * t] for t in np.linspace(0, 1, 40)])
    style.draw_lines(axes, [path], style.SECOND, 1.6, 9)


def spin(figure: Figure) -> None:
    """A box and its rotation axis."""
    axes = style.space(figure, LEFT, (-3.2, -3.2, -4.5), (3.2, 3.2, 4.5), (16, -52), 1.35)
    style.draw_box(axes, np.zeros(3), rotated(1, 0.12), 0.5 * np.array([1.0, 4.0, 9.0]) * 0.72, style.FIRST, 0.3)
    t = np.linspace(-0.5, 4.7, 60)
    style.draw_lines(axes, [np.column_stack([2.5 * np.cos(t), np.full(60, -2.2), 2.5 * np.sin(t)])], ARROW, 1.8, 9)
    style.draw_lines(axes, [np.array([[0, -3.6, 0], [0, 3.6, 0]])], style.INK, 1.0, 9)
    arrow(axes, (0.0, 2.4, 0.0), (0.0, 1.6, 0.0), style.INK)


def stack(figure: Figure) -> None:
    """Ten boxes."""
    axes = style.space(figure, LEFT, (-2.6, -2.6, 0), (2.6, 2.6, 6.2), (12, -58), 1.45)
    ground(axes, 2.2)
    for i in range(10):
        style.draw_box(axes, np.array([0.0, 0.0, 0.6 * (i + 0.5)]), np.eye(3), np.full(3, 0.3),
                       style.SECOND if i == 9 else style.FIRST, 0.4, zorder=2 + i)


def mass_ratio(figure: Figure) -> None:
    """A heavy box on a light one."""
    axes = style.space(figure, LEFT, (-0.8, -0.8, 0), (0.8, 0.8, 1.5), (12, -58), 1.3)
    ground(axes, 0.8)
    style.draw_box(axes, np.array([0.0, 0.0, 0.3]), np.eye(3), np.full(3, 0.3), style.FIRST, 0.3)
    style.draw_box(axes, np.array([0.0, 0.0, 0.9]), np.eye(3), np.full(3, 0.3), style.SECOND, 0.6, zorder=3)
    style.draw_name(axes, np.array([0.0, 0.0, 0.9]), "1000 kg")
    style.draw_name(axes, np.array([0.0, 0.0, 0.3]), "1 kg")


def bounce(figure: Figure) -> None:
    """A bouncing box."""
    axes = style.space(figure, LEFT, (-1.1, -1.1, 0), (1.1, 1.1, 2.1), (12, -58), 1.3)
    ground(axes, 1.0)
    for height, alpha in ((1.3, 0.45), (0.8, 0.2), (0.3, 0.1)):
        style.draw_box(axes, np.array([0.0, 0.0, height]), np.eye(3), np.full(3, 0.3), style.FIRST, alpha)
    for sign, x in ((-1.0, -0.6), (1.0, 0.6)):
        arrow(axes, (x, 0.0, 1.0 - 0.45 * sign), (0.0, 0.0, 0.9 * sign))


def plate(figure: Figure) -> None:
    """Cubes shot at a plate."""
    axes = style.space(figure, LEFT, (-1.0, -1.0, -0.7), (1.0, 1.0, 1.1), (14, -58), 1.45)
    style.draw_box(axes, np.zeros(3), np.eye(3), np.array([1.0, 1.0, 0.012]), GROUND, 0.6, zorder=1)
    rng = np.random.default_rng(3)
    for place in ((-0.6, -0.2, 0.7), (0.1, 0.5, 0.9), (0.5, -0.5, 0.5)):
        start, end = np.array(place), np.array([0.45 * place[0], 0.4 * place[1], 0.02])
        style.draw_box(axes, start, rotated(int(rng.integers(3)), 0.6), np.full(3, 0.06), style.FIRST, 0.7, zorder=7)
        arrow(axes, place, tuple(0.85 * (end - start)))


def corner(figure: Figure) -> None:
    """A drone and two walls."""
    axes = style.space(figure, LEFT, (-1.2, -1.2, 0.2), (2.2, 2.2, 2.4), (34, -128), 1.3)
    style.draw_box(axes, np.array([2.1, 0.3, 1.2]), np.eye(3), np.array([0.1, 1.9, 1.0]), GROUND, 0.45, zorder=1)
    style.draw_box(axes, np.array([0.3, 2.1, 1.2]), np.eye(3), np.array([1.7, 0.1, 1.0]), GROUND, 0.45, zorder=1)
    for x, alpha in ((-0.6, 0.15), (0.6, 0.3), (1.74, 0.7)):
        style.draw_box(axes, np.array([x, x, 1.2]), np.eye(3), np.array([0.25, 0.25, 0.08]), style.FIRST, alpha,
                       zorder=4)
    arrow(axes, (-0.3, -0.3, 1.2), (1.2, 1.2, 0.0))


def inside(figure: Figure) -> None:
    """Two overlapping boxes."""
    axes = style.space(figure, LEFT, (-0.6, -0.6, -0.5), (0.9, 0.9, 0.7), (18, -58), 1.2)
    style.draw_box(axes, np.zeros(3), np.eye(3), np.full(3, 0.3), style.FIRST, 0.35)
    style.draw_box(axes, np.array([0.28, 0.2, 0.12]), rotated(2, 0.5), np.full(3, 0.3), style.SECOND, 0.35)
    arrow(axes, (-0.32, -0.2, 0.0), (-0.24, -0.14, -0.08))
    arrow(axes, (0.6, 0.42, 0.2), (0.24, 0.14, 0.08))


def slope(figure: Figure) -> None:
    """A crate on a slope."""
    axes = style.space(figure, LEFT, (-1.4, -0.9, -0.9), (1.4, 0.9, 0.9), (10, -76), 1.5)
    rows = rotated(1, math.atan(0.5))
    style.draw_box(axes, -0.06 * rows[2], rows, np.array([1.5, 0.8, 0.06]), GROUND, 0.5, zorder=1)
    style.draw_box(axes, 0.15 * rows[2] - 0.4 * rows[0], rows, np.array([0.3, 0.3, 0.15]), style.FIRST, 0.5, zorder=4)
    start = 0.15 * rows[2] + 0.0 * rows[0]
    arrow(axes, tuple(start), tuple(0.6 * rows[0]))
    arrow(axes, tuple(0.15 * rows[2] - 0.4 * rows[0]), (0.0, 0.0, -0.6), style.INK)


def island(figure: Figure) -> None:
    """The island with houses, crates and a drone."""
    axes = style.space(figure, LEFT, (-5, -5, 0), (6, 5, 4), (22, -64), 1.55)
    t = np.linspace(0, 2 * np.pi, 60)[:-1]
    style.draw_faces(axes, [np.column_stack([5.6 * np.cos(t), 4.6 * np.sin(t), np.zeros(59)])], "#c8b98f", 0.6, 0.5, 0)
    for x, y, size, height in ((-2.6, 2.6, 1.0, 1.6), (3.2, 2.2, 0.8, 1.2), (-3.4, -1.4, 0.7, 1.0)):
        style.draw_box(axes, np.array([x, y, height / 2]), rotated(2, 0.3 * x), np.array([size, size, height / 2]),
                       "#a5623f", 0.45, zorder=3)
    for x, y in ((0.6, -2.4), (1.3, -1.9), (2.4, -0.4)):
        style.draw_box(axes, np.array([x, y, 0.3]), rotated(2, x), np.full(3, 0.3), style.SECOND, 0.6, zorder=5)
    drone(axes, np.array([-0.4, -0.4, 2.2]), 0.55)


def drone(axes: Any, middle: Floats, size: float) -> None:
    """Draws a body, arms and rotors."""
    style.draw_box(axes, middle, np.eye(3), size * np.array([0.5, 0.35, 0.16]), style.FIRST, 0.8, zorder=7)
    t = np.linspace(0, 2 * np.pi, 24)
    for x, y in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        hub = middle + size * np.array([0.9 * x, 0.9 * y, 0.15])
        style.draw_lines(axes, [np.array([middle, hub])], style.INK, 1.4, 8)
        style.draw_lines(axes, [hub + size * np.column_stack([0.5 * np.cos(t), 0.5 * np.sin(t), 0 * t])], style.FIRST,
                         1.3, 8)


def heap(figure: Figure) -> None:
    """A heap of crates and a drone."""
    axes = style.space(figure, LEFT, (-3.2, -1.6, 0), (1.8, 1.6, 3.2), (14, -62), 1.45)
    ground(axes, 2.0)
    rng = np.random.default_rng(8)
    for i in range(11):
        middle = np.array([*rng.uniform(-0.8, 0.8, 2), 0.25 + 0.24 * i])
        style.draw_box(axes, middle, rotated(i % 3, float(rng.uniform(-1, 1))), rng.uniform(0.15, 0.32, 3),
                       style.SECOND, 0.35, zorder=2 + i)
    drone(axes, np.array([-2.4, -0.4, 1.2]), 0.45)
    arrow(axes, (-1.9, -0.3, 1.2), (0.9, 0.15, 0.0))


def clock(figure: Figure) -> None:
    """A clock with the stall marked."""
    axes = figure.add_axes((0.055, 0.13, 0.24, 0.24 * style.WIDTH / style.HEIGHT))
    axes.set_axis_off()
    axes.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), aspect="equal")
    t = np.linspace(0, 2 * np.pi, 100)
    axes.plot(np.cos(t), np.sin(t), color=style.INK, linewidth=2.0)
    for hour in range(12):
        a = hour * np.pi / 6
        axes.plot([0.86 * np.cos(a), 0.95 * np.cos(a)], [0.86 * np.sin(a), 0.95 * np.sin(a)], color=style.FAINT,
                  linewidth=1.6)
    stall = np.linspace(np.pi / 2, np.pi / 2 - 5 * np.pi / 6, 40)
    axes.fill(np.append(0.0, 0.8 * np.cos(stall)), np.append(0.0, 0.8 * np.sin(stall)), color=ARROW, alpha=0.18,
              linewidth=0)
    for angle, length, color in ((stall[0], 0.8, style.INK), (stall[-1], 0.8, ARROW)):
        axes.plot([0, length * np.cos(angle)], [0, length * np.sin(angle)], color=color, linewidth=2.6,
                  solid_capstyle="round")
    axes.text(0.42, 0.1, "5 s", color=ARROW, fontsize=13, fontweight="bold", ha="center", va="center")
