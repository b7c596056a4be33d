"""The two drones and their rotors. A drone's origin is the middle of its box, a rotor's is its hub."""

import numpy as np

from make.glazing import glazed
from make.shapes import Model, Part, ball, box, centred, lathe, loft, moved, surface, tube

REACH = 0.19  # m from the middle to a rotor of the user's drone, along x and along y
WOOD_REACH = 0.20
CORNERS = ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0))


def drone() -> Model:
    """The user's drone: a rounded shell between four ducts, its front marked in orange, on two skids."""
    shell = loft(
        [
            (-0.165, 0.010, 0.030, 0.014),
            (-0.15, 0.010, 0.050, 0.028),
            (-0.09, 0.012, 0.072, 0.040),
            (0.0, 0.014, 0.080, 0.046),
            (0.08, 0.010, 0.072, 0.042),
            (0.14, 0.004, 0.052, 0.032),
            (0.165, 0.0, 0.036, 0.020),
        ],
        "shell",
        segments=16,
        power=2.8,
    )
    canopy = loft(
        [
            (-0.10, 0.046, 0.010, 0.004),
            (-0.07, 0.050, 0.034, 0.014),
            (0.0, 0.054, 0.044, 0.018),
            (0.07, 0.046, 0.038, 0.014),
            (0.115, 0.034, 0.012, 0.005),
        ],
        "shell_dark",
        segments=12,
    )
    nose = loft(
        [(0.148, 0.002, 0.0475, 0.0275), (0.166, 0.0, 0.038, 0.022), (0.174, -0.001, 0.026, 0.014)],
        "accent",
        segments=16,
        power=2.8,
    )
    stripe = loft(
        [(0.085, 0.010, 0.0735, 0.0435), (0.108, 0.0075, 0.0675, 0.0405)],
        "accent",
        segments=16,
        power=2.8,
        caps=(False, False),
    )
    model = [shell, canopy, nose, stripe]
    model += [
        tube([(0.150, 0, -0.030), (0.176, 0, -0.030)], [0.018, 0.016], "shell_dark", 12),
        glazed(tube([(0.174, 0, -0.030), (0.180, 0, -0.030)], [0.012, 0.010], "lens", 12), "plain"),
    ]
    for x, y in CORNERS:
        model += _duct(x * REACH, y * REACH, "accent" if x > 0 else "shell_dark")
        model.append(
            tube(
                [(0.07 * x, 0.05 * y, 0.008), (REACH * x, REACH * y, 0.012)],
                [(0.022, 0.011), (0.012, 0.008)],
                "shell_dark",
                8,
            )
        )
        model.append(
            glazed(
                box(
                    (0.02, 0.02, 0.008),
                    (x * (REACH + 0.096), y * (REACH + 0.096), 0.030),
                    "light_white" if x > 0 else ("light_green" if y < 0 else "light_red"),
                    bevel=0.002,
                ),
                "lens",
            )
        )
    for side in (1.0, -1.0):
        y = 0.085 * side
        model.append(
            tube(
                [(0.155, y, -0.118), (0.115, y, -0.130), (-0.115, y, -0.130), (-0.145, y, -0.122)], 0.0075, "carbon", 6
            )
        )
        model += [
            tube([(x, 0.045 * side, -0.015), (x * 1.12, y, -0.130)], [(0.010, 0.006), (0.007, 0.005)], "shell_dark", 6)
            for x in (0.075, -0.075)
        ]
    return centred(model)


def _duct(x: float, y: float, rim: str) -> Model:
    """A ring around a rotor, with a coloured upper lip, its motor and a stay."""
    outside = [(0.126, -0.020), (0.135, -0.020), (0.141, 0.018)]
    lip = [(0.141, 0.018), (0.135, 0.030), (0.126, 0.026)]
    inside = [(0.126, 0.026), (0.126, -0.020)]
    motor = lathe([(0.019, -0.004), (0.019, 0.020), (0.012, 0.026), (0.0, 0.026)], "steel", 8)
    parts: Model = [lathe(outside, "shell", 20), lathe(lip, rim, 20), lathe(inside, "shell_dark", 20), motor]
    angle = np.arctan2(y, x)
    parts.append(box((0.25, 0.012, 0.008), (0, 0, -0.010), "shell_dark").moved(yaw=angle + np.pi / 2))
    return moved(parts, to=(x, y, 0.006))


def rotor(direction: int) -> Model:
    """Three twisted blades; direction 1 turns counter-clockwise."""
    hub = lathe([(0.013, 0.0), (0.014, 0.007), (0.009, 0.014), (0.0, 0.017)], "shell_dark", 8, caps=(True, False))
    model = [hub]
    for turn in range(3):
        model += [blade.moved(yaw=turn * 2 * np.pi / 3) for blade in _blade(0.117, 0.026, "blade", "blade_tip")]
    return model if direction > 0 else moved(model, scale=(1, -1, 1))


