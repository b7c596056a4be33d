"""Small things: the television, the remote control, crates, the hangar's floor."""

import numpy as np

from make.glazing import glazed
from make.shapes import Model, Part, ball, box, circle, lathe, loft, surface, tube


def television() -> Model:
    """A cathode-ray television of the seventies on a stand with casters; the screen looks along +x."""
    model = [
        box((0.46, 0.84, 0.62), (-0.02, 0, 0.68), "cabinet", bevel=0.025).grained(),
        loft(
            [(-0.42, 0.67, 0.20, 0.16), (-0.40, 0.67, 0.25, 0.20), (-0.25, 0.68, 0.36, 0.26)], "plastic", 16, power=4.5
        ),
        _bezel(0.211, 0.244, 0.60, 0.50, 0.105, 0.69),
        _screen(0.52, 0.41, 0.105, 0.69),
        box((0.02, 0.17, 0.50), (0.214, -0.305, 0.69), "plastic_grey", bevel=0.006),
    ]
    for z, radius in ((0.86, 0.042), (0.75, 0.042)):
        model += [
            _knob(radius, (0.222, -0.305, z)),
            box((0.006, 0.008, 2 * radius), (0.250, -0.305, z), "plastic", bevel=0.001),
        ]
    model += [_knob(0.014, (0.222, -0.305 + y, 0.665)) for y in (-0.045, 0.0, 0.045)]
    model += [box((0.008, 0.13, 0.008), (0.226, -0.305, z), "plastic") for z in np.arange(0.475, 0.63, 0.026)]
    model.append(box((0.004, 0.10, 0.014), (0.238, 0.105, 0.448), "brass"))
    model += _stand() + _aerial()
    return model


def _bezel(back: float, front: float, width: float, height: float, y: float, z: float) -> Part:
    """A dark frame around the screen, falling inwards."""
    corner = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) / 2
    rows = [
        np.column_stack([np.full(4, x), corner * [width - 2 * inset, height - 2 * inset] + [y, z]])
        for x, inset in ((back, 0.0), (front, 0.012), (front, 0.03), (back, 0.045))
    ]
    return surface(rows, "plastic", closed=True, crease=0.3).boxed()


def _screen(width: float, height: float, y: float, z: float) -> Part:
    """Curved glass; the picture fills it, its top up, its left on the viewer's left."""
    across, up = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 7))
    bulge = 0.2105 + 0.042 * (1 - (across**2 + 0.62 * up**2) / 1.62)
    part = surface(np.dstack([bulge, y + across * width / 2, z + up * height / 2]), "screen", crease=1.5)
    uv = (part.corners[..., 1:] - [y, z]) / [width, height] + 0.5
    return Part(part.corners, uv, part.material, part.crease)


def _knob(radius: float, at: tuple[float, float, float]) -> Part:
    return lathe([(radius, 0.0), (radius * 0.92, 0.020), (radius * 0.5, 0.026), (0.0, 0.026)], "chrome", 10).moved(
        at, pitch=np.pi / 2
    )


def _stand() -> Model:
    """Four splayed legs on casters, and a shelf."""
    model: Model = [box((0.42, 0.78, 0.03), (-0.02, 0, 0.355), "cabinet", bevel=0.008).grained()]
    for x in (0.15, -0.19):
        for side in (1, -1):
            top, foot = np.array([x, 0.34 * side, 0.35]), np.array([x + np.sign(x) * 0.03, 0.37 * side, 0.075])
            model += [
                tube([top, foot], [0.022, 0.014], "cabinet", 8, along="u"),
                tube([foot, foot - [0, 0, 0.03]], 0.010, "brass", 6),
                lathe(
                    [(0.0, -0.013), (0.030, -0.013), (0.035, -0.006), (0.035, 0.006), (0.030, 0.013), (0.0, 0.013)],
                    "rubber",
                    8,
                ).moved(foot * [1, 1, 0] + [0, 0, 0.035], roll=np.pi / 2),
            ]
    return model


def _aerial() -> Model:
    """Two rods that stand in a V on a round foot."""
    model: Model = [
        lathe([(0.075, 0.0), (0.07, 0.02), (0.03, 0.045), (0.0, 0.05)], "plastic", 12).moved((-0.05, 0, 0.988))
    ]
    for side in (1, -1):
        foot, tip = np.array([-0.05, 0.01 * side, 1.025]), np.array([-0.08, 0.20 * side, 1.24])
        model += [tube([foot, tip], [0.005, 0.0025], "chrome", 5), ball((0.008,) * 3, tip, "chrome", 6, 4)]
    return model


def remote_control() -> Model:
    """Two sticks, a display and an aerial; held flat, its aerial points along +x."""
    model: Model = [
        box((0.11, 0.19, 0.032), (0, 0, 0), "shell_dark", bevel=0.009),
        glazed(box((0.030, 0.062, 0.004), (-0.030, 0, 0.017), "glass_lit"), "plain"),
    ]
    for side in (1, -1):
        gimbal = lathe([(0.022, 0.0), (0.020, 0.006), (0.008, 0.004)], "steel", 10)
        model += [
            gimbal.moved((0.012, 0.055 * side, 0.016)),
            tube([(0.012, 0.055 * side, 0.016), (0.016, 0.055 * side, 0.044)], 0.0035, "chrome", 5),
            ball((0.007,) * 3, (0.016, 0.055 * side, 0.046), "accent", 6, 4),
            tube([(0.05, 0.03 * side, 0.0), (0.13, 0.045 * side, 0.05)], [0.006, 0.0035], "plastic", 5),
        ]
    return model


def crate() -> Model:
    """A wooden box of 0.8 m, boards within a frame."""
    side = 0.8
    inner, rail = side - 0.05, 0.09
    half = (side - rail) / 2
    model: Model = [box((inner,) * 3, (0, 0, side / 2), "crate")]
    for a in (-half, half):
        for b in (-half, half):
            model += [
                box((rail, rail, side), (a, b, side / 2), "wood_light").grained(),
                box((side - 2 * rail, rail, rail), (0, a, side / 2 + b), "wood_light").grained(),
                box((rail, side - 2 * rail, rail), (a, 0, side / 2 + b), "wood_light").grained(),
            ]
    for yaw in (0, np.pi / 2, np.pi, -np.pi / 2):
        model.append(
            box((0.86, 0.018, 0.08), (0, 0, 0), "wood_light")
            .grained()
            .moved(pitch=np.pi / 4)
            .moved((0, inner / 2 + 0.009, side / 2))
            .moved(yaw=yaw)
        )
    return model


def hangar_floor() -> Model:
    """40 m square of concrete at z = 0, with a yellow circle to start from."""
    ring = circle(48)
    square = ring * (20 / np.abs(ring).max(axis=1, keepdims=True))
    rows = [np.column_stack([flat, np.zeros(48)]) for flat in (square, 0.4 * square, 1.62 * ring, 1.50 * ring)]
    return [
        surface(rows[:3], "concrete", closed=True).boxed(),
        surface(rows[2:], "floor_line", closed=True),
        surface([rows[3], rows[3] * 0.3], "concrete", closed=True, caps=(False, True)).boxed(),
    ]


MODELS = {"television": television, "remote_control": remote_control, "crate": crate, "hangar_floor": hangar_floor}
