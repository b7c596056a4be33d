"""Common style of all pictures: title and text on top, shapes on the left, maps or plots on the right."""

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from PIL import Image

from drone_engine.arrays import Booleans, Floats, Integers

FIRST, SECOND = "#3f78b8", "#efa22f"  # A and B
INK, FAINT = "#22272e", "#8a94a0"
GRID, GRAY = "#e6e9ed", "#5b6570"
HIT, APART, MISSED, INVENTED = "#44617f", "#e8ecf1", "#d7263d", "#8e3fb0"
MEANINGS = {HIT: "hit", APART: "no hit", MISSED: "missed hit", INVENTED: "false hit"}
WIDTH, HEIGHT, DPI = 10.4, 4.5, 115  # inches
SHAPES = (-0.01, 0.02, 0.42, 0.74)  # of the view of the shapes
FIRST_MAP, SECOND_MAP = ((left, 0.145, 0.585 * HEIGHT / WIDTH, 0.585) for left in (0.44, 0.72))
LINE = 145  # characters
Place = tuple[float, float, float, float]  # left, bottom, width, height in figure coordinates
COLORS = 200  # size of a picture's palette

mpl.rcParams |= {"font.family": "DejaVu Sans", "font.size": 9, "text.color": INK, "axes.labelcolor": INK,
                 "axes.edgecolor": FAINT, "xtick.color": FAINT, "ytick.color": FAINT, "axes.linewidth": 0.7,
                 "svg.hashsalt": "0"}


def sheet(title: str, text: str) -> Figure:
    """An empty picture with its title and a text of up to two lines below it."""
    figure = Figure((WIDTH, HEIGHT), dpi=DPI, facecolor="white")
    figure.text(0.02, 0.955, title, fontsize=13.5, fontweight="bold", va="top")
    figure.text(0.02, 0.875, fill(text, LINE), fontsize=9.5, va="top", linespacing=1.35, color="#444c56")
    return figure


def save(figure: Figure, path: Path) -> None:
    """Writes a PNG with a palette, which is a third of the size of one without."""
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png")
    picture = Image.open(drawn).convert("RGB")
    path.parent.mkdir(parents=True, exist_ok=True)
    picture.quantize(COLORS, dither=Image.Dither.NONE).save(path, optimize=True)


def space(figure: Figure, place: Place, low: Sequence[float], high: Sequence[float],
          view: tuple[float, float] = (18, -58), zoom: float = 1.35) -> Any:
    """Frameless 3D axes over the region from low to high; view: elevation and azimuth in degrees."""
    axes: Any = figure.add_axes(place, projection="3d", computed_zorder=False)
    axes.set_axis_off()
    axes.view_init(*view)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(np.subtract(high, low), zoom=zoom)
    axes.patch.set_alpha(0)
    return axes


