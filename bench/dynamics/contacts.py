"""Benchmark rows with contacts: speed and quality of the heap of boxes, all engines in alternation."""

import statistics
from collections.abc import Iterator, Mapping, Sequence
from time import process_time
from typing import NamedTuple

import numpy as np

from bench.dynamics.engines import BoxScene, Engine, MuJoCo, Ours, PyBullet
from bench.dynamics.heap import FRICTION, ITERATIONS, RATE, SUBSTEPS, heap
from bench.report.results import Row
from reference.box_world import Setting

FALL, SETTLE, REST = 240, 470, 240  # steps: timed fall, from there to rest, measured at rest
NEWTON_STEPS = 2  # timed with MuJoCo's Newton solver and 1,024 boxes in contact, which needs seconds per step
MANY = 1000  # boxes from which on MuJoCo settles with CG instead of Newton
BLOCK = 0.4  # s of CPU time for each round at rest
# Steps per second of Box3D 0.1 (C, float32, SIMD; one thread, no sleeping), with 4 sub-steps and with 1, falling and
# resting, and those of MuJoCo on the same machine. The ratio of MuJoCo's rates scales Box3D's to this machine.
BOX3D = {4: ((113e3, 107e3), (226e3, 232e3)), 64: ((9.7e3, 8.0e3), (15e3, 15e3)),
         1024: ((415.0, 340.0), (720.0, 840.0))}
BOX3D_ASLEEP = 215e3
MUJOCO_THERE = {4: (111e3, 56e3), 64: (5.1e3, 1.7e3), 1024: (148.0, 32.0)}
TARGET = {4: (200e3, 150e3), 64: (12e3, 10e3), 1024: (500.0, 400.0)}
TARGET_ASLEEP = 300e3


class Size(NamedTuple):
    """Amount of work: rounds of timing, numbers of movable boxes.

    newton: whether MuJoCo's Newton solver is timed with a thousand boxes in contact; later: further steps of settling
    before penetration, energy and speed at rest are measured.
    """

    rounds: int
    heaps: tuple[int, ...]
    newton: bool
    later: int


FULL = Size(5, (4, 64, 1024), True, 1440)
QUICK = Size(2, (4, 64), False, 480)


class Rates(NamedTuple):
    """Steps per second of CPU time: median over the rounds, and the best round."""

    median: float
    best: float

    @classmethod
    def of(cls, times: Sequence[float]) -> "Rates":
        """From times per step in s."""
        return cls(1.0 / statistics.median(times), 1.0 / min(times))


def heap_rows(movable: int, size: Size) -> Iterator[Row]:
    """Rows of a heap of `movable` boxes: falling, resting, and the quality at rest."""
    boxes = BoxScene(heap(movable), 0.0, FRICTION)
    engines: list[Engine] = [Ours(boxes, Setting(RATE, SUBSTEPS, iterations=ITERATIONS)), MuJoCo(boxes, RATE),
                             MuJoCo(boxes, RATE, "CG"), PyBullet(boxes, RATE)]
    work = f"150 static and {movable:,} movable boxes"
    start = engines[0].energy()
    falling = fall(engines, size.rounds)
    check(engines, start)
    for engine in engines:
        settle(engine, SETTLE, movable)
    resting = rest([engine for engine in engines if movable < MANY or not engine.name.endswith("NEWTON")], size.rounds)
    if movable >= MANY and size.newton:
        resting |= rest([engine for engine in engines if engine.name.endswith("NEWTON")], 1, NEWTON_STEPS)
    reference = "MuJoCo CG" if movable >= MANY else "MuJoCo NEWTON"
    for i, (name, rates) in enumerate((("falling", falling), ("resting, none asleep", resting))):
        scale = rates[reference].median / MUJOCO_THERE[movable][i]
        published = {"Box3D, 4 sub-steps, given": BOX3D[movable][0][i] * scale,
                 "Box3D, 1 sub-step, given": BOX3D[movable][1][i] * scale}
        yield speed(f"{work}, {name}", rates, published, TARGET[movable][i])
    if movable >= MANY:  # Newton is too slow to settle this heap
        engines = [engine for engine in engines if not engine.name.endswith("NEWTON")]
    yield from quality(work, engines, start, size.later)
    for engine in engines:
        engine.close()


def fall(engines: Sequence[Engine], rounds: int) -> dict[str, Rates]:
    """Rates during the first second of the fall; resets the engines before each round."""
    taken: dict[str, list[float]] = {engine.name: [] for engine in engines}
    for engine in engines:
        engine.reset()
        engine.run(5)
    for _ in range(rounds):
        for engine in engines:
            engine.reset()
            begin = process_time()
            engine.run(FALL)
            taken[engine.name].append((process_time() - begin) / FALL)
    return {name: Rates.of(times) for name, times in taken.items()}


