"""What each level of collision says of recorded poses, held against the exact answer of the triangles."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path

import numpy as np

from bench.accuracy.collision.deepest_contact import deepest
from bench.accuracy.collision.flights import Encounter
from bench.accuracy.collision.mesh_distance import gap
from drone_engine.arrays import Booleans, Floats
from drone_engine.collision import TRIANGLE, Shape, intersects
from drone_engine.collision_level import TESTED

LEVELS = range(len(TESTED))  # sphere, obb, octree, triangle
QUIET = 1.0  # s without a hit before the next one counts as a new alarm
HALVINGS = 12  # of the time between two rows, to find when an alarm began
REPEATS = 5  # of each timing, of which the median counts
QUERIES = 1000  # yes or no at least in one timing
CONTACTS = 200  # poses whose contacts are found at least in one timing


@dataclass
class Tally:
    """Sums and samples of some poses, by level."""

    poses: int = 0
    hits: list[int] = field(default_factory=lambda: [0] * len(LEVELS))
    false: list[int] = field(default_factory=lambda: [0] * len(LEVELS))  # the level says hit, the surfaces do not meet
    missed: list[int] = field(default_factory=lambda: [0] * len(LEVELS))  # the next finer level says hit, this one no
    silent: list[int] = field(default_factory=lambda: [0] * len(LEVELS))  # surfaces meet, a solver gets none
    gaps: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])  # m apart when an alarm begins
    depth: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])  # m, error of the deepest contact's
    normal: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])  # degrees, error of its normal
    question: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])  # us of CPU, a query's yes or no
    answer: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])  # us of CPU, a solver's contacts

    def add(self, other: "Tally") -> None:
        """Takes over what another one has counted."""
        self.poses += other.poses
        for counts in ("hits", "false", "missed", "silent"):
            setattr(self, counts, [a + b for a, b in zip(getattr(self, counts), getattr(other, counts), strict=True)])
        for samples in ("gaps", "depth", "normal", "question", "answer"):
            for mine, more in zip(getattr(self, samples), getattr(other, samples), strict=True):
                mine += more


@cache
def shape(path: Path) -> Shape:
    return Shape.load(path)


def judge(tally: Tally, moving: Encounter, poses: Encounter) -> None:
    """Adds the alarms of bodies that move, and all else of poses."""
    hits = answers(poses)
    measure_alarms(tally, moving, hits if moving is poses else answers(moving))
    count(tally, hits)
    compare_contacts(tally, poses, hits)
    time_questions(tally, poses)


def count(tally: Tally, hits: Booleans) -> None:
    """Adds the answers (levels, n) to the tally; the finest level's are the truth."""
    tally.poses += hits.shape[1]
    for level in LEVELS:
        tally.hits[level] += int(hits[level].sum())
        tally.false[level] += int((hits[level] & ~hits[-1]).sum())
        finer = hits[min(level + 1, TRIANGLE)]
        tally.missed[level] += int((finer & ~hits[level]).sum())


def answers(e: Encounter) -> Booleans:
    """What each level says of each row: (levels, n)."""
    a, b = shape(e.path_a), shape(e.path_b)
    return np.array([intersects(a, e.poses_a, b, e.poses_b, level) for level in LEVELS])


def alarms(times: Floats, hit: Booleans) -> list[tuple[int, bool]]:
    """The rows at which a hit begins, after QUIET s without one, and whether the row before is of the moment before."""
    step = np.diff(times).min(initial=np.inf) if len(times) > 1 else np.inf
    found, last = [], -np.inf
    for row in np.flatnonzero(hit):
        if times[row] - last > QUIET:
            found.append((int(row), bool(row > 0 and times[row] - times[row - 1] < 1.5 * step)))
        last = times[row]
    return found


def measure_alarms(tally: Tally, e: Encounter, hits: Booleans) -> None:
    """Adds how far the surfaces are apart when each level begins to say hit."""
    a, b = shape(e.path_a), shape(e.path_b)
    for level in LEVELS:
        for row, follows in alarms(e.time, hits[level]):
            poses = np.stack([e.poses_a[[row - 1, row]], e.poses_b[[row - 1, row]]]) if follows else None
            at = e.poses_a[row], e.poses_b[row]
            if poses is not None:
                free, met = 0.0, 1.0
                for _ in range(HALVINGS):
                    middle = 0.5 * (free + met)
                    between = _between(poses, middle)
                    if intersects(a, between[0], b, between[1], level):
                        met, at = middle, between
                    else:
                        free = middle
            meets = intersects(a, at[0], b, at[1])
            tally.gaps[level].append(0.0 if meets else gap(a.tree, at[0], b.tree, at[1]))


def _between(poses: Floats, part: float) -> tuple[Floats, Floats]:
    """Poses of two bodies between two rows (2, 2, 7), as unit quaternions on the shorter way."""
    same = np.where((poses[:, 0, 3:] * poses[:, 1, 3:]).sum(-1, keepdims=True) < 0.0, -1.0, 1.0)
    mixed = (1.0 - part) * poses[:, 0] + part * poses[:, 1]
    mixed[:, 3:] = (1.0 - part) * poses[:, 0, 3:] + part * same * poses[:, 1, 3:]
    mixed[:, 3:] /= np.linalg.norm(mixed[:, 3:], axis=1, keepdims=True)
    return mixed[0], mixed[1]


def compare_contacts(tally: Tally, e: Encounter, hits: Booleans) -> None:
    """Adds the errors of each level's deepest contact where the surfaces meet, and what the contacts cost."""
    rows = np.flatnonzero(hits[TRIANGLE])
    if not len(rows):
        return
    a, b = shape(e.path_a), shape(e.path_b)
    truth, normal = deepest(a, e.poses_a[rows], b, e.poses_b[rows], TRIANGLE)
    many = np.resize(rows, max(CONTACTS, len(rows)))
    poses_a, poses_b = e.poses_a[many], e.poses_b[many]
    for level in LEVELS:
        depth, direction = deepest(a, e.poses_a[rows], b, e.poses_b[rows], level)
        cosine = np.clip((direction * normal).sum(axis=1), -1.0, 1.0)
        both = ~np.isnan(depth) & ~np.isnan(truth)
        tally.silent[level] += int(np.isnan(depth).sum())
        tally.depth[level] += np.abs(depth - truth)[both].tolist()
        tally.normal[level] += np.degrees(np.arccos(cosine))[both].tolist()
        spent = cpu(partial(deepest, a, poses_a, b, poses_b, level)) / len(many)
        tally.answer[level] += [spent] * len(rows)


def time_questions(tally: Tally, e: Encounter) -> None:
    """Adds what yes or no costs, in a batch."""
    a, b = shape(e.path_a), shape(e.path_b)
    many = np.resize(np.arange(len(e.time)), max(QUERIES, len(e.time)))
    poses_a, poses_b = e.poses_a[many], e.poses_b[many]
    for level in LEVELS:
        spent = cpu(partial(intersects, a, poses_a, b, poses_b, level)) / len(many)
        tally.question[level] += [spent] * len(e.time)


def cpu(work: Callable[[], object]) -> float:
    """CPU time in us: the median of REPEATS, after one to warm up."""
    work()
    spent = []
    for _ in range(REPEATS):
        start = time.thread_time_ns()
        work()
        spent.append((time.thread_time_ns() - start) / 1000)
    return float(np.median(spent))
