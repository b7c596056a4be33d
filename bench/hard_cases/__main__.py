"""Hard cases in large numbers: wrong answers of the collision tests, and outcomes of the cases of motion.

Exact arithmetic on the same float64 numbers judges each answer, and each pair is tested twice, with its sides swapped.
The other libraries get fewer pairs of the same families, without those that they do not support.
"""

import argparse
import sys
import zlib
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import count as count_from
from itertools import starmap

import numpy as np
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from bench import ROOT
from bench.collision import wrong_answers
from bench.hard_cases import motion
from bench.report.results import Row, report
from drone_engine.arrays import Booleans
from drone_engine.collision import Shape, intersects
from drone_engine.collision.box import obb
from drone_engine.collision.broad_phase.grid import Grid
from drone_engine.collision.triangle import intersection as triangle
from drone_engine.collision_level import OBB, OCTREE, SPHERE, TRIANGLE
from reference import box_families, box_oracle, plate_shots, triangle_families, triangle_oracle
from reference import broad_phase as bounds

CHUNK = 2_000  # pairs per job of a process
# Part of the count per family: all for the most common cases in flight, less for families with slow exact arithmetic, a
# tenth for all others, so that the triangle families together get about the full count.
SHARE = {"near_contact": 1.0, "parallel": 1.0, "exponents": 0.01, "tiny_and_huge": 0.01}
OTHER_SHARE = 0.1
LEVELS = (SPHERE, OBB, OCTREE, TRIANGLE)
MODELS = ROOT / "assets/models"
SHOTS = 10_000  # per collision level
OTHERS = 500  # the other libraries get this factor fewer pairs


def boxes(family: str, chunk: int, count: int) -> tuple[int, int]:
    """Number of tested pairs of a family, and of wrong answers."""
    a, b = np.split(np.arange(6), 2)
    numbers = box_families.FAMILIES[family](_random(family, chunk), count)
    truth = box_oracle.all_boxes_touch(*numbers)
    swapped = [numbers[i] for i in (*b, *a)]
    return len(truth), _wrong(truth, obb.intersects(*numbers), obb.intersects(*swapped))


def triangles(family: str, chunk: int, count: int) -> tuple[int, int]:
    """Number of tested pairs of a family, and of wrong answers; the second test also permutes the corners."""
    a, b = triangle_families.FAMILIES[family](_random(family, chunk), count)
    truth = np.array(list(starmap(triangle_oracle.intersects, zip(a.tolist(), b.tolist(), strict=True))))
    return len(truth), _wrong(truth, triangle.intersects(a, b),
                              triangle.intersects(np.roll(b, 1, axis=1).copy(), a[:, ::-1].copy()))


def _random(family: str, chunk: int) -> np.random.Generator:
    return np.random.default_rng([zlib.crc32(family.encode()), chunk])


def _wrong(truth: Booleans, *answers: Booleans) -> int:
    """Number of pairs for which at least one answer is wrong."""
    return int(np.any([answer != truth for answer in answers], axis=0).sum())


def nested(count: int) -> tuple[int, int]:
    """Number of tested poses, and of inconsistent answers, for poses of two models near touch.

    Answers are inconsistent if a level reports a hit and a coarser level does not, or if swapping the models changes an
    answer.
    """
    rng, wrong = np.random.default_rng(7), 0
    models = [Shape.load(MODELS / f"{name}.obj") for name in ("drone", "television", "ring", "rock_tall")]
    for start in range(0, count, CHUNK):
        n = min(CHUNK, count - start)
        a, b = (models[i] for i in rng.integers(0, len(models), 2))
        poses = rng.normal(size=(2, n, 7))
        poses[:, :, 3:] /= np.linalg.norm(poses[:, :, 3:], axis=-1, keepdims=True)
        poses[:, :, :3] *= 0.5 * np.sqrt(a.reach * b.reach)
        poses[:, :, :3] += rng.choice([0.0, 1e6], (n, 1))
        hits = np.array([intersects(a, poses[0], b, poses[1], level) for level in LEVELS])
        swapped = np.array([intersects(b, poses[1], a, poses[0], level) for level in LEVELS])
        wrong += int(((hits[1:] & ~hits[:-1]).any(axis=0) | (hits != swapped).any(axis=0)).sum())
    return count, wrong


