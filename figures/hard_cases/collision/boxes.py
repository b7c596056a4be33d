"""Pictures of box pairs that rounding gets wrong, with maps of the answers around them."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.box import obb
from figures import style
from reference import textbook

EPSILON = 2.0**-53
X_STEPS, Y_STEPS = "x of B, steps of 1 ulp", "y of B, steps of 1 ulp"
REACH = 20  # steps of a map in each direction


class Box(NamedTuple):
    """Center (3,), axes (3, 3), one per row, half extents (3,)."""

    center: Floats
    axes: Floats
    half: Floats


def random_axes(rng: np.random.Generator) -> Floats:
    """Three random axes, orthonormal up to rounding."""
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


def rotation_rows(roll: float, pitch: float, yaw: float) -> Floats:
    """Axes, one per row, of a box rotated about x, then y, then z, by angles in rad."""
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return np.asarray((about_z @ about_y @ about_x).T)


def stepped(value: float, steps: Floats, unit: float = 0.0) -> Floats:
    """A number moved by whole steps of `unit`, or of one ulp if it is 0."""
    return value + steps * (unit or np.spacing(abs(value)))


def grids() -> tuple[Floats, Floats]:
    """Horizontal and vertical steps of all entries of a map, flat."""
    steps = np.arange(-REACH, REACH + 1.0)
    horizontal, vertical = np.meshgrid(steps, steps)
    return horizontal.ravel(), vertical.ravel()


def answers(a: list[Floats], b: list[Floats]) -> tuple[Booleans, Booleans]:
    """Plain and exact answers over a map; inputs that are constant over the map may have a single row."""
    n = (2 * REACH + 1) ** 2
    pairs = [np.ascontiguousarray(np.broadcast_to(part, (n, *part.shape[1:]))) for part in (*a, *b)]
    side = 2 * REACH + 1
    return textbook.boxes(*pairs).reshape(side, side), obb.intersects(*pairs).reshape(side, side)


def rows(box: Box) -> list[Floats]:
    """The parts of the box with a leading axis of length 1."""
    return [part[None] for part in box]


def brought_to_touch(a: Box, b: Box) -> Box:
    """b moved along the line between the centers until it touches a."""
    direction = b.center - a.center
    low, high = 0.0, 4.0
    while low < (middle := (low + high) / 2) < high:
        hit = obb.intersects(*rows(a), *rows(b._replace(center=a.center + middle * direction)))[0]
        low, high = (middle, high) if hit else (low, middle)
    return b._replace(center=a.center + low * direction)


def moved_grid(box: Box, horizontal: Floats, vertical: Floats, first: int, second: int) -> list[Floats]:
    """The box at all entries of a map over two coordinates of its center."""
    center = np.repeat(box.center[None], len(horizontal), axis=0)
    center[:, second] = stepped(box.center[second], vertical)
    center[:, first] = stepped(box.center[first], horizontal)
    return [center, box.axes[None], box.half[None]]


def name_both(space: Any, a: Box, b: Box) -> None:
    """Writes the names A and B at the centers."""
    for box, name, color in ((a, "A", style.FIRST), (b, "B", style.SECOND)):
        style.draw_name(space, box.center, name, color)


def near_touch() -> Figure:
    """Randomly rotated boxes that touch in one point."""
    rng = np.random.default_rng(4)
    a = Box(np.array([0.1, -0.2, 0.05]), random_axes(rng), np.array([0.5, 0.35, 0.25]))
    b = brought_to_touch(a, Box(np.array([0.75, 0.62, 0.55]), random_axes(rng), np.array([0.3, 0.45, 0.2])))
    figure = style.sheet(
        "Boxes near touch",
        "Two boxes in random orientations touch in one point. The maps move the center of the second box by single "
        "steps between neighboring float64 numbers. The plain test accumulates rounding errors that are larger than "
        "such a step.")
    space = style.space(figure, style.SHAPES, (-0.6, -0.8, -0.5), (1.2, 1.1, 1.0))
    style.draw_box(space, *a, style.FIRST)
    style.draw_box(space, *b, style.SECOND)
    name_both(space, a, b)
    horizontal, vertical = grids()
    style.draw_maps(figure, *answers(rows(a), moved_grid(b, horizontal, vertical, 0, 1)), X_STEPS, Y_STEPS)
    return figure


def parallel() -> Figure:
    """Boxes rotated by 90 degrees up to rounding."""
    a = Box(np.zeros(3), np.eye(3), np.array([0.6, 0.5, 0.4]))
    quarter = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    b = Box(np.array([1.1, 0.1, 0.05]), quarter, np.array([0.9, 0.5, 0.3]))
    figure = style.sheet(
        "Parallel boxes, rotated by 90 degrees up to an ulp",
        "cos(90 degrees) is 6e-17 in float64, not 0. The cross products of parallel edges are such numbers, too: "
        "rounding errors instead of directions. On the maps, the second box lies against the first and is tilted in "
        "steps of 1.1e-16 rad.")
    space = style.space(figure, style.SHAPES, (-0.7, -0.9, -0.5), (1.7, 1.1, 0.6), zoom=1.2)
    style.draw_box(space, *a, style.FIRST)
    style.draw_box(space, *b, style.SECOND)
    name_both(space, a, b)
    horizontal, vertical = grids()
    tilted = np.repeat(b.axes[None], len(vertical), axis=0)
    tilted[:, 0, 0], tilted[:, 1, 1] = vertical * EPSILON, vertical * EPSILON
    maps = answers(rows(a), [moved_grid(b, horizontal, vertical, 0, 0)[0], tilted, b.half[None]])
    style.draw_maps(figure, *maps, X_STEPS, "tilt of B, steps of 1.1e-16 rad")
    return figure


def exact_touch() -> Figure:
    """Axis-aligned boxes that share a part of a face, of an edge, or a corner."""
    half_a, half_b = np.array([0.1, 0.1, 0.1]), np.array([0.2, 0.2, 0.2])
    figure = style.sheet(
        "Exact touches and gaps of one ulp",
        "Axis-aligned boxes that share a part of a face, a part of an edge, or a corner. Touching counts as a hit, a "
        "gap of one ulp does not. The maps vary the half width of A, 0.1 m, and the position of B, 0.3 m; the float64 "
        "sum 0.1 + 0.2 is rounded.")
    for i, (away, name) in enumerate((((1, 0, 0), "face"), ((1, 1, 0), "edge"), ((1, 1, 1), "corner"))):
        place = (-0.005 + 0.125 * i, 0.22, 0.145, 0.45)
        space = style.space(figure, place, (-0.1, -0.1, -0.1), (0.5, 0.5, 0.5), zoom=1.0)
        center = 0.3 * np.array(away) + 0.12 * (1 - np.array(away))
        style.draw_box(space, center, np.eye(3), half_b, style.SECOND)
        style.draw_box(space, np.zeros(3), np.eye(3), half_a, style.FIRST, alpha=0.55)
        style.draw_name(space, np.zeros(3), "A", style.FIRST, 10)
        style.draw_name(space, center, "B", style.SECOND, 10)
        style.label(figure, 0.065 + 0.125 * i, 0.2, name)
    horizontal, vertical = grids()
    halves = np.repeat(half_a[None], len(horizontal), axis=0)
    halves[:, 0] = stepped(0.1, horizontal)
    centers = np.repeat([[0.3, 0.12, 0.12]], len(horizontal), axis=0)
    centers[:, 0] = stepped(0.3, vertical)
    maps = answers([np.zeros((1, 3)), np.eye(3)[None], halves], [centers, np.eye(3)[None], half_b[None]])
    style.draw_maps(figure, *maps, "half width of A, steps of 1 ulp", X_STEPS)
    return figure


def thin() -> Figure:
    """A rod at the edge of a plate."""
    plate = Box(np.array([0.1, 0.2, 0.1]), rotation_rows(0.3, -0.2, 0.4), np.array([0.8, 0.6, 0.0]))
    rod_at = plate.center + 0.85 * plate.axes[0] + 0.1 * plate.axes[1]
    rod = brought_to_touch(plate, Box(rod_at, rotation_rows(0.25, 0.35, 0.1), np.array([0.0, 0.0, 0.7])))
    figure = style.sheet(
        "Plates, rods and points",
        "A box may be a plate, a rod or a point. Without an interior, each wrong sign gives a wrong answer: the rod "
        "hits the edge of the plate or misses it. The same holds for boxes a million times larger than the other "
        "one.")
    space = style.space(figure, style.SHAPES, (-0.8, -0.8, -0.8), (1.2, 1.2, 0.9), view=(24, -70))
    style.draw_box(space, *plate, style.FIRST)
    style.draw_lines(space, [rod.center + np.array([[-0.7], [0.7]]) * rod.axes[2]], style.SECOND, 3.0)
    style.draw_name(space, plate.center, "A", style.FIRST)
    style.draw_name(space, rod.center + 0.55 * rod.axes[2] + [0.12, 0, 0], "B", style.SECOND)
    horizontal, vertical = grids()
    style.draw_maps(figure, *answers(rows(plate), moved_grid(rod, horizontal, vertical, 0, 1)), X_STEPS, Y_STEPS)
    return figure
