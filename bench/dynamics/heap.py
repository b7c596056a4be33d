"""The scene of the dynamics benchmark: a floor, 150 boxes that stand on it, and movable boxes that fall among them.

They come of one seed, so that every engine gets the same; density 100 kg/m3, friction 0.6, no restitution.
"""

import numpy as np

from drone_engine.arrays import Floats
from reference.box_world import Box

RATE = 240.0  # Hz
STATIC, DENSITY, FRICTION = 150, 100.0, 0.6
LAYERS = 4
SUBSTEPS, PASSES = 1, 2  # of each step, and over the contacts of each: enough for what the rows of quality show
SEED = 5


def heap(movable: int) -> dict[str, Box]:
    """The movable boxes, in layers two meters over the floor and more, then those that stand on it."""
    rng = np.random.default_rng(SEED)
    sites = np.stack(np.meshgrid(np.arange(15), np.arange(10)), -1).reshape(-1, 2)[:STATIC]
    static_half = rng.uniform(0.2, 0.8, (STATIC, 3))
    beside = (sites - [7, 4.5]) * 2.4 + rng.uniform(-0.3, 0.3, (STATIC, 2))
    yaw = rng.uniform(0, np.pi, STATIC)
    columns = int(np.ceil(movable / LAYERS))
    wide = int(np.ceil(np.sqrt(columns)))
    column, layer = np.arange(movable) % columns, np.arange(movable) // columns
    half = rng.uniform(0.15, 0.4, (movable, 3))
    position = np.column_stack([(column % wide - (wide - 1) / 2) * 0.9, (column // wide - (wide - 1) / 2) * 0.9,
                                2.0 + layer * 0.9]) + rng.uniform(-0.1, 0.1, (movable, 3))
    turned = rng.normal(size=(movable, 4))
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    mass = 8.0 * DENSITY * half.prod(axis=1)
    boxes = {f"moving_{i}": Box(_size(half[i]), (*position[i].tolist(), *_roll_pitch_yaw(turned[i])), float(mass[i]),
                                FRICTION) for i in range(movable)}
    for i in range(STATIC):
        place = (*beside[i].tolist(), float(static_half[i, 2]), 0.0, 0.0, float(yaw[i]))
        boxes[f"standing_{i}"] = Box(_size(static_half[i]), place, None, FRICTION)
    return boxes


def _size(half: Floats) -> tuple[float, float, float]:
    x, y, z = (2.0 * half).tolist()
    return x, y, z


def _roll_pitch_yaw(q: Floats) -> tuple[float, float, float]:
    x, y, z, w = q.tolist()
    return (float(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))),
            float(np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))),
            float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))))