def draw_box(axes: Any, center: Floats, axes_rows: Floats, half: Floats, color: str, alpha: float = 0.35,
             **more: Any) -> None:
    """Draws a box; axes_rows (3, 3): its axes, one per row; half: half extents (3,)."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = center + (signs * half) @ axes_rows
    faces = [corners[[a, b, c, d]] for a, b, c, d in
             ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))]
    draw_faces(axes, faces, color, alpha, **more)


def draw_faces(axes: Any, faces: Sequence[Floats], color: str, alpha: float = 0.35, width: float = 0.9,
               zorder: float = 2) -> None:
    """Draws polygons, each (k, 3), with their edges."""
    polygons = Poly3DCollection(faces, facecolor=mpl.colors.to_rgba(color, alpha),
                                edgecolor=mpl.colors.to_rgba(color, 0.95), linewidth=width, zorder=zorder)
    polygons.set_clip_on(False)
    axes.add_collection3d(polygons)


def draw_lines(axes: Any, lines: Sequence[Floats], color: str, width: float = 1.2, zorder: float = 3) -> None:
    """Draws polylines, each (k, 3)."""
    strokes = Line3DCollection(lines, colors=color, linewidths=width, zorder=zorder)
    strokes.set_clip_on(False)
    axes.add_collection3d(strokes)


def draw_point(axes: Any, point: Floats, color: str = INK, size: float = 18) -> None:
    """Draws a point (3,)."""
    axes.scatter(*point, color=color, s=size, depthshade=False, zorder=5, clip_on=False)


def draw_name(axes: Any, point: Floats, name: str, color: str = INK, size: float = 12) -> None:
    """Writes a name at a point (3,), readable on any color."""
    halo = [withStroke(linewidth=3, foreground="white")]
    axes.text(*point, name, color=color, fontsize=size, fontweight="bold", ha="center", va="center", zorder=9,
              path_effects=halo)


def draw_map(figure: Figure, place: Place, classes: Integers, colors: Sequence[str], title: str, x_label: str,
             y_label: str = "", alarm: bool = False) -> None:
    """Draws a map of classes (k, k) of answers over two inputs that vary in steps of one ulp.

    Entry [i, j]: i steps up, j steps right; colors: one per class; alarm: whether the title is red.
    """
    reach = classes.shape[0] // 2
    axes = figure.add_axes(place)
    axes.imshow(classes, cmap=ListedColormap(colors), vmin=0, vmax=len(colors) - 1, origin="lower",
                extent=(-reach - 0.5, reach + 0.5, -reach - 0.5, reach + 0.5), interpolation="nearest")
    axes.set_title(title, fontsize=10.5, loc="left", pad=6, color=MISSED if alarm else INK, fontweight="bold")
    axes.set_xlabel(x_label, fontsize=8.5, labelpad=2)
    if y_label:
        axes.set_ylabel(y_label, fontsize=8.5, labelpad=1)
    else:
        axes.set_yticklabels([])
    axes.tick_params(length=2, labelsize=7.5)


def draw_maps(figure: Figure, plain: Booleans, exact: Booleans, x_label: str, y_label: str) -> None:
    """Draws the map of plain float64 answers beside that of exact answers, with a legend."""
    wrong = int((plain != exact).sum())
    classes = np.where(exact, np.where(plain, 0, 2), np.where(plain, 3, 1))
    title = f"float64: {wrong:,} of {plain.size:,} wrong"
    draw_map(figure, FIRST_MAP, classes, list(MEANINGS), title, x_label, y_label, wrong > 0)
    draw_map(figure, SECOND_MAP, np.where(exact, 0, 1), list(MEANINGS), "exact, as in drone_engine", x_label)
    legend(figure, MEANINGS)


def legend(figure: Figure, meanings: Mapping[str, str]) -> None:
    """Draws the legend of the colors in the lower right corner."""
    classes = [Patch(facecolor=color, edgecolor=FAINT, linewidth=0.4, label=text) for color, text in meanings.items()]
    figure.legend(handles=classes, loc="lower right", ncols=len(classes), frameon=False, fontsize=8.5, handlelength=1.1,
                  handleheight=1.1, columnspacing=1.4, bbox_to_anchor=(0.995, -0.005))


def label(figure: Figure, x: float, y: float, text: str, **more: Any) -> None:
    """Writes a centered text at figure coordinates."""
    figure.text(x, y, text, **{"fontsize": 9, "color": INK, "ha": "center", "va": "center", **more})


def tidy(axes: Any) -> None:
    """Removes frame lines and sets grid, ticks and their colors."""
    axes.grid(color=GRID, linewidth=0.8, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(length=2, labelsize=8.5, colors=GRAY)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def number(value: float, unit: str = "") -> str:
    """The value with two digits and without exponent."""
    digits = f"{value:.2g}"
    return (f"{float(digits):.0f}" if abs(value) >= 10 else digits) + (f" {unit}" if unit else "")


def length(meters: float) -> str:
    """A length with the unit m, cm or mm."""
    if meters >= 1.0:
        return number(meters, "m")
    return number(100 * meters, "cm") if meters >= 0.01 else number(1000 * meters, "mm")
