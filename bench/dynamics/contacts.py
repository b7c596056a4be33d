"""Rows of the dynamics benchmark with contacts: how fast the heap is stepped, and how well, by all engines in turn."""

import statistics
from collections.abc import Iterator, Mapping, Sequence
from time import process_time
from typing import NamedTuple

import numpy as np

from bench.dynamics.engines import Boxes, Engine, MuJoCo, Ours, PyBullet
from bench.dynamics.heap import FRICTION, PASSES, RATE, SUBSTEPS, heap
from bench.report.results import Row
from reference.box_world import Setting

FALL, SETTLE, REST = 240, 470, 240  # steps: falling, from there to rest, and watched at rest
NEWTON_STEPS = 2  # of MuJoCo's Newton solver with 1,024 boxes in contact: each takes seconds
MANY = 1000  # boxes from which on Newton is not waited for
BLOCK = 0.4  # s of CPU time for each round at rest
# Steps per second of Box3D 0.1 (C, float32, SIMD), one thread, no sleeping, with 4 sub-steps and with 1, and of MuJoCo,
# on one machine; falling and resting. MuJoCo is the yardstick that brings the former to this machine.
BOX3D = {4: ((113e3, 107e3), (226e3, 232e3)), 64: ((9.7e3, 8.0e3), (15e3, 15e3)),
         1024: ((415.0, 340.0), (720.0, 840.0))}
BOX3D_ASLEEP = 215e3
YARDSTICK = {4: (111e3, 56e3), 64: (5.1e3, 1.7e3), 1024: (148.0, 32.0)}
ASKED = {4: (200e3, 150e3), 64: (12e3, 10e3), 1024: (500.0, 400.0)}
ASKED_ASLEEP = 300e3


class Size(NamedTuple):
    """How much is measured."""

    rounds: int
    heaps: tuple[int, ...]
    newton: bool  # at a thousand boxes in contact, too
    later: int  # more steps of settling before depth, energy and speed at rest are looked at


FULL = Size(5, (4, 64, 1024), True, 1440)
QUICK = Size(2, (4, 64), False, 480)


class Rates(NamedTuple):
    """Steps per s of CPU: the median of the rounds, and the best."""

    median: float
    best: float

    @classmethod
    def of(cls, times: Sequence[float]) -> "Rates":
        """From s a step."""
        return cls(1.0 / statistics.median(times), 1.0 / min(times))


def heap_rows(movable: int, size: Size) -> Iterator[Row]:
    """Falling and resting, and how well."""
    boxes = Boxes(heap(movable), 0.0, FRICTION)
    engines: list[Engine] = [Ours(boxes, Setting(RATE, SUBSTEPS, iterations=PASSES)), MuJoCo(boxes, RATE),
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
    yardstick = "MuJoCo CG" if movable >= MANY else "MuJoCo NEWTON"
    for i, (name, rates) in enumerate((("falling", falling), ("resting, none asleep", resting))):
        scale = rates[yardstick].median / YARDSTICK[movable][i]
        given = {"Box3D, 4 sub-steps, given": BOX3D[movable][0][i] * scale,
                 "Box3D, 1 sub-step, given": BOX3D[movable][1][i] * scale}
        yield speed(f"{work}, {name}", rates, given, ASKED[movable][i])
    if movable >= MANY:  # Newton is too slow to be settled
        engines = [engine for engine in engines if not engine.name.endswith("NEWTON")]
    yield from quality(work, engines, start, size.later)
    for engine in engines:
        engine.close()


def fall(engines: Sequence[Engine], rounds: int) -> dict[str, Rates]:
    """The first second after the drop, the engines in turn."""
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
    """Blocks of steps where the boxes lie, the engines in turn."""
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
    """A while after the fall. MuJoCo's Newton needs minutes to settle a thousand boxes, for which its CG will do."""
    if isinstance(engine, MuJoCo) and movable >= MANY:
        engine.set_solver("CG")
    engine.run(steps)
    if isinstance(engine, MuJoCo):
        engine.set_solver(engine.name.split()[1])


def check(engines: Sequence[Engine], start: float) -> None:
    """Speed means nothing if boxes fall through the floor or fly off, or if energy comes out of nothing."""
    for engine in engines:
        places = engine.positions()
        if not np.isfinite(places).all() or places[:, 2].min() < 0.1 or np.abs(places).max() > 60.0:
            raise SystemExit(f"{engine.name}: boxes have left the scene")
        if engine.energy() > 1.01 * start:
            raise SystemExit(f"{engine.name}: energy has risen from {start:.4g} J to {engine.energy():.4g} J")


def speed(work: str, rates: Mapping[str, Rates], given: Mapping[str, float], asked: float) -> Row:
    """Beside those of all others, the given ones included."""
    peers = {name: rate.median for name, rate in rates.items() if name != "ours"} | dict(given)
    ours = rates["ours"].median
    return Row(work, "steps/s", ours, f"{asked:,.0f}", ours >= asked, peers, ours / max(peers.values()),
               best={name: rate.best for name, rate in rates.items()})


def quality(work: str, engines: Sequence[Engine], start: float, later: int) -> Iterator[Row]:
    """What is left at rest: the deepest penetration, the energy's drift in % of what the fall set free, speeds."""
    found: dict[str, dict[str, float]] = {"deepest penetration at rest": {}, "energy drift at rest": {},
                                          "highest speed at rest": {}}
    units = ("mm", "% of the fall per s", "mm/s")
    for engine in engines:
        engine.run(later)
        first, deep, fast = engine.energy(), [], []
        for _ in range(0, REST, 10):
            engine.run(10)
            deep.append(engine.deepest())
            fast.append(engine.fastest())
        drift = 100.0 * abs(engine.energy() - first) / (start - first) / (REST / RATE)
        for name, value in zip(found, (1000.0 * max(deep), drift, 1000.0 * statistics.median(fast)), strict=True):
            found[name][engine.name] = value
    for unit, (name, values) in zip(units, found.items(), strict=True):
        ours = values.pop("ours")
        yield Row(f"{work}, {name}", unit, ours, peers=values, ratio=min(values.values()) / ours if ours else None)


def asleep(size: Size) -> Iterator[Row]:
    """64 boxes that have come to rest and been put to sleep."""
    boxes = Boxes(heap(64), 0.0, FRICTION)
    engines: list[Engine] = [Ours(boxes, Setting(RATE, SUBSTEPS, sleep=True)), MuJoCo(boxes, RATE, sleep=True),
                             MuJoCo(boxes, RATE)]
    for engine in engines:
        engine.reset()
        engine.run(12 * int(RATE))
    before = engines[0].positions().copy()
    if engines[0].fastest() > 0.0:
        raise SystemExit("boxes that should be asleep move")
    rates = rest(engines, size.rounds)
    if not np.array_equal(engines[0].positions(), before):
        raise SystemExit("boxes that should be asleep have moved")
    given = {"Box3D, given": BOX3D_ASLEEP * rates["MuJoCo NEWTON"].median / YARDSTICK[64][1]}
    yield speed("150 static and 64 movable boxes, all asleep", rates, given, ASKED_ASLEEP)
