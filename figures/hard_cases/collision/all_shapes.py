"""Pictures of properties of all shapes: nested levels, answers independent of the order, and the broad phase."""

import itertools
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box import obb
from drone_engine.collision.broad_phase import grid
from drone_engine.collision.mesh import octree
from drone_engine.collision.triangle import intersection as triangle
from figures import style
from figures.hard_cases.collision.boxes import (
    REACH,
    X_STEPS,
    Y_STEPS,
    Box,
    brought_to_touch,
    grids,
    moved_grid,
    name_both,
    rotation_rows,
    rows,
)
from reference import textbook

LEVELS = ("sphere", "obb", "octree", "triangle")
PROBES = np.array([[1.38, 0.0, 0.62], [0.1, 0.0, -0.08], [-0.62, 0.0, 0.52], [-0.51, 0.0, -0.51]])
PROBE = 0.1  # m, half extent of a probe


def torus(around: int = 32, sides: int = 10, radius: float = 1.0, thickness: float = 0.2) -> tuple[Floats, Integers]:
    """Vertices and faces of a ring about y."""
    u, v = np.meshgrid(np.arange(around), np.arange(sides), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / sides
    reach = radius + thickness * np.cos(b)
    vertices = np.stack([reach * np.cos(a), thickness * np.sin(b), reach * np.sin(a)], axis=-1).reshape(-1, 3)

    def number(i: Integers, j: Integers) -> Integers:
        return np.asarray(i % around * sides + j % sides)

    p, q, r, s = number(u, v), number(u + 1, v), number(u + 1, v + 1), number(u, v + 1)
    return vertices, np.concatenate([np.stack([p, q, r], -1), np.stack([p, r, s], -1)]).reshape(-1, 3)


def octahedron(center: Floats) -> Floats:
    """Triangles (8, 3, 3) of a probe at the center (3,)."""
    tips = PROBE * np.eye(3)
    signs = itertools.product((1, -1), repeat=3)
    return np.array([[center + x * tips[0], center + y * tips[1], center + z * tips[2]] for x, y, z in signs])


def hits(corners: Floats, leaves: Floats, probe: Floats) -> dict[str, bool]:
    """Answers of each level for a ring (triangles `corners`, octree leaves (k, 6)) and a probe at (3,)."""
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    reach = np.linalg.norm(high - low) / 2 + np.sqrt(3) * PROBE
    eight = octahedron(probe)
    return {
        "sphere": bool(np.linalg.norm(probe - (low + high) / 2) <= reach),
        "obb": bool((np.abs(probe - (low + high) / 2) <= (high - low) / 2 + PROBE).all()),
        "octree": bool((np.abs(probe - leaves[:, :3]) <= leaves[:, 3:] + PROBE).all(axis=1).any()),
        "triangle": bool(triangle.intersects(corners.repeat(8, axis=0), np.tile(eight, (len(corners), 1, 1))).any()),
    }


def levels_nested() -> Figure:
    """A ring at the four levels and four probes."""
    vertices, faces = torus()
    tree = octree.build(vertices, faces)
    leaves = tree.box[tree.link[:, 1] == 0]
    corners = vertices[faces]
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    found = [hits(corners, leaves, probe) for probe in PROBES]
    figure = style.sheet(
        "Levels are nested",
        "A ring at the four levels, and four small bodies. Each level refines the one before: a hit at a fine level "
        "is also a hit at all coarser ones. So a miss at any level is final, and a coarser level never misses a hit "
        "of a finer one.")
    for i, level in enumerate(LEVELS):
        left = 0.005 + 0.248 * i
        axes = style.space(figure, (left, 0.12, 0.245, 0.66), (-1.5, -0.5, -1.5), (1.5, 0.5, 1.5), (10, -72), 1.26)
        faint = 0.5 if level == "triangle" else 0.05
        style.draw_faces(axes, list(corners), style.FIRST, faint, 0.4 if level == "triangle" else 0.12)
        if level == "sphere":
            draw_ball(axes, (low + high) / 2, float(np.linalg.norm(high - low) / 2))
        elif level == "obb":
            style.draw_box(axes, (low + high) / 2, np.eye(3), (high - low) / 2, style.FIRST, 0.22)
        elif level == "octree":
            for leaf in leaves:
                style.draw_box(axes, leaf[:3], np.eye(3), leaf[3:], style.FIRST, 0.06, width=0.3)
        for probe, answer in zip(PROBES, found, strict=True):
            color = style.MISSED if answer[level] else style.FAINT
            style.draw_faces(axes, list(octahedron(probe)), color, 0.9, 0.4, zorder=6)
        count = sum(answer[level] for answer in found)
        style.label(figure, left + 0.122, 0.10, level, fontsize=12, fontweight="bold")
        style.label(figure, left + 0.122, 0.045, f"{count} of {len(PROBES)} hit", color=style.MISSED)
    return figure


def draw_ball(axes: Any, center: Floats, radius: float) -> None:
    """Draws a sphere as circles of latitude and longitude."""
    t = np.linspace(0, 2 * np.pi, 61)
    level = [center + radius * np.column_stack([np.cos(a) * np.cos(t), np.cos(a) * np.sin(t), np.full(61, np.sin(a))])
             for a in np.linspace(-1.25, 1.25, 7)]
    upright = [center + radius * np.column_stack([np.cos(a) * np.cos(t), np.sin(a) * np.cos(t), np.sin(t)])
               for a in np.linspace(0, np.pi, 9)[:-1]]
    style.draw_lines(axes, [*level, *upright], style.FIRST, 0.6)


def symmetry() -> Figure:
    """Map of pairs whose answer changes if A and B are swapped."""
    a = Box(np.array([0.1, 0.15, 0.1]), rotation_rows(0.4, -0.3, 0.5), np.array([0.5, 0.35, 0.3]))
    b = Box(np.array([0.75, 0.7, 0.62]), rotation_rows(-0.5, 0.6, 0.2), np.array([0.35, 0.45, 0.25]))
    b = brought_to_touch(a, b)
    figure = style.sheet(
        "A against B, B against A",
        "Swapping the two must give the same answer and the opposite normal; otherwise the result of a flight depends "
        "on the order of the objects. A test in the frame of one of the boxes rounds differently in each order.")
    space = style.space(figure, style.SHAPES, (-0.6, -0.6, -0.5), (1.3, 1.2, 1.1))
    style.draw_box(space, *a, style.FIRST)
    style.draw_box(space, *b, style.SECOND)
    name_both(space, a, b)
    n = (2 * REACH + 1) ** 2
    second = moved_grid(b, *grids(), 0, 1)
    pairs = [np.broadcast_to(part, (n, *part.shape[1:])) for part in (*rows(a), *second)]
    meanings = {style.HIT: "hit in both orders", style.APART: "no hit in both orders", style.INVENTED: "answers differ"}
    for place, answer, name in ((style.FIRST_MAP, textbook.boxes, "float64"),
                                (style.SECOND_MAP, obb.intersects, "exact")):
        one, other = (answer(*map(np.ascontiguousarray, order)) for order in (pairs, pairs[3:] + pairs[:3]))
        kinds = np.where(one != other, 2, np.where(one, 0, 1)).reshape(2 * REACH + 1, -1)
        differ = int((kinds == 2).sum())
        style.draw_map(figure, place, kinds, list(meanings), f"{name}: {differ:,} of {n:,} differ", X_STEPS,
                       Y_STEPS if name == "float64" else "", differ > 0)
    style.legend(figure, meanings)
    return figure


BODIES = np.array([  # x, y of the lower left corner, width, height, in cells
    [-3.4, 0.25, 5.0, 0.5], [1.35, 0.55, 0.5, 0.9], [-3.2, -0.5, 0.5, 1.0], [-1.3, -2.1, 0.9, 0.8],
    [-0.6, -1.6, 1.3, 0.5], [1.65, -1.7, 0.5, 1.5], [1.9, -0.5, 0.7, 0.6], [-2.7, -2.4, 0.5, 0.5],
    [-1.6, 1.4, 0.6, 1.1], [-1.2, 2.2, 1.3, 0.4], [0.9, 2.0, 0.5, 0.5], [-3.3, 1.5, 0.7, 0.7]])


def broad_phase() -> Figure:
    """Pairs found by the grid, and by a grid that stores bodies by their centers only."""
    figure = style.sheet(
        "Broad phase: bodies over many cells, 1 mm beside 1 km",
        "The grid has to find each pair of overlapping bounds once, on either side of the origin and for all sizes. "
        "If a long body is stored only in the cell of its center, pairs at its ends are missed, even if neighboring "
        "cells are searched.")
    low, high = BODIES[:, :2], BODIES[:, :2] + BODIES[:, 2:]
    true = [(i, j) for i, j in itertools.combinations(range(len(BODIES)), 2)
            if (low[i] <= high[j]).all() and (low[j] <= high[i]).all()]
    cell = np.floor((low + high) / 2)
    near = np.array([(np.abs(cell[i] - cell[j]) <= 1).all() for i, j in true])
    ours = pairs_of_grid(np.pad(low, ((0, 0), (0, 1))), np.pad(high, ((0, 0), (0, 1)), constant_values=1.0))
    here = np.array([pair in ours for pair in true])
    panels = ((0.025, near, "stored by its center"), (0.345, here, "stored in each overlapped cell"))
    for left, found, title in panels:
        missed = int((~found).sum())
        axes = figure.add_axes((left, 0.035, 0.30, 0.645))
        note = f"{missed} of {len(true)} pairs missed" if missed else f"all {len(true)} pairs found"
        axes.set_title(f"{title}:\n{note}", fontsize=10, loc="left", fontweight="bold", pad=6,
                       color=style.MISSED if missed else style.INK)
        draw_plane(axes, true, found, cell if missed else None)
    draw_sizes(figure.add_axes((0.665, 0.035, 0.325, 0.645)))
    return figure


def pairs_of_grid(low: Floats, high: Floats) -> set[tuple[int, int]]:
    """Pairs that the broad phase finds for movable boxes with bounds low and high, (n, 3)."""
    every = np.ones(len(low), bool)
    a, b = grid.Grid((high - low) / 2).pairs(low, high, every, every)
    return set(zip(a.tolist(), b.tolist(), strict=True))


def draw_plane(axes: Axes, pairs: list[tuple[int, int]], found: Booleans, centers: Floats | None) -> None:
    """Draws the bodies from above, the cells of the long one, and marks at the pairs."""
    axes.set(xlim=(-4, 3), ylim=(-3, 3), aspect="equal", xticks=range(-4, 4), yticks=range(-3, 4),
             anchor="N")
    axes.grid(color=style.APART, linewidth=1.2)
    axes.set_axisbelow(True)
    axes.tick_params(length=0, labelsize=7.5)
    first, last = np.floor(BODIES[0, :2]), np.floor(BODIES[0, :2] + BODIES[0, 2:])
    columns = np.arange(first[0], last[0] + 1) if centers is None else centers[:1, 0]
    for x in columns:
        axes.add_patch(Rectangle((x, first[1]), 1, 1, facecolor=style.SECOND, alpha=0.25, zorder=0))
    for i, (x, y, width, height) in enumerate(BODIES):
        color = style.SECOND if i == 0 else style.FIRST
        axes.add_patch(Rectangle((x, y), width, height, facecolor=color, alpha=0.55, zorder=2))
        axes.add_patch(Rectangle((x, y), width, height, fill=False, edgecolor=color, linewidth=1.2, zorder=3))
    middle = BODIES[:, :2] + BODIES[:, 2:] / 2
    for (i, j), seen in zip(pairs, found, strict=True):
        both = np.maximum(BODIES[i, :2], BODIES[j, :2]), np.minimum(*((BODIES[k, :2] + BODIES[k, 2:]) for k in (i, j)))
        x, y = (both[0] + both[1]) / 2
        axes.plot(x, y, "o" if seen else "X", color=style.INK if seen else style.MISSED, markersize=5 if seen else 9,
                  zorder=5)
    axes.plot(*middle.T, "+", color="white", markersize=5, zorder=4)


def draw_sizes(axes: Axes) -> None:
    """Draws a body of a millimeter at the wall of a hall of a kilometer, in three magnifications."""
    axes.set(xlim=(0, 3), ylim=(-0.45, 2.1), aspect="equal")
    axes.set_axis_off()
    axes.set_anchor("N")
    small, large = np.array([[500.0, 0.0, 0.0], [500.001, 0.001, 0.001]]), np.array([[-500.0] * 3, [500.0] * 3])
    found = pairs_of_grid(*np.stack([large, small], axis=1)) == {(0, 1)}
    axes.set_title(f"1 mm beside 1 km:\nthe pair is {'found' if found else 'missed'}", fontsize=10, loc="left",
                   fontweight="bold", pad=6)
    for i, (name, wall) in enumerate((("1 km", 0.9), ("1 m", 0.45), ("1 mm", 0.45))):
        x = 0.05 + 1.0 * i
        axes.add_patch(Rectangle((x, 0.75), 0.88, 0.88, fill=False, edgecolor=style.FAINT, linewidth=0.8))
        for line in np.linspace(0.11, 0.77, 4):
            axes.plot([x, x + 0.88], [0.75 + line] * 2, "-", color=style.APART, linewidth=1, zorder=0)
            axes.plot([x + line] * 2, [0.75, 1.63], "-", color=style.APART, linewidth=1, zorder=0)
        tall, right = 0.88 * (0.9 if i == 0 else 1), x + 0.88 * wall
        axes.add_patch(Rectangle((x, 0.75), 0.88 * wall, tall, facecolor=style.SECOND, alpha=0.4))
        if i == 2:
            axes.add_patch(Rectangle((right, 0.99), 0.4, 0.4, facecolor=style.FIRST, alpha=0.6))
        else:
            axes.add_patch(Rectangle((right - 0.05, 1.14), 0.1, 0.1, fill=False, edgecolor=style.INK, linewidth=1))
            for side in (-1, 1):
                axes.plot([right + 0.05, x + 1.0], [1.19 + side * 0.05, 1.19 + side * 0.44], "-", color=style.FAINT,
                          linewidth=0.7)
        axes.text(x + 0.44, 0.62, name, ha="center", va="top", fontsize=9)
    text = ("In cells of the size of the small body, the hall would occupy 1e17 of them. So bodies of very "
            "different sizes are in separate grids, and each is looked up in those of the others.")
    axes.text(0.05, 0.28, fill(text, 50), va="top", fontsize=8.5, color="#444c56", linespacing=1.35)
