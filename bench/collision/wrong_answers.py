"""Wrong answers of our tests and of other libraries on hard pairs, counted by exact arithmetic."""

import zlib
from collections.abc import Iterator

import numpy as np

from bench.collision import libraries
from bench.collision.inputs import Boxes
from bench.report.results import Row
from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.box import obb
from drone_engine.collision.triangle import intersection as triangle
from reference import box_families, box_oracle, textbook, triangle_families, triangle_oracle


def aligned(rng: np.random.Generator, n: int) -> tuple[Floats, ...]:
    """Axis-aligned boxes of decimal sizes, face to face: rounding alone decides between touch, gap and overlap."""
    half_a, half_b = np.asarray(rng.integers(1, 9, (2, n, 3)) * 0.1, np.float64)
    center_a = np.asarray(rng.integers(-20, 21, (n, 3)) * 0.1, np.float64)
    along = np.eye(3, dtype=bool)[rng.integers(0, 3, n)]
    side = rng.choice([-1.0, 1.0], (n, 3))
    share = np.where(along, side, rng.uniform(-0.9, 0.9, (n, 3)))
    axes = np.broadcast_to(np.eye(3), (n, 3, 3)).copy()
    return center_a, axes, half_a, center_a + share * (half_a + half_b), axes, half_b


# Without the families that coal and FCL do not support: axes that are no rotation, numbers beyond their range.
BOXES = {"aligned": aligned, **{name: box_families.FAMILIES[name] for name in
                                ("near_contact", "parallel", "thin", "ratios", "moved")}}
TRIANGLES = tuple(name for name in triangle_families.FAMILIES if name != "tiny_and_huge")


def rotated(a: Boxes, b: Boxes) -> tuple[Boxes, Boxes]:
    """The pairs whose axes are orthonormal up to rounding.

    Left-handed axes are replaced by right-handed axes of the same box.
    """
    good = np.ones(len(a.center), bool)
    for axes in (a.axes, b.axes):
        good &= np.abs(axes @ axes.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2)) < 1e-14
    sides = []
    for box in (a, b):
        axes = box.axes[good].copy()
        axes[np.linalg.det(axes) < 0, 0] *= -1.0
        sides.append(Boxes(box.center[good], axes, box.half[good]))
    return sides[0], sides[1]


def rows(count: int) -> Iterator[Row]:
    """One row per family with about `count` pairs: wrong answers per 1000."""
    for name, make in BOXES.items():
        rng = np.random.default_rng(zlib.crc32(name.encode()))
        numbers = make(rng, count)
        a, b = rotated(Boxes(*numbers[:3]), Boxes(*numbers[3:]))
        if len(a.center) < count // 10:
            raise SystemExit(f"family {name}: only {len(a.center)} of {count} pairs have axes that are a rotation")
        truth = box_oracle.all_boxes_touch(*a, *b)
        answers = {peer: libraries.hits(run) for peer, run in libraries.boxes(a, b).items()}
        answers["plain SAT"] = textbook.boxes(*a, *b)
        answers["SAT with 1e-6"] = textbook.boxes(*a, *b, epsilon=1e-6)
        yield _row(f"boxes, {name.replace('_', ' ')}", truth, obb.intersects(*a, *b), answers)
    for name in TRIANGLES:
        first, second = triangle_families.FAMILIES[name](np.random.default_rng(zlib.crc32(name.encode())), count)
        answers = {peer: libraries.hits(run) for peer, run in libraries.triangles(first, second).items()}
        answers["plain SAT"] = textbook.triangles(first, second)
        yield _row(f"triangles, {name.replace('_', ' ')}", _triangles_intersect(first, second),
                   triangle.intersects(first, second), answers)


def _triangles_intersect(a: Floats, b: Floats) -> Booleans:
    """Exact answers for triangles (n, 3, 3)."""
    return np.array([triangle_oracle.intersects(x, y) for x, y in zip(a.tolist(), b.tolist(), strict=True)])


def _row(work: str, truth: Booleans, ours: Booleans, answers: dict[str, Booleans]) -> Row:
    wrong = {libraries.NAMES.get(name, name): 1000.0 * float(np.mean(answer != truth))
             for name, answer in {"ours": ours, **answers}.items()}
    ours_wrong = wrong.pop("ours")
    return Row(f"wrong answers: {work}, {len(truth)} pairs", "of 1000", ours_wrong, "0", ours_wrong == 0.0, peers=wrong)
