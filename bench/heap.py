"""The scene of the dynamics benchmark: a floor, 150 boxes that stand on it, and movable boxes that fall among them.

They come of one seed, so that every engine gets the same; density 100 kg/m3, friction 0.6, no restitution.
"""

import numpy as np
from box_world import Box, G, Setting, depth, energy, fastest, world_of

from drone_sim.arrays import Floats
from drone_sim.world import World

RATE = 240.0  # Hz
STATIC, DENSITY, FRICTION = 150, 100.0, 0.6
LAYERS = 4
SUBSTEPS = 4  # of each step, as many as the published figures of Box3D are for
SEED = 5


class Heap:
    """n movable boxes; half extents (k, 3) m, positions (k, 3) m of the middles, orientations (k, 4) xyzw."""

    def __init__(self, movable: int) -> None:
        rng = np.random.default_rng(SEED)
        sites = np.stack(np.meshgrid(np.arange(15), np.arange(10)), -1).reshape(-1, 2)[:STATIC]
        self.static_half = rng.uniform(0.2, 0.8, (STATIC, 3))
        beside = (sites - [7, 4.5]) * 2.4 + rng.uniform(-0.3, 0.3, (STATIC, 2))
        self.static_position = np.column_stack([beside, self.static_half[:, 2]])
        self.static_yaw = rng.uniform(0, np.pi, STATIC)
        columns = int(np.ceil(movable / LAYERS))
        wide = int(np.ceil(np.sqrt(columns)))
        column, layer = np.arange(movable) % columns, np.arange(movable) // columns
        self.half = rng.uniform(0.15, 0.4, (movable, 3))
        self.position = np.column_stack([
            (column % wide - (wide - 1) / 2) * 0.9, (column // wide - (wide - 1) / 2) * 0.9,
            2.0 + layer * 0.9]) + rng.uniform(-0.1, 0.1, (movable, 3))
        turned = rng.normal(size=(movable, 4))
        self.orientation = turned / np.linalg.norm(turned, axis=1)[:, None]
        self.mass = 8.0 * DENSITY * self.half.prod(axis=1)
        self.inertia = self.mass[:, None] / 3 * ((self.half**2).sum(1, keepdims=True) - self.half**2)

    @property
    def count(self) -> int:
        return len(self.mass)

    def energy(self, position: Floats, velocity: Floats, angular_b: Floats) -> float:
        """Kinetic and potential, J; angular velocity in the boxes' own frames."""
        return float((self.mass * (G * position[:, 2] + 0.5 * (velocity**2).sum(1))
                      + 0.5 * (self.inertia * angular_b**2).sum(1)).sum())


class Ours:
    """The heap in a World."""

    name = "ours"

    def __init__(self, heap: Heap, sleep: bool = False) -> None:
        boxes = {f"moving_{i}": Box(tuple((2 * heap.half[i]).tolist()),
                                    (*heap.position[i], *_roll_pitch_yaw(heap.orientation[i])), float(heap.mass[i]),
                                    FRICTION)
                 for i in range(heap.count)}
        boxes |= {f"standing_{i}": Box(tuple((2 * heap.static_half[i]).tolist()),
                                       (*heap.static_position[i], 0.0, 0.0, float(heap.static_yaw[i])), None, FRICTION)
                  for i in range(STATIC)}
        self.world: World = world_of(boxes, Setting(RATE, SUBSTEPS, sleep=sleep), floor=0.0, friction=FRICTION)
        self.count = heap.count

    def reset(self) -> None:
        self.world.reset()

    def run(self, steps: int) -> None:
        self.world.run(steps)

    def deepest(self) -> float:
        return depth(self.world)

    def energy(self) -> float:
        return energy(self.world)

    def fastest(self) -> float:
        return fastest(self.world)

    def positions(self) -> Floats:
        return self.world.state.position_w[: self.count]

    def close(self) -> None:
        """Nothing to give back."""


def _roll_pitch_yaw(q: Floats) -> tuple[float, float, float]:
    x, y, z, w = q.tolist()
    return (float(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))),
            float(np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))),
            float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))))
