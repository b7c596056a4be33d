"""Houses, a barn, a lighthouse; doors look along +x."""

import numpy as np

from make.glazing import glazed
from make.shapes import Model, Part, ball, box, circle, lathe, moved, prism, surface, tube


def gable(
    width: float, depth: float, eaves: float, ridge: float, wall: str, roof: str, overhang: float = 0.35
) -> Model:
    """Walls, and a roof whose ridge runs along y, `width` of the house; `depth` is along x."""
    outline = [(depth / 2, 0), (depth / 2, eaves), (0, ridge), (-depth / 2, eaves), (-depth / 2, 0)]
    body = prism(outline, width, wall).moved((0, width / 2, 0), roll=np.pi / 2)
    slope = np.arctan2(ridge - eaves, depth / 2)
    length = depth / 2 / np.cos(slope) + overhang
    model: Model = [Part(body.corners, body.uv, wall, 0.3).boxed()]
    for side in (1, -1):
        slab = box((length, width + 2 * overhang, 0.12), (length / 2, 0, 0.07), roof)
        slab = Part(slab.corners, np.stack([slab.corners[..., 1], -slab.corners[..., 0]], axis=-1), roof, 0.3)
        fascia = box((0.06, width + 2 * overhang + 0.04, 0.18), (length - 0.035, 0, 0.0), "trim")
        model += [
            part.moved(pitch=slope).moved((0, 0, ridge)).moved(yaw=0 if side > 0 else np.pi) for part in (slab, fascia)
        ]
    ends = [(0, side * (width / 2 + overhang), ridge + 0.10) for side in (-1, 1)]
    model.append(tube(ends, 0.11, roof, 6))
    return model


def window(width: float, height: float, glass: str = "glass", shutters: str | None = None) -> Model:
    """A pane with frame, cross bars and sill in the y-z plane, its middle at the origin, looking along +x."""
    corner = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) / 2
    frame = [
        np.column_stack([np.full(4, x), corner * [width + 2 * margin, height + 2 * margin]])
        for x, margin in ((0.0, 0.08), (0.08, 0.08), (0.08, 0.0), (0.01, 0.0))
    ]
    model: Model = [
        glazed(_sheet(0.02, width, height, 0, glass), "lit" if glass == "glass_lit" else "window"),
        _sheet(0.03, 0.05, height, 0, "trim"),
        _sheet(0.03, width, 0.05, 0.1, "trim"),
        surface(frame, "trim", closed=True, crease=0.3).boxed(),
        box((0.20, width + 0.28, 0.07), (0.05, 0, -height / 2 - 0.07), "trim"),
    ]
    if shutters:
        size = (0.05, 0.46 * width, height + 0.05)
        model += [box(size, (0.03, side * (0.76 * width + 0.09), 0), shutters) for side in (1, -1)]
    return model


def _sheet(x: float, width: float, height: float, z: float, material: str) -> Part:
    """A rectangle that looks along +x."""
    rows = [[(x, y, z + up * height / 2) for y in (-width / 2, width / 2)] for up in (-1, 1)]
    return surface(rows, material)


def door(width: float, height: float, material: str = "door") -> Model:
    """A door with frame, handle and a step, its threshold at the origin, looking along +x."""
    return [
        box((0.19, width, height), (0, 0, height / 2), material),
        box((0.20, width + 0.28, 0.14), (0.03, 0, height + 0.07), "trim"),
        *(box((0.20, 0.14, height), (0.03, side * (width / 2 + 0.07), height / 2), "trim") for side in (1, -1)),
        ball((0.04, 0.04, 0.04), (0.12, width * 0.36, height * 0.48), "brass", 6, 4),
        box((0.55, width + 0.5, 0.14), (0.25, 0, 0.07), "stone"),
    ]


def cottage() -> Model:
    """One storey, white render under red tiles, green shutters, a chimney of bricks."""
    width, depth = 8.0, 6.0
    model = gable(width, depth, 2.7, 4.9, "plaster", "roof_tiles")
    model.append(box((depth + 0.16, width + 0.16, 0.35), (0, 0, 0.175), "stone"))
    front = depth / 2
    model += moved(door(1.0, 2.05), (front, 0, 0))
    for y in (-2.5, 2.5):
        model += moved(window(1.15, 1.15, "glass_lit" if y > 0 else "glass", "door"), (front, y, 1.6))
        model += moved(window(1.15, 1.15, "glass", "door"), (-front, y, 1.6), yaw=np.pi)
    for side in (1, -1):
        model += moved(window(1.0, 1.15), (0, side * width / 2, 1.6), yaw=side * np.pi / 2)
        model += moved(window(0.6, 0.6), (0, side * width / 2, 3.5), yaw=side * np.pi / 2)
    model += [
        box((0.7, 0.7, 2.0), (-1.2, 2.6, 4.6), "bricks"),
        box((0.86, 0.86, 0.12), (-1.2, 2.6, 5.62), "stone"),
        lathe([(0.14, 0.0), (0.16, 0.3), (0.12, 0.3)], "roof_tiles", 8).moved((-1.2, 2.6, 5.68)),
    ]
    return model