def _blade(length: float, chord: float, material: str, tip: str) -> Model:
    """A thin blade along x whose upper edge leads when it turns counter-clockwise."""
    stations = np.array([0.06, 0.20, 0.50, 0.90, 1.0])
    chords = chord * np.array([0.35, 0.80, 1.0, 0.62, 0.20])
    twist = np.array([0.55, 0.48, 0.32, 0.20, 0.16])
    section = np.array([(-0.5, 0.0), (-0.1, -0.04), (0.5, 0.0), (0.1, 0.07)])  # forward is +y
    rows = [
        np.column_stack(
            [
                np.full(4, station * length),
                width * (section[:, 0] * np.cos(angle) - section[:, 1] * np.sin(angle)),
                0.008 + width * (section[:, 0] * np.sin(angle) + section[:, 1] * np.cos(angle)),
            ]
        )
        for station, width, angle in zip(stations, chords, twist, strict=True)
    ]
    return [
        surface(rows[:4], material, closed=True, along="u", caps=(True, False)),
        surface(rows[3:], tip, closed=True, along="u", caps=(False, True)),
    ]


def wood_drone() -> Model:
    """The computer's drone, as if carved by hand: a hull like a boat's, pegged arms, a tail fin, four bent feet."""
    hull = loft(
        [
            (-0.225, 0.022, 0.010, 0.012),
            (-0.19, 0.018, 0.030, 0.028),
            (-0.11, 0.008, 0.058, 0.044),
            (0.0, 0.0, 0.070, 0.052),
            (0.11, 0.002, 0.062, 0.046),
            (0.18, 0.008, 0.042, 0.032),
            (0.225, 0.014, 0.016, 0.014),
        ],
        "wood",
        segments=16,
        power=2.2,
    )
    deck = loft(
        [
            (-0.12, 0.046, 0.018, 0.006),
            (-0.09, 0.052, 0.036, 0.012),
            (0.0, 0.058, 0.042, 0.014),
            (0.09, 0.052, 0.036, 0.012),
            (0.12, 0.045, 0.016, 0.006),
        ],
        "wood_dark",
        segments=12,
    )
    fin = _fin()
    model: Model = [hull, deck, fin, ball((0.012, 0.012, 0.012), (0.232, 0, 0.014), "brass", 8, 6)]
    for side in (1.0, -1.0):
        model.append(
            lathe([(0.0, 0.0), (0.015, 0.0), (0.017, 0.006), (0.012, 0.008)][::-1], "brass", 10).moved(
                (0.155, 0.0485 * side, 0.016), roll=-np.pi / 2 * side, pitch=np.pi if side < 0 else 0
            )
        )
        model.append(glazed(ball((0.011, 0.006, 0.011), (0.157, 0.047 * side, 0.016), "lens", 8, 6), "plain"))
    for x, y in CORNERS:
        end = np.array([x * WOOD_REACH, y * WOOD_REACH, 0.020])
        start = np.array([0.055 * x, 0.03 * y, 0.005])
        middle = (start + end) / 2 + [0, 0, 0.012]
        model.append(
            tube([start, middle, end], [(0.022, 0.014), (0.016, 0.011), (0.014, 0.010)], "wood_light", 8, along="u")
        )
        model.append(
            lathe(
                [
                    (0.0, -0.022),
                    (0.016, -0.018),
                    (0.021, -0.006),
                    (0.023, 0.010),
                    (0.018, 0.024),
                    (0.008, 0.028),
                    (0.008, 0.034),
                    (0.0, 0.034),
                ],
                "wood_dark",
                8,
            ).moved(end)
        )
        model.append(lathe([(0.0235, 0.000), (0.0245, 0.004), (0.0235, 0.008)], "brass", 8).moved(end))
        foot = np.array([(0.10 * x, 0.05 * y, -0.02), (0.125 * x, 0.085 * y, -0.07), (0.13 * x, 0.10 * y, -0.125)])
        model.append(tube(foot, [0.013, 0.010, 0.008], "wood_light", 6, along="u"))
        model.append(ball((0.014, 0.014, 0.009), foot[-1], "wood_dark", 8, 4))
    for x in (-0.07, 0.0, 0.07):
        model.append(lathe([(0.007, 0.0), (0.006, 0.004), (0.0, 0.005)], "wood_light", 6).moved((x, 0, 0.0655)))
    return centred(model)


def _fin() -> Part:
    """An upright tail, rounded like a fish's."""
    outline = np.array(
        [(-0.16, 0.040), (-0.20, 0.030), (-0.245, 0.055), (-0.262, 0.095), (-0.235, 0.100), (-0.195, 0.070)]
    )
    rows = [np.column_stack([outline[:, 0], np.full(len(outline), y), outline[:, 1]]) for y in (-0.006, 0.006)]
    return surface([row[::-1] for row in rows[::-1]], "wood_light", closed=True, caps=(True, True), crease=0.5).boxed()


def wood_rotor(direction: int) -> Model:
    """Two broad carved blades on a peg; direction 1 turns counter-clockwise."""
    peg = lathe([(0.012, -0.002), (0.015, 0.004), (0.012, 0.014), (0.0, 0.018)], "brass", 8, caps=(True, False))
    model: Model = [peg]
    for turn in range(2):
        model += [blade.moved(yaw=turn * np.pi) for blade in _blade(0.150, 0.036, "wood_light", "wood_dark")]
    return model if direction > 0 else moved(model, scale=(1, -1, 1))


MODELS = {
    "drone": drone,
    "drone_rotor_ccw": lambda: rotor(1),
    "drone_rotor_cw": lambda: rotor(-1),
    "wood_drone": wood_drone,
    "wood_rotor_ccw": lambda: wood_rotor(1),
    "wood_rotor_cw": lambda: wood_rotor(-1),
}
