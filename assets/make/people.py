"""The person who flies; looks along +x, hands at the remote control."""

import numpy as np

from make.faces import HEIGHT, LOW
from make.shapes import Array, Model, Part, ball, loft, moved, surface, tube

HANDS = (0.34, 0.0, 1.15)  # m, where the remote control is held
TILT = -0.3  # rad, its pitch
HEAD = 1.08  # how much larger than life the head is


def person() -> Model:
    """1.78 m tall with the cap, in a blue jacket, jeans and red shoes."""
    model: Model = moved(_head() + _cap(), to=(0, 0, LOW - 0.02 - HEAD * LOW), scale=(HEAD,) * 3) + _torso()
    for side in (1, -1):
        model += _arm(side) + _leg(side) + moved(_hand(side), pitch=TILT, to=HANDS)
    return model


def _upright(
    sections: list[tuple[float, float, float, float]], material: str, segments: int = 12, power: float = 2.4
) -> Part:
    """A body along z through ovals: (z, x of the middle, half-width x, half-width y)."""
    return loft([(z, -x, wide, deep) for z, x, deep, wide in sections], material, segments, power).moved(
        pitch=-np.pi / 2
    )


def _plain(part: Part) -> Part:
    """Skin without the face: the texture's corner."""
    return Part(part.corners, part.uv * 0.08 / max(part.uv.max(), 0.08), "skin", part.crease)


def _torso() -> Model:
    jacket = _upright(
        [
            (0.858, 0.0, 0.118, 0.170),
            (0.915, 0.0, 0.121, 0.172),
            (0.925, 0.0, 0.126, 0.174),
            (1.05, 0.003, 0.119, 0.160),
            (1.20, 0.010, 0.126, 0.170),
            (1.31, 0.008, 0.127, 0.182),
            (1.375, 0.002, 0.114, 0.172),
            (1.415, -0.002, 0.096, 0.132),
            (1.445, -0.004, 0.076, 0.092),
            (1.470, -0.002, 0.062, 0.068),
        ],
        "jacket",
        12,
    )
    collar = _upright([(1.440, -0.002, 0.070, 0.076), (1.505, 0.008, 0.066, 0.068)], "jacket", 12, 2.1)  # fmt: skip
    front = [(0.124, 0, 0.86), (0.123, 0, 1.05), (0.137, 0, 1.20), (0.136, 0, 1.31), (0.098, 0, 1.412),
             (0.072, 0, 1.46), (0.075, 0, 1.50)]  # fmt: skip
    hips = _upright([(0.795, 0.0, 0.075, 0.120), (0.84, 0.0, 0.104, 0.162), (0.89, 0.0, 0.110, 0.164)], "jeans", 10)
    neck = tube([(-0.004, 0, 1.42), (0.010, 0, 1.50), (0.020, 0, 1.56)], [0.056, 0.053, 0.055], "skin", 8)
    return [jacket, collar, tube(front, 0.005, "sole", 4), hips, _plain(neck)]


def _head() -> Model:
    """The head, its texture painted on from the front; nose, ears, and the hair that the cap leaves free."""
    sections = np.array(
        [
            (1.510, 0.036, 0.024, 0.022),
            (1.517, 0.034, 0.048, 0.038),
            (1.540, 0.027, 0.074, 0.060),
            (1.575, 0.018, 0.089, 0.0735),
            (1.620, 0.012, 0.0955, 0.0805),
            (1.660, 0.010, 0.0965, 0.082),
            (1.695, 0.007, 0.0945, 0.080),
            (1.725, 0.004, 0.084, 0.070),
        ]
    )
    count = 18
    angle = np.linspace(-np.pi, np.pi, count + 1)
    ring = np.column_stack([np.cos(angle), np.sin(angle)])[:-1]
    ring = np.sign(ring) * np.abs(ring) ** (2 / 2.15)
    rows = [
        np.column_stack([x + deep * ring[:, 0], wide * ring[:, 1], np.full(count, z)]) for z, x, deep, wide in sections
    ]
    uv = np.dstack(np.broadcast_arrays(0.5 + angle / (2 * np.pi), (sections[:, :1] - LOW) / HEIGHT))
    model: Model = [surface(rows, "skin", closed=True, caps=(True, True), crease=1.5, uv=uv)]
    model += [
        _plain(ball((0.019, 0.0140, 0.0145), (0.109, 0, 1.602), "skin", 8, 5)),
        _plain(tube([(0.090, 0, 1.662), (0.098, 0, 1.632), (0.108, 0, 1.604)], [0.008, 0.009, 0.010], "skin", 6, 1.6)),
        _upright(
            [
                (1.572, -0.050, 0.036, 0.055),
                (1.612, -0.032, 0.066, 0.0795),
                (1.660, -0.016, 0.084, 0.0865),
                (1.712, -0.008, 0.082, 0.076),
            ],
            "hair",
            12,
            2.2,
        ),
    ]
    for side in (1, -1):
        model += [
            _plain(ball((0.018, 0.011, 0.027), (0, 0, 0), "skin", 6, 4)).moved((0.008, 0.083 * side, 1.624),
                                                                              pitch=-0.2, yaw=0.35 * side),
            tube([(0.018, 0.0800 * side, 1.692), (0.018, 0.0828 * side, 1.650), (0.018, 0.0805 * side, 1.618)],
                 [(0.005, 0.020), (0.004, 0.015), (0.003, 0.008)], "hair", 4),
        ]  # fmt: skip
    return model


