"""Compares the answers of each collision level at recorded poses with the exact answer of the triangle level."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path

import numpy as np

from bench.accuracy.collision.deepest_contact import deepest_contacts
from bench.accuracy.collision.flights import Encounter
from bench.accuracy.collision.mesh_distance import surface_distance
from drone_engine.arrays import Booleans, Floats
from drone_engine.collision import TRIANGLE, Shape, intersects
from drone_engine.collision_level import TESTED

LEVELS = range(len(TESTED))  # sphere, obb, octree, triangle
QUIET_TIME = 1.0  # s without a hit before the next hit counts as a first hit
HALVINGS = 12  # bisections of the step that contains a first hit
REPEATS = 5  # runs of each timing, of which the median counts
QUERIES = 1000  # intersection tests per timing, at least
CONTACTS = 200  # poses with contacts per timing, at least


@dataclass
class Tally:
    """Counts and samples over poses; each list has an entry per level.

    hits: answers yes; false: yes, but the surfaces do not intersect; missed: no, but the next finer level says yes;
    without_contact: surfaces intersect, but the level gives no contact; gaps: distance of the surfaces in m at the
    first hit; depth, normal: errors of the deepest contact, m and degrees; test_us, contacts_us: CPU time in us of an
    intersection test and of the contacts.
    """

    poses: int = 0
    hits: list[int] = field(default_factory=lambda: [0] * len(LEVELS))
    false: list[int] = field(default_factory=lambda: [0] * len(LEVELS))
    missed: list[int] = field(default_factory=lambda: [0] * len(LEVELS))
    without_contact: list[int] = field(default_factory=lambda: [0] * len(LEVELS))
    gaps: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])
    depth: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])
    normal: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])
    test_us: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])
    contacts_us: list[list[float]] = field(default_factory=lambda: [[] for _ in LEVELS])

    def add(self, other: "Tally") -> None:
        """Adds the counts and samples of another tally."""
        self.poses += other.poses
        for counts in ("hits", "false", "missed", "without_contact"):
            setattr(self, counts, [a + b for a, b in zip(getattr(self, counts), getattr(other, counts), strict=True)])
        for samples in ("gaps", "depth", "normal", "test_us", "contacts_us"):
            for own, more in zip(getattr(self, samples), getattr(other, samples), strict=True):
                own += more


@cache
def shape(path: Path) -> Shape:
    """The model's collision shape, cached."""
    return Shape.load(path)


def evaluate(tally: Tally, moving: Encounter, poses: Encounter) -> None:
    """Adds the first hits of `moving`, and everything else from `poses`."""
    hits = answers(poses)
    measure_first_hits(tally, moving, hits if moving is poses else answers(moving))
    count(tally, hits)
    compare_contacts(tally, poses, hits)
    time_tests(tally, poses)


def count(tally: Tally, hits: Booleans) -> None:
    """Adds the answers (levels, n) to the tally; those of the finest level are exact."""
    tally.poses += hits.shape[1]
    for level in LEVELS:
        tally.hits[level] += int(hits[level].sum())
        tally.false[level] += int((hits[level] & ~hits[-1]).sum())
        finer = hits[min(level + 1, TRIANGLE)]
        tally.missed[level] += int((finer & ~hits[level]).sum())


def answers(e: Encounter) -> Booleans:
    """Answers of each level at each pose, (levels, n)."""
    a, b = shape(e.path_a), shape(e.path_b)
    return np.array([intersects(a, e.poses_a, b, e.poses_b, level) for level in LEVELS])


def first_hits(times: Floats, hit: Booleans) -> list[tuple[int, bool]]:
    """The rows at which a hit begins after QUIET_TIME without one.

    Each comes with a flag: whether the row before is the pose of the step before.
    """
    step = np.diff(times).min(initial=np.inf) if len(times) > 1 else np.inf
    found, last = [], -np.inf
    for row in np.flatnonzero(hit):
        if times[row] - last > QUIET_TIME:
            found.append((int(row), bool(row > 0 and times[row] - times[row - 1] < 1.5 * step)))
        last = times[row]
    return found


