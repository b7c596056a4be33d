"""Speed of the collision detection beside coal and FCL, on the same pairs in the same run, on one thread.

Pairs of boxes and of meshes near touch, half of which intersect; frames of the broad phase; wrong answers on hard
pairs. The answers are compared, and differences are printed. Shapes, trees and transforms are prepared before the
timing for all libraries. Our functions take a batch per call; the Python interfaces of the others take one pair.
"""

import argparse
from collections.abc import Callable, Iterator
from importlib.metadata import version
from itertools import cycle
from typing import NamedTuple

import numpy as np

from bench.collision import boxes_without_bounds, inputs, libraries, wrong_answers
from bench.collision.inputs import Boxes, Mesh
from bench.report.clock import Times, side_by_side
from bench.report.results import Row, report
from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box import obb
from drone_engine.collision.broad_phase.grid import Grid
from drone_engine.collision.mesh import octree, traversal

SHOWN = 3  # different answers that are printed in full
FRAMES = {1000: 0.2, 10_000: 3.0, 100_000: 40.0}  # number of boxes: target in ms


class Size(NamedTuple):
    """Amount of work: rounds of timing, pairs of boxes and of meshes, sizes of the frames, pairs per hard family."""

    rounds: int
    boxes: int
    meshes: int
    frames: tuple[int, ...]
    hard: int


FULL = Size(rounds=9, boxes=100_000, meshes=400, frames=tuple(FRAMES), hard=1000)
QUICK = Size(rounds=3, boxes=20_000, meshes=100, frames=(1000, 10_000), hard=200)


def rates(work: str, count: int, times: dict[str, Times], asked: float | None) -> Row:
    """A row with pairs per second; without a target `asked`, the target is twice the faster of the other libraries."""
    wall, cpu, best = ({name: count / seconds for name, seconds in zip(times, column, strict=True)}
                       for column in zip(*times.values(), strict=True))
    ours = wall.pop("ours")
    fastest = max(wall.values())
    goal, text = (asked, f"{asked / 1e6:g} M") if asked else (2.0 * fastest, "2 x the faster")
    return Row(work, "1/s", ours, text, ours >= goal, {libraries.NAMES[name]: value for name, value in wall.items()},
               ours / fastest, cpu, best)


def agree(work: str, ours: Booleans, others: dict[str, Booleans], describe: Callable[[int], str]) -> None:
    """Prints the number of answers that differ from ours and the first of these pairs; describe(k): pair k as text."""
    for name, answers in others.items():
        differ = np.flatnonzero(ours != answers)
        print(f"{work}: {ours.sum()} of {len(ours)} touch; {libraries.NAMES[name]} differs in {len(differ)}",
              flush=True)
        for k in differ[:SHOWN]:
            print(f"  pair {k}: ours {bool(ours[k])}; {describe(int(k))}")


def boxes(size: Size) -> Iterator[Row]:
    """Pairs of boxes: intersection test, cost of its error bounds, and contact manifolds."""
    a, b = inputs.boxes_near_touch(np.random.default_rng(1), size.boxes)
    others = libraries.boxes(a, b)
    ours = obb.intersects(*a, *b)

    def describe(k: int) -> str:
        return " and ".join(", ".join(f"{part} {getattr(box, part)[k].tolist()}" for part in Boxes._fields)
                            for box in (a, b))

    agree("boxes, intersection test", ours, {name: libraries.hits(run) for name, run in others.items()}, describe)
    times = side_by_side({"ours": lambda: obb.intersects(*a, *b), **others}, size.rounds)
    yield rates("boxes, intersection test", size.boxes, times, 40e6)

    if not np.array_equal(boxes_without_bounds.intersects(*a, *b), ours):
        raise SystemExit("the box kernel without error bounds gives different answers on ordinary pairs")
    times = side_by_side({"ours": lambda: obb.intersects(*a, *b),
                          "without": lambda: boxes_without_bounds.intersects(*a, *b)}, 5 * size.rounds)
    cost = 100.0 * (times["ours"].best / times["without"].best - 1.0)
    yield Row("boxes, cost of exactness: relative to the kernel without error bounds, best rounds", "%", cost,
              "under 5", cost < 5.0)

    others = libraries.boxes(a, b, max_contacts=8)
    found = obb.contacts(*a, *b)
    touching = np.zeros(size.boxes, bool)
    touching[found.number] = np.diff(found.first) > 0
    agree("boxes, manifold", touching, {name: libraries.hits(run) for name, run in others.items()}, describe)
    if not np.array_equal(touching, ours):
        raise SystemExit("obb.contacts and obb.intersects disagree")
    times = side_by_side({"ours": lambda: obb.contacts(*a, *b), **others}, size.rounds)
    each = len(found.point) / len(found.number)
    yield rates(f"boxes, normal, depth and manifold ({each:.1f} points per hit)", size.boxes, times, 10e6)


def poses_near_touch(rng: np.random.Generator, tree: octree.Octree, reach: float, n: int) -> tuple[Floats, Floats]:
    """Poses (n, 7) of two copies of a mesh near touch, in random orientations.

    b lies in a random direction from a, at 0.97 to 1.03 times the distance of first touch when it approaches from
    outside. reach: radius of the mesh, m.
    """
    a, b = np.zeros((2, n, 7))
    a[:, 3:], b[:, 3:] = inputs.quaternions(rng, n), inputs.quaternions(rng, n)
    direction = rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    outside, step = np.full(n, 2.0 * reach), reach / 30.0
    separate = np.ones(n, bool)
    while separate.any():
        b[:, :3] = direction * (outside - step)[:, None]
        separate &= ~traversal.intersects(tree, a, tree, b)
        outside[separate] -= step
        if outside.min() < 0.0:
            raise SystemExit("two copies of a mesh never touch")
    inside = outside - step
    for _ in range(24):
        middle = (inside + outside) / 2
        b[:, :3] = direction * middle[:, None]
        hit = traversal.intersects(tree, a, tree, b)
        inside, outside = np.where(hit, middle, inside), np.where(hit, outside, middle)
    b[:, :3] = direction * (outside * rng.uniform(0.97, 1.03, n))[:, None]
    return a, b