def _cap() -> Model:
    """A cap with a band, a curved peak and a button."""
    crown = _upright(
        [
            (1.690, 0.005, 0.105, 0.0905),
            (1.712, 0.005, 0.1065, 0.0915),
            (1.738, 0.003, 0.099, 0.085),
            (1.760, 0.000, 0.079, 0.068),
            (1.774, -0.002, 0.046, 0.040),
            (1.780, -0.003, 0.012, 0.011),
        ],
        "cap",
        14,
        2.1,
    )
    across = np.linspace(-1.25, 1.25, 9)
    inner = np.column_stack([0.005 + 0.100 * np.cos(across), 0.086 * np.sin(across)])
    reach = 0.045 * np.cos(1.05 * across) ** 0.6
    outer = inner + np.column_stack([np.cos(across), 0.55 * np.sin(across)]) * reach[:, None]
    rows = []
    for near, far in zip(inner, outer, strict=True):
        edges = [(*near, 1.702), (*far, 1.698 - 0.16 * (far[0] - 0.1)), (*far, 1.694 - 0.16 * (far[0] - 0.1)),
                 (*near, 1.694)]  # fmt: skip
        rows.append(np.array(edges) - [0, 0, 2.6 * near[1] ** 2])
    peak = surface(rows, "cap", closed=True, caps=(True, True), crease=0.8)
    return [crown, peak, ball((0.009, 0.009, 0.005), (-0.003, 0, 1.778), "cap", 5, 3)]


def _arm(side: int) -> Model:
    """A sleeve from the neck over the shoulder to the cuff, and the wrist."""
    stations = np.array(
        [
            (0.0, 0.085, 1.402, 0.044),
            (0.0, 0.140, 1.388, 0.056),
            (0.0, 0.188, 1.350, 0.062),
            (0.0, 0.219, 1.280, 0.058),
            (0.003, 0.241, 1.175, 0.053),
            (0.018, 0.250, 1.110, 0.052),
            (0.062, 0.240, 1.078, 0.050),
            (0.130, 0.209, 1.086, 0.048),
            (0.232, 0.146, 1.115, 0.039),
            (0.262, 0.128, 1.124, 0.041),
        ]
    )
    path = stations[:, :3] * [1, side, 1]
    sleeve = tube(path[:-1], stations[:-1, 3], "jacket", 8)
    cuff = tube(path[-2:], 0.0415, "jacket", 8)
    wrist = np.array([HANDS[0] - 0.050, 0.116 * side, HANDS[2] - 0.024])
    return [sleeve, cuff, _plain(tube([path[-2], wrist], [0.027, 0.026], "skin", 6))]


def _hand(side: int) -> Model:
    """Around the remote control, in its frame: fingers below, the thumb on a stick."""
    model: Model = [_plain(ball((0.043, 0.021, 0.028), (-0.004, 0.112 * side, -0.006), "skin", 8, 4))]
    for x, length in ((0.030, 0.0), (0.012, 0.010), (-0.006, 0.007), (-0.023, -0.004)):
        bend = [(x, 0.118, -0.008), (x + 0.004, 0.108, -0.0265), (x + 0.002, 0.066 - length, -0.0265)]
        model.append(_finger(np.array(bend), side, (0.0110, 0.0105, 0.0088)))
    thumb = np.array([(-0.030, 0.114, 0.004), (-0.010, 0.098, 0.038), (0.014, 0.064, 0.056)])
    model.append(_finger(thumb, side, (0.0175, 0.0140, 0.0105)))
    return model


def _finger(path: Array, side: int, radius: tuple[float, ...]) -> Part:
    """Rounded at its tip."""
    way = path[-1] - path[-2]
    way = way / np.linalg.norm(way)
    points = np.vstack([path, path[-1] + 0.6 * radius[-1] * way]) * [1, side, 1]
    return _plain(tube(points, [*radius, 0.55 * radius[-1]], "skin", 5))


def _leg(side: int) -> Model:
    leg = tube(
        [
            (0.0, 0.080 * side, 0.90),
            (0.002, 0.086 * side, 0.77),
            (0.010, 0.094 * side, 0.60),
            (0.015, 0.099 * side, 0.47),
            (-0.002, 0.104 * side, 0.33),
            (-0.012, 0.109 * side, 0.17),
            (-0.012, 0.111 * side, 0.055),
        ],
        [(0.082, 0.086), (0.080, 0.086), (0.070, 0.075), (0.060, 0.064), (0.059, 0.063), (0.054, 0.059),
         (0.058, 0.064)],
        "jeans",
        8,
    )  # fmt: skip
    shoe = loft(
        [
            (-0.103, 0.050, 0.022, 0.020),
            (-0.090, 0.056, 0.034, 0.035),
            (-0.045, 0.062, 0.039, 0.044),
            (0.010, 0.059, 0.041, 0.042),
            (0.060, 0.049, 0.046, 0.032),
            (0.115, 0.040, 0.047, 0.026),
            (0.154, 0.035, 0.038, 0.021),
            (0.173, 0.030, 0.021, 0.012),
        ],
        "shoes",
        8,
        2.3,
    )
    sole = loft(
        [
            (-0.112, 0.014, 0.022, 0.011),
            (-0.098, 0.013, 0.038, 0.013),
            (-0.020, 0.013, 0.041, 0.013),
            (0.100, 0.013, 0.049, 0.013),
            (0.150, 0.014, 0.042, 0.012),
            (0.177, 0.017, 0.024, 0.009),
        ],
        "sole",
        8,
        5.0,
    )
    laces = [
        tube([(x, 0.022, z - 0.004), (x + 0.006, 0, z + 0.003), (x, -0.022, z - 0.004)], 0.004, "sole", 3)
        for x, z in ((0.044, 0.085), (0.076, 0.072))
    ]
    return [leg, *(part.moved((0.0, 0.112 * side, 0), yaw=0.12 * side) for part in (shoe, sole, *laces))]


MODELS = {"person": person}
