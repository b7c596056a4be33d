"""A pick-up truck."""

import numpy as np

from make.glazing import glazed
from make.shapes import Model, Part, ball, box, lathe, prism, surface, tube

AXLES = (1.45, -1.35)  # m, x of the wheels
TRACK = 0.78  # m, from the middle to a wheel


def truck() -> Model:
    """An old pick-up, 4.6 m long, red, with a cream roof and a flat bed of boards."""
    bonnet = _along_y(
        [(2.20, 0.55), (2.25, 0.95), (2.05, 1.08), (0.75, 1.16), (0.75, 0.45), (2.15, 0.45)], 1.52, "paint_red"
    )
    cab = _along_y(
        [(0.80, 0.42), (0.80, 1.18), (0.42, 1.80), (-0.45, 1.84), (-0.58, 1.15), (-0.58, 0.42)], 1.58, "paint_red"
    )
    roof = _along_y([(0.46, 1.78), (0.36, 1.90), (-0.38, 1.93), (-0.50, 1.82)], 1.50, "paint_cream")
    model: Model = [bonnet, cab, roof, box((4.1, 0.9, 0.22), (-0.05, 0, 0.46), "plastic")]
    model += _seams() + [glazed(part, "plain") if part.material == "glass" else part for part in _glass()]
    model += _bed() + _front()
    for x in AXLES:
        for side in (1, -1):
            model += [*_wheel(x, side), _fender(x, side)]
    return model


def _along_y(outline: list[tuple[float, float]], width: float, material: str) -> Part:
    """An outline of (x, z), counter-clockwise seen from the right, as wide as given."""
    flat, bevel = np.array(outline), 0.035
    middle, half = (flat.max(axis=0) + flat.min(axis=0)) / 2, np.ptp(flat, axis=0) / 2
    inset = middle + (flat - middle) * (1 - bevel / half)
    rows = [
        np.column_stack([ring, np.full(len(flat), y)])
        for ring, y in ((inset, 0.0), (flat, bevel), (flat, width - bevel), (inset, width))
    ]
    return (
        surface(rows, material, closed=True, caps=(True, True), crease=0.3)
        .boxed()
        .moved((0, width / 2, 0), roll=np.pi / 2)
    )


def _seams() -> Model:
    """The gaps around doors and bonnet, and a strip of chrome along the sides."""
    model: Model = []
    for side in (1, -1):
        model += [box((0.014, 0.006, 0.66), (x, side * 0.790, 0.80), "rubber") for x in (0.69, -0.49)]
        model += [
            box((1.18, 0.006, 0.014), (0.10, side * 0.790, 0.475), "rubber"),
            box((1.26, 0.006, 0.014), (1.43, side * 0.760, 1.02), "rubber"),
            box((1.24, 0.014, 0.022), (0.10, side * 0.790, 0.93), "chrome"),
            box((1.28, 0.014, 0.022), (1.45, side * 0.760, 0.93), "chrome"),
        ]
    return model


def _glass() -> Model:
    """Windscreen, rear window and the doors' windows, a little outside of the cab."""
    slope = np.arctan2(0.62, 0.38)
    model: Model = [
        box((0.60, 1.36, 0.03), (0, 0, 0), "glass").moved(pitch=slope).moved((0.625, 0, 1.49)),
        box((0.03, 1.2, 0.42), (-0.515, 0, 1.50), "glass").moved(pitch=0.0),
    ]
    for side in (1, -1):
        pane = (
            prism([(0.60, 1.20), (0.34, 1.70), (-0.38, 1.70), (-0.44, 1.20)], 0.03, "glass")
            .moved(roll=np.pi / 2)
            .moved((0, 0.805 if side > 0 else -0.775, 0))
        )
        model += [
            pane,
            box((0.14, 0.03, 0.03), (-0.30, side * 0.80, 1.05), "chrome"),
            ball((0.03, 0.09, 0.07), (0.72, side * 0.93, 1.28), "chrome", 6, 4),
            tube([(0.70, side * 0.78, 1.16), (0.72, side * 0.93, 1.24)], 0.012, "chrome", 4),
        ]
    return model


def _bed() -> Model:
    """A floor of boards with low sides, and a load of crates' lids and a barrel."""
    model: Model = [box((1.70, 1.60, 0.08), (-1.47, 0, 0.74), "crate")]
    for side in (1, -1):
        model.append(box((1.70, 0.06, 0.36), (-1.47, side * 0.80, 0.92), "planks"))
        model += [box((0.07, 0.05, 0.46), (x, side * 0.845, 0.90), "plastic") for x in (-0.70, -1.47, -2.25)]
    model += [box((0.06, 1.66, 0.36), (x, 0, 0.92), "planks") for x in (-2.30, -0.64)]
    model += [
        lathe([(0.26, 0.0), (0.31, 0.2), (0.33, 0.4), (0.31, 0.6), (0.26, 0.8), (0.0, 0.78)], "wood_dark", 9).moved(
            (-1.10, 0.36, 0.78)
        ),
        box((0.6, 0.6, 0.5), (-1.2, -0.38, 1.03), "crate", bevel=0.02),
        box((0.5, 0.9, 0.35), (-1.95, 0.1, 0.96), "crate", bevel=0.02),
    ]
    return model


def _front() -> Model:
    """Grille, lamps, bumpers."""
    model: Model = [box((0.06, 0.82, 0.34), (2.21, 0, 0.78), "plastic")]
    model += [box((0.05, 0.80, 0.025), (2.235, 0, z), "chrome") for z in (0.66, 0.74, 0.82, 0.90)]
    for side in (1, -1):
        model += [
            glazed(ball((0.08, 0.11, 0.11), (2.20, side * 0.58, 0.82), "lamp", 10, 6), "lens"),
            glazed(box((0.04, 0.12, 0.14), (-2.33, side * 0.70, 0.66), "light_red"), "lens"),
        ]
    return [
        *model,
        tube(
            [(2.30, -0.86, 0.48), (2.36, -0.5, 0.48), (2.36, 0.5, 0.48), (2.30, 0.86, 0.48)],
            [(0.04, 0.07)] * 4,
            "chrome",
            6,
            along="u",
        ),
        box((0.08, 1.6, 0.12), (-2.36, 0, 0.50), "chrome", bevel=0.02),
    ]


def _wheel(x: float, side: int) -> Model:
    tyre = lathe(
        [(0.33, -0.11), (0.37, -0.07), (0.37, 0.07), (0.33, 0.11), (0.20, 0.11)],
        "rubber",
        12,
        crease=0.6,
    )
    rim = lathe([(0.21, 0.10), (0.16, 0.06), (0.08, 0.09), (0.0, 0.13)], "paint_cream", 10)
    return [part.moved(roll=-side * np.pi / 2).moved((x, side * TRACK, 0.37)) for part in (tyre, rim)]


def _fender(x: float, side: int) -> Part:
    """An arch over a wheel."""
    angle = np.linspace(0.15, np.pi - 0.15, 7)
    outline = np.vstack(
        [
            np.column_stack([np.cos(angle), np.sin(angle)]) * 0.47,
            np.column_stack([np.cos(angle), np.sin(angle)])[::-1] * 0.42,
        ]
    )
    rows = [
        np.column_stack([outline[:, 0] + x, np.full(len(outline), y), outline[:, 1] + 0.37])
        for y in (side * TRACK + 0.15, side * TRACK - 0.15)
    ]
    return surface(rows, "paint_red", closed=True, crease=0.5).boxed()


MODELS = {"truck": truck}
