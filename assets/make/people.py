"""The person who flies; looks along +x, hands in front for the remote control."""

import numpy as np

from make.shapes import Model, Part, ball, box, loft, tube

HANDS = (0.34, 0.0, 1.13)  # m, where the remote control is held


def person() -> Model:
    """1.75 m tall, in a blue jacket, jeans and red shoes, head bent a little forward."""
    model: Model = _head() + _torso()
    for side in (1, -1):
        model += _arm(side) + _leg(side)
    return model


def _upright(
    sections: list[tuple[float, float, float, float]], material: str, segments: int = 12, power: float = 2.4
) -> Part:
    """A body along z through ovals: (z, x of the middle, half-width x, half-width y)."""
    return loft([(z, -x, wide, deep) for z, x, deep, wide in sections], material, segments, power).moved(
        pitch=-np.pi / 2
    )


def _torso() -> Model:
    jacket = _upright(
        [
            (0.875, 0.0, 0.120, 0.172),
            (0.93, 0.0, 0.12, 0.172),
            (1.05, 0.0, 0.115, 0.160),
            (1.22, 0.01, 0.125, 0.185),
            (1.34, 0.0, 0.125, 0.200),
            (1.40, 0.0, 0.108, 0.185),
            (1.435, 0.0, 0.085, 0.14),
            (1.46, 0.0, 0.06, 0.09),
        ],
        "jacket",
        12,
        2.6,
    )
    collar = _upright([(1.43, 0.004, 0.078, 0.085), (1.49, 0.008, 0.068, 0.072)], "jacket", 12)
    front = [(0.119, 0, 0.89), (0.118, 0, 1.05), (0.138, 0, 1.22), (0.127, 0, 1.34), (0.085, 0, 1.45)]
    zip_ = tube(front, 0.006, "steel", 4)
    hips = _upright([(0.80, 0.0, 0.088, 0.168), (0.87, 0.0, 0.108, 0.165)], "jeans", 12)
    return [jacket, collar, zip_, hips, tube([(0, 0, 1.42), (0.02, 0, 1.54)], 0.055, "skin", 10)]


def _head() -> Model:
    model: Model = [
        _upright(
            [
                (1.515, 0.045, 0.045, 0.040),
                (1.535, 0.035, 0.075, 0.058),
                (1.59, 0.022, 0.092, 0.072),
                (1.65, 0.018, 0.098, 0.078),
                (1.70, 0.012, 0.092, 0.075),
                (1.745, 0.005, 0.06, 0.05),
            ],
            "skin",
            12,
            2.2,
        )
    ]
    model.append(
        _upright(
            [
                (1.59, -0.045, 0.055, 0.070),
                (1.64, -0.022, 0.082, 0.084),
                (1.685, -0.008, 0.096, 0.085),
                (1.73, 0.004, 0.088, 0.074),
                (1.765, 0.002, 0.045, 0.040),
            ],
            "hair",
            10,
            2.2,
        )
    )
    model.append(_upright([(1.698, 0.07, 0.085, 0.079), (1.712, 0.062, 0.084, 0.080)], "accent", 12))
    model.append(
        _upright(
            [
                (1.700, 0.004, 0.101, 0.089),
                (1.735, 0.002, 0.099, 0.086),
                (1.765, 0.0, 0.078, 0.066),
                (1.782, 0.0, 0.03, 0.026),
            ],
            "accent",
            10,
        )
    )
    model.append(ball((0.018, 0.014, 0.022), (0.118, 0, 1.625), "skin", 6, 4))
    smile = [(0.113 - 20 * y * y, y, 1.570 + 12 * y * y) for y in (-0.026, -0.010, 0.010, 0.026)]
    model.append(tube(smile, 0.005, "mouth", 4))
    for side in (1, -1):
        model += [
            ball((0.008, 0.012, 0.010), (0.108, 0.030 * side, 1.655), "eye", 5, 4),
            ball((0.022, 0.012, 0.030), (0.010, 0.082 * side, 1.635), "skin", 6, 4),
        ]
    return model


def _arm(side: int) -> Model:
    shoulder, elbow = np.array([0.0, 0.188 * side, 1.365]), np.array([0.03, 0.250 * side, 1.10])
    thumb = np.array([(0.03, -0.015 * side, 0.02), (0.055, -0.045 * side, 0.035)])
    wrist = np.array([HANDS[0] - 0.05, 0.115 * side, HANDS[2] - 0.005])
    return [
        ball((0.062, 0.058, 0.060), shoulder, "jacket", 8, 5),
        tube([shoulder, (shoulder + elbow) / 2, elbow], [0.060, 0.055, 0.050], "jacket", 8, caps=(False, False)),
        ball((0.051, 0.051, 0.051), elbow, "jacket", 8, 5),
        tube([elbow, (elbow + wrist) / 2, wrist], [0.050, 0.045, 0.038], "jacket", 8, caps=(False, True)),
        ball((0.052, 0.030, 0.036), wrist + np.array([0.035, -0.006 * side, 0.0]), "skin", 8, 5),
        tube(wrist + thumb, [0.013, 0.010], "skin", 6),
    ]


def _leg(side: int) -> Model:
    leg = tube(
        [
            (0.0, 0.082 * side, 0.92),
            (0.0, 0.088 * side, 0.80),
            (0.012, 0.098 * side, 0.48),
            (-0.005, 0.108 * side, 0.26),
            (-0.012, 0.112 * side, 0.07),
        ],
        [(0.082, 0.084), (0.080, 0.086), (0.062, 0.066), (0.058, 0.062), (0.056, 0.060)],
        "jeans",
        8,
    )
    shoe = loft(
        [
            (-0.095, 0.055, 0.030, 0.030),
            (-0.07, 0.062, 0.042, 0.042),
            (0.0, 0.062, 0.044, 0.044),
            (0.08, 0.050, 0.048, 0.032),
            (0.15, 0.042, 0.040, 0.022),
            (0.17, 0.038, 0.022, 0.012),
        ],
        "shoes",
        8,
    )
    sole = box((0.262, 0.088, 0.026), (0.037, 0, 0.013), "sole", bevel=0.010)
    return [leg, *(part.moved((0.0, 0.112 * side, 0), yaw=0.12 * side) for part in (shoe, sole))]


MODELS = {"person": person}
