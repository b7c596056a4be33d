"""Pairs of triangles that rounding gets wrong, and maps of the answers around them."""

import numpy as np
from matplotlib.figure import Figure

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.triangle import intersection as triangle
from figures import style
from reference import textbook

REACH = 20  # steps each way of a map
A = np.array([[0.15, 0.1, 0.2], [1.35, 0.35, 0.55], [0.45, 1.25, 0.9]])  # most cases' first triangle
Place = tuple[int, int]  # corner, coordinate


def on(t: Floats, *weights: float) -> Floats:
    """A point in the plane of a triangle, rounded: corner 0 plus so much of each of the edges that leave it."""
    return np.asarray(t[0] + weights[0] * (t[1] - t[0]) + weights[1] * (t[2] - t[0]))


def answers(a: Floats, b: Floats, across: Place, up: Place) -> tuple[Booleans, Booleans]:
    """The plain and the exact answer while two coordinates of b's corners move by steps of one ulp."""
    steps = np.arange(-REACH, REACH + 1.0)
    side = len(steps)
    bs = np.repeat(b[None], side * side, axis=0)
    for (corner, k), moves in ((across, np.tile(steps, side)), (up, np.repeat(steps, side))):
        bs[:, corner, k] = b[corner, k] + moves * np.spacing(abs(b[corner, k]))
    a_s = np.repeat(a[None], len(bs), axis=0)
    return textbook.triangles(a_s, bs).reshape(side, side), triangle.intersects(a_s, bs).reshape(side, side)


def picture(title: str, text: str, a: Floats, b: Floats, across: Place, up: Place,
            view: tuple[float, float] = (20, -60), apart: float = 0.0) -> Figure:
    """Both triangles in space, b raised by `apart`, and the maps over two coordinates of b."""
    figure = style.sheet(title, text)
    shown = b + np.array([0.0, 0.0, apart])
    both = np.concatenate([a, shown])
    middle, reach = (both.max(axis=0) + both.min(axis=0)) / 2, np.ptp(both, axis=0).max() / 2
    space = style.space(figure, style.SHAPES, middle - reach, middle + reach, view, zoom=1.45)
    for corners, name, color in ((a, "A", style.FIRST), (shown, "B", style.SECOND)):
        style.draw_faces(space, [corners], color, alpha=0.4, width=1.4)
        middle = corners.mean(axis=0)
        style.draw_name(space, middle + (0.4 if apart else 0.0) * (corners[2] - middle), name, color)
    moved = {across[0], up[0]}
    for corner in moved:
        style.draw_point(space, shown[corner])
        style.draw_name(space, 1.16 * shown[corner] - 0.16 * shown.mean(axis=0), f"b{corner}", style.INK, 9)
    names = [f"{'xyz'[k]} of b{corner}, steps of 1 ulp" for corner, k in (across, up)]
    style.draw_maps(figure, *answers(a, b, across, up), *names)
    return figure


def coplanar() -> Figure:
    b = np.array([on(A, 0.3, 0.25), on(A, 1.2, 0.2), on(A, 0.5, 1.1)])
    return picture(
        "Coplanar triangles",
        "All six corners lie in one plane, as those of a floor and a crate on it do, up to rounding. Whether the "
        "planes cross, coincide or miss each other by an ulp decides. Heights of corners above the other plane are "
        "differences of products: mostly rounding error.",
        A, b, (0, 2), (1, 2))


def sharing_edge() -> Figure:
    b = np.array([on(A, 0.15, 0.0), on(A, 0.85, 0.0), [0.95, -0.5, -0.35]])
    return picture(
        "An edge on an edge",
        "Neighbors in a mesh share edges, and parts that were modelled side by side share them up to rounding. Here "
        "an edge of B lies on one of A. Moved by an ulp, it cuts into A or leaves it.",
        A, b, (0, 2), (1, 2))


def sharing_vertex() -> Figure:
    b = np.array([A[1], [2.2, 0.9, 0.2], [2.3, 0.3, 1.3]])
    return picture(
        "A corner on a corner",
        "The triangles have one corner in common, the only point where they meet. Moved by an ulp along one "
        "coordinate, it is inside of A, on its rim, or off it.",
        A, b, (0, 0), (0, 1))


def needles() -> Figure:
    way = np.array([0.83, 0.45, 0.31])
    tail = np.array([0.1, 0.1, 0.1])
    a = np.array([tail, tail + way, tail + way + 1e-8 * np.array([0.3, -0.9, 0.4])])
    middle = tail + 0.6 * way
    across = np.array([-0.35, 0.6, 0.25])
    b = np.array([middle - across, middle + across, middle + across + 1e-8 * np.array([0.6, 0.1, -0.8])])
    return picture(
        "Needles",
        "Triangles a hundred million times as long as wide, as careless export leaves them. Their normals are "
        "differences of nearly equal numbers, of which hardly a digit is right, and so is every answer that is built "
        "on them.",
        a, b, (0, 0), (1, 2))


def zero_area() -> Figure:
    middle, way = on(A, 0.4, 0.6), np.array([0.5, 0.4, -0.75])
    b = np.array([middle - way, middle + 0.6 * way, middle + way])
    return picture(
        "Triangles without area",
        "Three corners on a line, up to rounding: it has no normal, and tests that divide by its area fail. It still "
        "is a segment that hits or misses. Here it passes an edge of A.",
        A, b, (0, 0), (2, 1))


def duplicates() -> Figure:
    b = A[[1, 2, 0]]
    b += np.array([[-1, -1, 2], [-1, 2, 1], [-3, 0, -1]]) * np.spacing(b)
    return picture(
        "The same triangle twice",
        "Duplicate faces are common in models. The second has its corners in another order and, drawn apart here, is "
        "moved by up to 3 ulps: the two cross along a line, or lie above each other like sheets of paper.",
        A, b, (0, 2), (1, 0), apart=0.14)


def far_away() -> Figure:
    far = np.array([1e6, -1e6, 1e6])
    a = A + far
    b = np.array([on(A, 0.6, 0.25), [1.2, 0.1, 1.3], [0.5, 0.3, 1.7]]) + far
    return picture(
        "The same pair, a million meters away",
        "Moved by 1e6 m along each axis, all coordinates lose seven digits: neighboring numbers are 0.1 nm apart. "
        "The moved corners are the input, and the answer is theirs. Products of such numbers leave errors of many "
        "steps.",
        a, b, (0, 0), (0, 2))