def broad_phase(count: int) -> tuple[int, int]:
    """Number of pairs by brute force for bounds of all sizes, and of pairs that the grid misses or adds."""
    pairs = wrong = 0
    for seed in count_from(0):
        low, high = bounds.random_boxes(seed, 3000, (1e-3, 1e3))
        expected = bounds.brute_force(low, high, np.ones(len(low), bool))
        first, second = Grid((high - low) / 2).pairs(low, high, np.ones(len(low), bool), np.ones(len(low), bool))
        found = np.stack([first, second], axis=1)
        pairs += len(expected)
        wrong += len(set(map(tuple, expected.tolist())) ^ set(map(tuple, found.tolist())))
        if pairs >= count:
            return pairs, wrong
    raise AssertionError


def _share(kind: str, family: str) -> float:
    """Part of the count that a family gets."""
    share = SHARE.get(family, OTHER_SHARE)
    return min(share, OTHER_SHARE) if kind == "triangles" else share


KINDS: dict[str, tuple[Callable[[str, int, int], tuple[int, int]], tuple[str, ...]]] = {
    "boxes": (boxes, tuple(box_families.FAMILIES)), "triangles": (triangles, tuple(triangle_families.FAMILIES))}


def rows(count: int) -> Iterator[Row]:
    """One row per family: wrong answers among `count` pairs, each tested twice."""
    columns = TextColumn("{task.description:36}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with ProcessPoolExecutor() as pool, Progress(*columns) as progress:
        for kind, (judge, families) in KINDS.items():
            for family in families:
                pairs = max(round(count * _share(kind, family)), 1)
                sizes = [min(CHUNK, pairs - start) for start in range(0, pairs, CHUNK)]
                bar = progress.add_task(f"{kind}, {family.replace('_', ' ')}", total=pairs)
                tried = wrong = 0
                for more, more_wrong in pool.map(judge, [family] * len(sizes), range(len(sizes)), sizes):
                    tried, wrong = tried + more, wrong + more_wrong
                    progress.update(bar, completed=tried)
                yield Row(f"{kind}, {family.replace('_', ' ')}, {tried} pairs", "wrong", wrong, "0", wrong == 0)
        for work, pairs, run_all in (("levels nested", count, nested), ("broad phase", count, broad_phase)):
            bar = progress.add_task(work, total=pairs)
            tried, wrong = run_all(pairs)
            progress.update(bar, completed=pairs)
            yield Row(f"{work}, {tried} pairs", "wrong", wrong, "0", wrong == 0)
        for name, level in (("sphere", SPHERE), ("obb", OBB), ("octree", OCTREE), ("triangle", TRIANGLE)):
            bar = progress.add_task(f"shots at a plate, {name}", total=SHOTS)
            through = plate_shots.shots_through(SHOTS, level)
            progress.update(bar, completed=SHOTS)
            yield Row(f"5 cm cube at a 1 cm plate, 1 to 1000 m/s, level {name}, {SHOTS} shots", "through", through,
                      "0", through == 0)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--count", type=int, default=1_000_000, help="pairs of a common family (default: %(default)s)")
    parser.add_argument("--only", choices=("collision", "motion"), help="run only one of the two parts")
    options = parser.parse_args()
    moved: list[Row] = []
    if options.only != "collision":
        moved = list(motion.rows())
        report("hard_cases_motion",
               {"cases": "reference/motion/cases.py", "asked": "the number that must not be exceeded"}, moved)
    if options.only == "motion":
        sys.exit(any(row.failed for row in moved))
    found = list(rows(options.count))
    others = list(wrong_answers.rows(max(options.count // OTHERS, 100)))
    report("hard_cases", {"pairs of a common family": options.count, "judge": "rational arithmetic, closed sets",
                          "asked": "twice, with the sides swapped", "seeds": "crc32 of the family's name, chunk"},
           found + others)
    sys.exit(any(row.failed for row in moved + found))


if __name__ == "__main__":
    main()