def measure_first_hits(tally: Tally, e: Encounter, hits: Booleans) -> None:
    """Adds the distance of the surfaces at the first hit of each level, found by bisection of the step."""
    a, b = shape(e.path_a), shape(e.path_b)
    for level in LEVELS:
        for row, follows in first_hits(e.time, hits[level]):
            poses = np.stack([e.poses_a[[row - 1, row]], e.poses_b[[row - 1, row]]]) if follows else None
            at = e.poses_a[row], e.poses_b[row]
            if poses is not None:
                free, hit = 0.0, 1.0
                for _ in range(HALVINGS):
                    middle = 0.5 * (free + hit)
                    between = _between(poses, middle)
                    if intersects(a, between[0], b, between[1], level):
                        hit, at = middle, between
                    else:
                        free = middle
            meets = intersects(a, at[0], b, at[1])
            tally.gaps[level].append(0.0 if meets else surface_distance(a.tree, at[0], b.tree, at[1]))


def _between(poses: Floats, part: float) -> tuple[Floats, Floats]:
    """Poses of two bodies interpolated between two rows (2, 2, 7) at `part` from 0 to 1, by the shorter rotation."""
    same = np.where((poses[:, 0, 3:] * poses[:, 1, 3:]).sum(-1, keepdims=True) < 0.0, -1.0, 1.0)
    mixed = (1.0 - part) * poses[:, 0] + part * poses[:, 1]
    mixed[:, 3:] = (1.0 - part) * poses[:, 0, 3:] + part * same * poses[:, 1, 3:]
    mixed[:, 3:] /= np.linalg.norm(mixed[:, 3:], axis=1, keepdims=True)
    return mixed[0], mixed[1]


def compare_contacts(tally: Tally, e: Encounter, hits: Booleans) -> None:
    """Adds the errors of each level's deepest contact where the surfaces intersect, and the CPU time of contacts."""
    rows = np.flatnonzero(hits[TRIANGLE])
    if not len(rows):
        return
    a, b = shape(e.path_a), shape(e.path_b)
    truth, normal = deepest_contacts(a, e.poses_a[rows], b, e.poses_b[rows], TRIANGLE)
    sample = np.resize(rows, max(CONTACTS, len(rows)))
    poses_a, poses_b = e.poses_a[sample], e.poses_b[sample]
    for level in LEVELS:
        depth, direction = deepest_contacts(a, e.poses_a[rows], b, e.poses_b[rows], level)
        cosine = np.clip((direction * normal).sum(axis=1), -1.0, 1.0)
        both = ~np.isnan(depth) & ~np.isnan(truth)
        tally.without_contact[level] += int(np.isnan(depth).sum())
        tally.depth[level] += np.abs(depth - truth)[both].tolist()
        tally.normal[level] += np.degrees(np.arccos(cosine))[both].tolist()
        spent = cpu(partial(deepest_contacts, a, poses_a, b, poses_b, level)) / len(sample)
        tally.contacts_us[level] += [spent] * len(rows)


def time_tests(tally: Tally, e: Encounter) -> None:
    """Adds the CPU time of intersection tests in a batch."""
    a, b = shape(e.path_a), shape(e.path_b)
    sample = np.resize(np.arange(len(e.time)), max(QUERIES, len(e.time)))
    poses_a, poses_b = e.poses_a[sample], e.poses_b[sample]
    for level in LEVELS:
        spent = cpu(partial(intersects, a, poses_a, b, poses_b, level)) / len(sample)
        tally.test_us[level] += [spent] * len(e.time)


def cpu(work: Callable[[], object]) -> float:
    """CPU time in us: median of REPEATS runs after a warm-up."""
    work()
    spent = []
    for _ in range(REPEATS):
        start = time.thread_time_ns()
        work()
        spent.append((time.thread_time_ns() - start) / 1000)
    return float(np.median(spent))