def rest(engines: Sequence[Engine], rounds: int, steps: int | None = None) -> dict[str, Rates]:
    """Rates in blocks of steps with the boxes at rest; steps: per block, None to choose blocks of BLOCK s."""
    blocks: dict[str, int] = {}
    taken: dict[str, list[float]] = {engine.name: [] for engine in engines}
    for engine in engines:
        begin = process_time()
        engine.run(steps or 10)
        blocks[engine.name] = steps or max(3, int(BLOCK * 10 / (process_time() - begin)))
    for _ in range(rounds):
        for engine in engines:
            begin = process_time()
            engine.run(blocks[engine.name])
            taken[engine.name].append((process_time() - begin) / blocks[engine.name])
    return {name: Rates.of(times) for name, times in taken.items()}


def settle(engine: Engine, steps: int, movable: int) -> None:
    """Runs a heap until it rests. MuJoCo uses CG for large heaps, which Newton needs minutes to settle."""
    if isinstance(engine, MuJoCo) and movable >= MANY:
        engine.set_solver("CG")
    engine.run(steps)
    if isinstance(engine, MuJoCo):
        engine.set_solver(engine.name.split()[1])


def check(engines: Sequence[Engine], start: float) -> None:
    """Raises SystemExit if boxes left the scene or the total energy rose, since speed is meaningless then."""
    for engine in engines:
        positions = engine.positions()
        if not np.isfinite(positions).all() or positions[:, 2].min() < 0.1 or np.abs(positions).max() > 60.0:
            raise SystemExit(f"{engine.name}: boxes have left the scene")
        if engine.energy() > 1.01 * start:
            raise SystemExit(f"{engine.name}: energy has risen from {start:.4g} J to {engine.energy():.4g} J")


def speed(work: str, rates: Mapping[str, Rates], published: Mapping[str, float], asked: float) -> Row:
    """A row of rates of all engines and published figures."""
    peers = {name: rate.median for name, rate in rates.items() if name != "ours"} | dict(published)
    ours = rates["ours"].median
    return Row(work, "steps/s", ours, f"{asked:,.0f}", ours >= asked, peers, ours / max(peers.values()),
               best={name: rate.best for name, rate in rates.items()})


def quality(work: str, engines: Sequence[Engine], start: float, later: int) -> Iterator[Row]:
    """Rows of the state at rest: deepest penetration, energy drift in % of the energy of the fall per s, speed."""
    found: dict[str, dict[str, float]] = {"deepest penetration at rest": {}, "energy drift at rest": {},
                                          "highest speed at rest": {}}
    units = ("mm", "% of the fall per s", "mm/s")
    for engine in engines:
        engine.run(later)
        first, depths, speeds = engine.energy(), [], []
        for _ in range(0, REST, 10):
            engine.run(10)
            depths.append(engine.deepest())
            speeds.append(engine.fastest())
        drift = 100.0 * abs(engine.energy() - first) / (start - first) / (REST / RATE)
        for name, value in zip(found, (1000.0 * max(depths), drift, 1000.0 * statistics.median(speeds)), strict=True):
            found[name][engine.name] = value
    for unit, (name, values) in zip(units, found.items(), strict=True):
        ours = values.pop("ours")
        yield Row(f"{work}, {name}", unit, ours, peers=values, ratio=min(values.values()) / ours if ours else None)


def asleep(size: Size) -> Iterator[Row]:
    """A row for 64 boxes that are at rest and asleep."""
    boxes = BoxScene(heap(64), 0.0, FRICTION)
    engines: list[Engine] = [Ours(boxes, Setting(RATE, SUBSTEPS, sleep=True)), MuJoCo(boxes, RATE, sleep=True),
                             MuJoCo(boxes, RATE)]
    for engine in engines:
        engine.reset()
        engine.run(12 * int(RATE))
    before = engines[0].positions().copy()
    if engines[0].fastest() > 0.0:
        raise SystemExit("boxes that should sleep are moving")
    rates = rest(engines, size.rounds)
    if not np.array_equal(engines[0].positions(), before):
        raise SystemExit("boxes that should sleep have moved")
    published = {"Box3D, given": BOX3D_ASLEEP * rates["MuJoCo NEWTON"].median / MUJOCO_THERE[64][1]}
    yield speed("150 static and 64 movable boxes, all asleep", rates, published, TARGET_ASLEEP)
