"""Random poses near touch: one model comes at another along random lines, until the surfaces meet or it is past."""

from pathlib import Path

import numpy as np

from bench.accuracy.collision.flights import Encounter
from drone_engine.arrays import Floats
from drone_engine.collision import Shape, intersects
from drone_engine.geometry import mesh
from drone_engine.math.poses import rotate_all

STEP = 0.01  # m from one row of a line to the next
AHEAD = 0.1  # m between the bounding spheres where a line starts
PAUSE = 1000.0  # s from the aim of one line to the next one's, more than any line takes
DEEP = (0.0005, 0.01)  # m past the touch
APART = (0.001, 1.0)  # m before the touch, as many in each decade
EACH = 4  # poses of either kind on a line that touches


def lines(path_a: Path, path_b: Path, count: int, random: np.random.Generator) -> tuple[Encounter, Encounter]:
    """`count` lines, one after the other, at 1 m/s: every row of them; and poses near their touches alone."""
    shapes = [Shape.load(path) for path in (path_a, path_b)]
    boxes = [mesh.bounds(path) for path in (path_a, path_b)]
    middles, halves = ([0.5 * (high + sign * low) for low, high in boxes] for sign in (1.0, -1.0))
    reach = sum(float(np.linalg.norm(half)) for half in halves)
    rows: list[tuple[Floats, Floats, Floats]] = []
    near: list[tuple[Floats, Floats]] = []
    for i in range(count):
        turns = random.normal(size=(2, 4))
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        way = random.normal(size=3)
        way /= np.linalg.norm(way)
        aim = rotate_all(turns[:1], (random.uniform(-0.9, 0.9, 3) * halves[0])[None])[0]
        ahead = np.sqrt((reach + AHEAD) ** 2 - aim @ aim + (aim @ way) ** 2) - aim @ way

        def place(left: Floats, turns: Floats = turns, way: Floats = way, aim: Floats = aim) -> tuple[Floats, Floats]:
            """Poses of both where `left` m are left to the aim."""
            poses = np.empty((2, len(left), 7))
            poses[:, :, 3:] = turns[:, None]
            for side in range(2):
                poses[side, :, :3] = -rotate_all(turns[side:side + 1], middles[side][None])
            poses[1, :, :3] += aim + left[:, None] * way
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
            apart = APART[0] * (APART[1] / APART[0]) ** random.uniform(size=EACH)
            near.append(place(np.concatenate([after - random.uniform(*DEEP, EACH), before + apart])))
    times, poses_a, poses_b = (np.concatenate(column) for column in zip(*rows, strict=True))
    near_a, near_b = (np.concatenate(column) for column in zip(*near, strict=True))
    never: Floats = PAUSE * np.arange(len(near_a), dtype=np.float64)  # no row follows another
    return (Encounter(path_a, path_b, times, poses_a, poses_b),
            Encounter(path_a, path_b, never, near_a, near_b))
