"""Pictures of triangle pairs that rounding gets wrong, with maps of the answers around them."""

import numpy as np
from matplotlib.figure import Figure

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.triangle import intersection as triangle
from figures import style
from reference import textbook

REACH = 20  # steps of a map in each direction
A = np.array([[0.15, 0.1, 0.2], [1.35, 0.35, 0.55], [0.45, 1.25, 0.9]])  # the first triangle of most cases
Place = tuple[int, int]  # corner, coordinate


def on(t: Floats, *weights: float) -> Floats:
    """A rounded point in the plane of t (3, 3): corner 0 plus the weighted edges to corners 1 and 2."""
    return np.asarray(t[0] + weights[0] * (t[1] - t[0]) + weights[1] * (t[2] - t[0]))


def answers(a: Floats, b: Floats, horizontal: Place, vertical: Place) -> tuple[Booleans, Booleans]:
    """Plain and exact answers while two coordinates of b's corners vary in steps of one ulp."""
    steps = np.arange(-REACH, REACH + 1.0)
    side = len(steps)
    bs = np.repeat(b[None], side * side, axis=0)
    for (corner, k), moves in ((horizontal, np.tile(steps, side)), (vertical, np.repeat(steps, side))):
        bs[:, corner, k] = b[corner, k] + moves * np.spacing(abs(b[corner, k]))
    a_s = np.repeat(a[None], len(bs), axis=0)
    return textbook.triangles(a_s, bs).reshape(side, side), triangle.intersects(a_s, bs).reshape(side, side)


def picture(title: str, text: str, a: Floats, b: Floats, horizontal: Place, vertical: Place,
            view: tuple[float, float] = (20, -60), distance: float = 0.0) -> Figure:
    """Both triangles in space, b raised by `distance` for visibility, and the maps over two coordinates of b."""
    figure = style.sheet(title, text)
    shown = b + np.array([0.0, 0.0, distance])
    both = np.concatenate([a, shown])
    middle, reach = (both.max(axis=0) + both.min(axis=0)) / 2, np.ptp(both, axis=0).max() / 2
    space = style.space(figure, style.SHAPES, middle - reach, middle + reach, view, zoom=1.45)
    for corners, name, color in ((a, "A", style.FIRST), (shown, "B", style.SECOND)):
        style.draw_faces(space, [corners], color, alpha=0.4, width=1.4)
        middle = corners.mean(axis=0)
        style.draw_name(space, middle + (0.4 if distance else 0.0) * (corners[2] - middle), name, color)
    moved = {horizontal[0], vertical[0]}
    for corner in moved:
        style.draw_point(space, shown[corner])
        style.draw_name(space, 1.16 * shown[corner] - 0.16 * shown.mean(axis=0), f"b{corner}", style.INK, 9)
    names = [f"{'xyz'[k]} of b{corner}, steps of 1 ulp" for corner, k in (horizontal, vertical)]
    style.draw_maps(figure, *answers(a, b, horizontal, vertical), *names)
    return figure


def coplanar() -> Figure:
    """All corners in one plane up to rounding."""
    b = np.array([on(A, 0.3, 0.25), on(A, 1.2, 0.2), on(A, 0.5, 1.1)])
    return picture(
        "Coplanar triangles",
        "All six corners lie in one plane up to rounding, like those of a floor and a crate on it. The answer depends "
        "on whether the planes cross, coincide or miss each other by an ulp. Distances of corners from the other "
        "plane are differences of products: mostly rounding error.",
        A, b, (0, 2), (1, 2))


def sharing_edge() -> Figure:
    """An edge of B on an edge of A."""
    b = np.array([on(A, 0.15, 0.0), on(A, 0.85, 0.0), [0.95, -0.5, -0.35]])
    return picture(
        "An edge on an edge",
        "Neighbors in a mesh share edges, and adjacent parts of a model share them up to rounding. Here an edge of B "
        "lies on one of A. A step of one ulp moves it into A or off it.",
        A, b, (0, 2), (1, 2))


def sharing_vertex() -> Figure:
    """A common corner."""
    b = np.array([A[1], [2.2, 0.9, 0.2], [2.3, 0.3, 1.3]])
    return picture(
        "A corner on a corner",
        "The triangles have one common point, a corner of both. A step of one ulp along a coordinate moves it inside "
        "A, on its boundary, or off it.",
        A, b, (0, 0), (0, 1))


def needles() -> Figure:
    """Triangles 1e8 times as long as wide."""
    direction = np.array([0.83, 0.45, 0.31])
    tail = np.array([0.1, 0.1, 0.1])
    a = np.array([tail, tail + direction, tail + direction + 1e-8 * np.array([0.3, -0.9, 0.4])])
    middle = tail + 0.6 * direction
    across = np.array([-0.35, 0.6, 0.25])
    b = np.array([middle - across, middle + across, middle + across + 1e-8 * np.array([0.6, 0.1, -0.8])])
    return picture(
        "Needles",
        "Triangles a hundred million times as long as wide, as found in exported models. Their normals are "
        "differences of nearly equal numbers with hardly a correct digit, and so is each answer that depends on "
        "them.",
        a, b, (0, 0), (1, 2))


def zero_area() -> Figure:
    """Three corners on a line."""
    middle, direction = on(A, 0.4, 0.6), np.array([0.5, 0.4, -0.75])
    b = np.array([middle - direction, middle + 0.6 * direction, middle + direction])
    return picture(
        "Triangles without area",
        "Three corners on a line up to rounding: the triangle has no normal, and tests that divide by its area fail. "
        "It is still a segment that hits or misses. Here it passes an edge of A.",
        A, b, (0, 0), (2, 1))


def duplicates() -> Figure:
    """The same triangle twice."""
    b = A[[1, 2, 0]]
    b += np.array([[-1, -1, 2], [-1, 2, 1], [-3, 0, -1]]) * np.spacing(b)
    return picture(
        "The same triangle twice",
        "Duplicate faces are common in models. The second one, drawn above the first, has its corners in another "
        "order and is moved by up to 3 ulp: the two cross along a line, or lie above each other without contact.",
        A, b, (0, 2), (1, 0), distance=0.14)


def far_away() -> Figure:
    """A pair far from the origin."""
    far = np.array([1e6, -1e6, 1e6])
    a = A + far
    b = np.array([on(A, 0.6, 0.25), [1.2, 0.1, 1.3], [0.5, 0.3, 1.7]]) + far
    return picture(
        "A pair far from the origin",
        "Moved by 1e6 m along each axis, all coordinates lose seven digits: neighboring numbers are 0.1 nm apart. The "
        "rounded corners are the input, and the exact answer is theirs. Products of such numbers have errors of many "
        "steps.",
        a, b, (0, 0), (0, 2))