def meshes(size: Size) -> Iterator[Row]:
    """A mesh against a copy of itself: intersection test, and all pairs of intersecting triangles."""
    for name, mesh in inputs.meshes().items():
        tree = octree.build(*mesh)
        reach = float(np.linalg.norm(mesh.vertices, axis=1).max())
        a, b = poses_near_touch(np.random.default_rng(11), tree, reach, size.meshes)
        yield from _mesh(f"{name} of {len(mesh.faces)} triangles", mesh, tree, a, b, size.rounds)


def _mesh(what: str, mesh: Mesh, tree: octree.Octree, a: Floats, b: Floats, rounds: int) -> Iterator[Row]:
    """Rows for one mesh at the poses a and b, (n, 7)."""
    def describe(k: int) -> str:
        return f"poses {a[k].tolist()} and {b[k].tolist()}"

    others = libraries.meshes(mesh, a, b)
    ours = traversal.intersects(tree, a, tree, b)
    agree(f"{what}, intersection test", ours, {name: libraries.hits(run) for name, run in others.items()}, describe)
    times = side_by_side({"ours": lambda: traversal.intersects(tree, a, tree, b), **others}, rounds)
    yield rates(f"{what}, intersection test", len(a), times, None)

    others = libraries.meshes(mesh, a, b, libraries.UNLIMITED)
    count = np.diff(traversal.pairs(tree, a, tree, b)[0])
    for name, run in others.items():
        differ = np.flatnonzero(run() != count)
        print(f"{what}, all contacts: {count.sum()} pairs of triangles; {libraries.NAMES[name]} differs in "
              f"{len(differ)} of {len(a)} pairs of meshes", flush=True)
    if not np.array_equal(count > 0, ours):
        raise SystemExit("traversal.pairs and traversal.intersects disagree")
    times = side_by_side({"ours": lambda: traversal.contacts(tree, a, tree, b), **others}, rounds)
    yield rates(f"{what}, all contacts ({count[count > 0].mean():.0f} per hit)", len(a), times, None)


def frames(size: Size) -> Iterator[Row]:
    """Broad phase: all pairs of n boxes, sorted; every box moves between two frames."""
    for n in size.frames:
        yield _frame(n, size.rounds)


def _frame(n: int, rounds: int) -> Row:
    """The row for one frame of n boxes."""
    scene = inputs.frame(n)
    grid, all_boxes = Grid((scene.high - scene.low) / 2), np.ones(n, bool)
    states = cycle([(scene.low_next, scene.high_next), (scene.low, scene.high)])

    def ours() -> tuple[Integers, Integers]:
        return grid.pairs(*next(states), all_boxes, all_boxes)

    others = libraries.frames(scene)
    found = len(ours()[0])
    if found != _brute_force(scene.low_next, scene.high_next):
        raise SystemExit(f"the grid finds {found} pairs of {n} boxes, brute force finds another number")
    for name, run in others.items():
        print(f"frame of {n} boxes: {found} pairs; {libraries.NAMES[name]} finds {run()}", flush=True)
    times = side_by_side({"ours": ours, **others}, rounds)
    wall, cpu, best = ({name: 1e3 * seconds for name, seconds in zip(times, column, strict=True)}
                       for column in zip(*times.values(), strict=True))
    mine = wall.pop("ours")
    return Row(f"broad phase, frame of {n} boxes, {found / n:.1f} pairs each", "ms", mine, f"under {FRAMES[n]:g} ms",
               mine < FRAMES[n], {libraries.NAMES[name]: value for name, value in wall.items()},
               min(wall.values()) / mine, cpu, best)


def _brute_force(low: Floats, high: Floats) -> int:
    """Number of overlapping pairs of AABBs (n, 3): tests each box against those that begin before it ends along x."""
    order = np.argsort(low[:, 0])
    low, high = low[order], high[order]
    ends = np.searchsorted(low[:, 0], high[:, 0], side="right")
    return sum(int(((low[i + 1 : end, 1:] <= high[i, 1:]) & (low[i, 1:] <= high[i + 1 : end, 1:])).all(axis=1).sum())
               for i, end in enumerate(ends))


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="fewer pairs and rounds, under a minute")
    size = QUICK if parser.parse_args().quick else FULL
    rows: list[Row] = []
    for part in (boxes(size), meshes(size), frames(size), wrong_answers.rows(size.hard)):
        for row in part:
            rows.append(row)
            peers = ", ".join(f"{name} {value:.4g}" for name, value in row.peers.items())
            print(f"{row.work}: {row.ours:.4g} {row.unit}; {peers}", flush=True)
    versions = {name: version(name) for name in ("numpy", "numba", "coal", "python-fcl")}
    report("collision", {**size._asdict(), "numbers": "medians over rounds, libraries in alternation", "threads": 1,
                         "made before": "shapes, trees, transforms; kernels compiled", **versions}, rows)


if __name__ == "__main__":
    main()
