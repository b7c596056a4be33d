"""Scene of the dynamics benchmark: a floor, 150 static boxes on it, and movable boxes that fall among them.

A fixed seed gives all engines the same boxes; density 100 kg/m^3, friction 0.6, no restitution.
"""

import numpy as np

from drone_engine.arrays import Floats
from reference.box_world import Box

RATE = 240.0  # Hz
STATIC, DENSITY, FRICTION = 150, 100.0, 0.6
LAYERS = 4
SUBSTEPS, ITERATIONS = 1, 2  # sub-steps per step and solver iterations per sub-step
SEED = 5


def heap(movable: int) -> dict[str, Box]:
    """The movable boxes, in layers from 2 m above the floor on, followed by the static ones."""
    rng = np.random.default_rng(SEED)
    cells = np.stack(np.meshgrid(np.arange(15), np.arange(10)), -1).reshape(-1, 2)[:STATIC]
    static_half = rng.uniform(0.2, 0.8, (STATIC, 3))
    static_xy = (cells - [7, 4.5]) * 2.4 + rng.uniform(-0.3, 0.3, (STATIC, 2))
    yaw = rng.uniform(0, np.pi, STATIC)
    columns = int(np.ceil(movable / LAYERS))
    width = int(np.ceil(np.sqrt(columns)))
    column, layer = np.arange(movable) % columns, np.arange(movable) // columns
    half = rng.uniform(0.15, 0.4, (movable, 3))
    position = np.column_stack([(column % width - (width - 1) / 2) * 0.9, (column // width - (width - 1) / 2) * 0.9,
                                2.0 + layer * 0.9]) + rng.uniform(-0.1, 0.1, (movable, 3))
    quaternions = rng.normal(size=(movable, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
    mass = 8.0 * DENSITY * half.prod(axis=1)
    boxes = {f"moving_{i}": Box(_size(half[i]), (*position[i].tolist(), *_roll_pitch_yaw(quaternions[i])),
                                float(mass[i]), FRICTION) for i in range(movable)}
    for i in range(STATIC):
        pose = (*static_xy[i].tolist(), float(static_half[i, 2]), 0.0, 0.0, float(yaw[i]))
        boxes[f"standing_{i}"] = Box(_size(static_half[i]), pose, None, FRICTION)
    return boxes


def _size(half: Floats) -> tuple[float, float, float]:
    """Edge lengths of half extents (3,)."""
    x, y, z = (2.0 * half).tolist()
    return x, y, z


def _roll_pitch_yaw(q: Floats) -> tuple[float, float, float]:
    """Roll, pitch and yaw in rad of a unit quaternion (4,)."""
    x, y, z, w = q.tolist()
    return (float(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))),
            float(np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))),
            float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))))
