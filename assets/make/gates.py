"""Concave things to fly through: a racing ring, an archway, a high table. The way through each is along x."""

import numpy as np

from make.shapes import Model, Part, box, circle, surface, tube

RING_MIDDLE = 1.26  # m, height of the ring's centre
RING_RADIUS, RING_THICKNESS = 1.05, 0.13  # m, of the circle, and of the tube around it

ARCH_RADIUS, ARCH_SPRINGING = 0.95, 1.25  # m, half the clear width, and where the round part begins
ARCH_HALF_WIDTH, ARCH_HALF_DEPTH, ARCH_HEIGHT = 1.55, 0.25, 2.75  # m, of the wall


def ring() -> Model:
    """A ring as in drone races, 1.84 m clear, striped, on a heavy foot with four braces."""
    stripes, steps = 12, 4
    model: Model = [
        _torus(2 * np.pi * np.linspace(i, i + 1, steps + 1) / stripes, "accent" if i % 2 else "paint_cream")
        for i in range(stripes)
    ]
    model.append(box((1.10, 1.30, 0.16), (0, 0, 0.08), "shell_dark", bevel=0.03))
    for side in (1, -1):
        angle = -np.pi / 2 + side * 0.62
        top = np.array([0, RING_RADIUS * np.cos(angle), RING_MIDDLE + RING_RADIUS * np.sin(angle)])
        model += [tube([(x, side * 0.52, 0.15), top], 0.028, "steel", 8) for x in (0.42, -0.42)]
    return model


def _torus(angles: np.ndarray, material: str) -> Part:
    """The part of the ring's tube between the first and the last of the angles about x, counted from +y."""
    around = circle(12) * RING_THICKNESS
    outwards = RING_RADIUS + around[:, 1]
    return surface(
        [np.column_stack([around[:, 0], outwards * np.cos(a), RING_MIDDLE + outwards * np.sin(a)]) for a in angles],
        material,
        closed=True,
        crease=1.1,
    )


def archway() -> Model:
    """A wall of bricks with a round arch of stones, 1.82 m clear and 2.16 m high, on plinths and under a coping."""
    above = ARCH_HEIGHT - ARCH_SPRINGING
    corner = np.arctan2(above, ARCH_HALF_WIDTH)
    angles = np.unique([*np.linspace(0, np.pi, 19), corner, np.pi - corner])
    way = np.column_stack([np.cos(angles), np.sin(angles)])
    edge = 1 / np.maximum(np.abs(way[:, 0]) / ARCH_HALF_WIDTH, way[:, 1] / above)
    inner, outer = (way * reach + [0, ARCH_SPRINGING] for reach in (ARCH_RADIUS, edge[:, None]))
    feet = np.array([[1, 0], [-1, 0]])
    inner, outer = (
        np.vstack([feet[:1] * width, line, feet[1:] * width])
        for width, line in ((ARCH_RADIUS, inner), (ARCH_HALF_WIDTH, outer))
    )
    model: Model = [_barrel(inner, outer, ARCH_HALF_DEPTH, "bricks")]
    count = 15
    for i in range(count):
        key = i == count // 2
        bounds = np.pi * np.array([i, i + 1]) / count + [0.012, -0.012]
        way = np.column_stack([np.cos(bounds), np.sin(bounds)])
        near, far, depth = (0.91, 1.34, 0.32) if key else (0.925, 1.22, 0.285)
        model.append(_barrel(*(way * r + [0, ARCH_SPRINGING] for r in (near, far)), depth, "stone"))
    wide, deep = ARCH_HALF_WIDTH - ARCH_RADIUS, 2 * ARCH_HALF_DEPTH
    for side in (1, -1):
        y = side * (ARCH_RADIUS + ARCH_HALF_WIDTH) / 2
        model += [
            box((deep + 0.12, wide + 0.08, 0.30), (0, y, 0.15), "stone", bevel=0.02),
            box((deep + 0.10, wide + 0.06, 0.10), (0, y, ARCH_SPRINGING - 0.05), "stone", bevel=0.015),
        ]
    model.append(box((deep + 0.20, 2 * ARCH_HALF_WIDTH + 0.20, 0.14), (0, 0, ARCH_HEIGHT + 0.07), "stone", bevel=0.025))
    return model


def _barrel(inner: np.ndarray, outer: np.ndarray, half_depth: float, material: str) -> Part:
    """A vault between two lines (n, 2) in the y-z plane that run anti-clockwise seen from +x; closed at its ends."""
    rows = [
        [(x, *point) for x, point in ((half_depth, near), (half_depth, far), (-half_depth, far), (-half_depth, near))]
        for near, far in zip(inner, outer, strict=True)
    ]
    return surface(rows, material, closed=True, caps=(True, True), crease=0.3).boxed()


def table() -> Model:
    """A high table, 2.0 m along y and 1.2 m along x, its four legs 1.6 m apart: 1.1 m clear beneath."""
    deep, wide, height = 1.2, 2.0, 1.28
    model: Model = [box((deep, wide, 0.05), (0, 0, height - 0.025), "cabinet", bevel=0.012).grained()]
    x, y = deep / 2 - 0.11, wide / 2 - 0.14
    under = height - 0.05
    for side in (1, -1):
        model += [
            box((0.09, 0.09, under), (along * x, side * y, under / 2), "wood_light", taper=1.2).grained()
            for along in (1, -1)
        ]
        model += [
            box((2 * x, 0.03, 0.12), (0, side * y, under - 0.06), "wood_light").grained(),
            box((0.03, 2 * y, 0.12), (side * x, 0, under - 0.06), "wood_light").grained(),
        ]
    return model


MODELS = {"ring": ring, "archway": archway, "table": table}