def brick_house() -> Model:
    """Two storeys of bricks under slate, with a bay for the door."""
    width, depth = 9.0, 6.5
    model = gable(width, depth, 5.2, 7.6, "bricks", "roof_slate")
    model += [
        box((depth + 0.14, width + 0.14, 0.4), (0, 0, 0.2), "stone"),
        box((depth + 0.10, width + 0.10, 0.16), (0, 0, 2.75), "trim"),
    ]
    front = depth / 2
    porch = gable(2.4, 3.0, 2.5, 3.5, "bricks", "roof_slate", 0.22)
    model += moved(porch, (front, 0, 0), yaw=np.pi / 2)
    model += moved(door(1.1, 2.1), (front + 1.2, 0, 0))
    for y in (-3.1, 3.1):
        model += moved(window(1.3, 1.4, "glass_lit" if y < 0 else "glass"), (front, y, 1.55))
        model += moved(window(1.3, 1.4), (-front, y, 1.55), yaw=np.pi)
    for y in (-3.1, 0, 3.1):
        model += moved(window(1.1, 1.3, "glass_lit" if y > 0 else "glass"), (front, y, 4.15))
        model += moved(window(1.1, 1.3), (-front, y, 4.15), yaw=np.pi)
    for side in (1, -1):
        model += moved(window(0.9, 0.9), (0, side * width / 2, 5.9), yaw=side * np.pi / 2)
        model += moved(window(1.1, 1.4), (1.2, side * width / 2, 1.55), yaw=side * np.pi / 2)
        model += [
            box((0.8, 0.8, 1.9), (0, side * 3.6, 7.7), "bricks"),
            box((0.95, 0.95, 0.14), (0, side * 3.6, 8.7), "stone"),
        ]
    return model


def barn() -> Model:
    """Red boards with white corners, a wide gate with crossed battens, hay loft above."""
    width, depth = 7.0, 9.0
    model = gable(depth, width, 3.0, 5.6, "planks", "roof_slate", 0.4)
    model = moved(model, yaw=np.pi / 2)
    front = depth / 2
    for side in (1, -1):
        model += [box((0.22, 0.22, 3.0), (x * front, side * width / 2, 1.5), "trim") for x in (1, -1)]
        model.append(box((0.10, 1.5, 2.7), (front + 0.03, side * 0.76, 1.35), "planks"))
        for z in (0.08, 1.35, 2.62):
            model.append(box((0.06, 1.5, 0.14), (front + 0.10, side * 0.76, z), "trim"))
        model += [box((0.06, 0.12, 2.7), (front + 0.10, side * (0.76 + 0.69 * k), 1.35), "trim") for k in (-1, 1)]
        model.append(
            box((0.05, 0.12, 1.90), (0, 0, 0), "trim").moved(roll=side * 0.86).moved((front + 0.09, side * 0.76, 0.72))
        )
        for x in (-2.2, 0.6, 3.0):
            model += moved(window(0.9, 0.8), (x - 0.4, side * width / 2, 1.7), yaw=side * np.pi / 2)
    model += moved(window(1.0, 1.0), (front, 0, 4.0))
    return model


def lighthouse() -> Model:
    """A tapering tower in red and white bands, a gallery, a lamp room with a red cap."""
    model: Model = [lathe([(2.0, 0.0), (2.0, 0.5), (1.85, 0.6)], "stone", 16, crease=0.4)]
    levels = np.linspace(0.6, 9.6, 6)
    radius = 1.75 - 0.075 * (levels - 0.6)
    for band in range(5):
        model.append(
            lathe(
                [(radius[band], levels[band]), (radius[band + 1], levels[band + 1])],
                "plaster_red" if band % 2 == 0 else "plaster",
                20,
            )
        )
    model += [
        lathe([(1.05, 9.55), (1.55, 9.85), (1.55, 10.0), (0.0, 10.0)], "stone", 16, crease=0.3),
        glazed(lathe([(0.75, 10.0), (0.75, 11.4)], "lamp", 16), "lens"),
        lathe(
            [(1.0, 11.35), (1.0, 11.5), (0.25, 12.3), (0.10, 12.35), (0.10, 12.6), (0.0, 12.75)],
            "paint_red",
            16,
            crease=0.5,
        ),
    ]
    rail = np.column_stack([circle(12) * 1.45, np.full(12, 10.75)])
    ring = np.vstack([rail, rail[:1]])
    model.append(tube(ring, 0.035, "trim", 3, caps=(False, False)))
    for a in np.arange(8) * np.pi / 4:
        model += [
            tube(
                [(1.45 * np.cos(a), 1.45 * np.sin(a), 10.0), (1.45 * np.cos(a), 1.45 * np.sin(a), 10.75)],
                0.03,
                "trim",
                4,
            ),
            box((0.06, 0.06, 1.4), (0.76 * np.cos(a), 0.76 * np.sin(a), 10.7), "trim"),
        ]
    model += moved(door(1.0, 2.0), (1.82, 0, 0.5))
    for z, yaw in ((4.2, 0.0), (7.6, 0.0), (5.6, 2.3), (3.4, -2.3)):
        at = 1.75 - 0.075 * (z - 0.6)
        model += moved(moved(window(0.5, 0.8), (at, 0, z)), yaw=yaw)
    return model


MODELS = {"cottage": cottage, "brick_house": brick_house, "barn": barn, "lighthouse": lighthouse}
