"""Random poses near touch: a model approaches another along random lines until the surfaces touch or it has passed."""

from pathlib import Path

import numpy as np

from bench.accuracy.collision.flights import Encounter
from drone_engine.arrays import Floats
from drone_engine.collision import Shape, intersects
from drone_engine.geometry import mesh
from drone_engine.math.poses import rotate_all

STEP = 0.01  # m between poses of a line
AHEAD = 0.1  # m between the bounding spheres at the start of a line
PAUSE = 1000.0  # s between the aims of consecutive lines, longer than any line
DEEP = (0.0005, 0.01)  # m past the touch
APART = (0.001, 1.0)  # m before the touch, log-uniform
EACH = 4  # poses of either kind per line that ends in a touch


def lines(path_a: Path, path_b: Path, count: int, random: np.random.Generator) -> tuple[Encounter, Encounter]:
    """`count` approaches at 1 m/s, one after the other: all poses of each line, and poses near the touches only.

    path_a, path_b: the models; a stands at the origin, b moves.
    """
    shapes = [Shape.load(path) for path in (path_a, path_b)]
    boxes = [mesh.bounds(path) for path in (path_a, path_b)]
    middles, halves = ([0.5 * (high + sign * low) for low, high in boxes] for sign in (1.0, -1.0))
    reach = sum(float(np.linalg.norm(half)) for half in halves)
    rows: list[tuple[Floats, Floats, Floats]] = []
    near: list[tuple[Floats, Floats]] = []
    for i in range(count):
        quaternions = random.normal(size=(2, 4))
        quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        aim = rotate_all(quaternions[:1], (random.uniform(-0.9, 0.9, 3) * halves[0])[None])[0]
        ahead = np.sqrt((reach + AHEAD) ** 2 - aim @ aim + (aim @ direction) ** 2) - aim @ direction

        def place(left: Floats, quaternions: Floats = quaternions, direction: Floats = direction,
                  aim: Floats = aim) -> tuple[Floats, Floats]:
            """Poses of both models with `left` m to go to the aim."""
            poses = np.empty((2, len(left), 7))
            poses[:, :, 3:] = quaternions[:, None]
            for side in range(2):
                poses[side, :, :3] = -rotate_all(quaternions[side:side + 1], middles[side][None])
            poses[1, :, :3] += aim + left[:, None] * direction
            return poses[0], poses[1]

        left = np.arange(ahead, -ahead, -STEP)
        hit = np.asarray(intersects(shapes[0], place(left)[0], shapes[1], place(left)[1]))
        last = int(np.argmax(hit)) if hit.any() else len(left) - 1
        rows.append((i * PAUSE - left[:last + 1], *place(left[:last + 1])))
        if hit.any():
            before, after = left[last - 1], left[last]
            for _ in range(20):
                middle = 0.5 * (before + after)
                a, b = place(np.array([middle]))
                if intersects(shapes[0], a, shapes[1], b)[0]:
                    after = middle
                else:
                    before = middle
            distance = APART[0] * (APART[1] / APART[0]) ** random.uniform(size=EACH)
            near.append(place(np.concatenate([after - random.uniform(*DEEP, EACH), before + distance])))
    times, poses_a, poses_b = (np.concatenate(column) for column in zip(*rows, strict=True))
    near_a, near_b = (np.concatenate(column) for column in zip(*near, strict=True))
    never: Floats = PAUSE * np.arange(len(near_a), dtype=np.float64)  # no pose is the successor of another
    return (Encounter(path_a, path_b, times, poses_a, poses_b),
            Encounter(path_a, path_b, never, near_a, near_b))
