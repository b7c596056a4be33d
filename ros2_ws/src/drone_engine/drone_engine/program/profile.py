"""How long stages take, measured while they run: a clock is read between them, in the compiled loop itself.

A reading takes about 25 ns. Worlds that nobody measures have no such stages.
"""

import time
from collections.abc import Sequence
from functools import cache

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from drone_engine.arrays import Integers
from drone_engine.kernel import kernel
from drone_engine.program.stage import Stage

MONOTONIC = time.CLOCK_MONOTONIC


@intrinsic
def nanoseconds(typing):
    """The steady clock, ns: clock_gettime of the C library."""
    def read(context, builder, signature, arguments):
        whole, number = ir.IntType(64), ir.IntType(32)
        clock = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(number, [number, whole.as_pointer()]), "clock_gettime")
        spec = cgutils.alloca_once(builder, whole, size=2)
        builder.call(clock, [ir.Constant(number, MONOTONIC), spec])
        seconds = builder.load(spec)
        rest = builder.load(builder.gep(spec, [ir.Constant(number, 1)]))
        return builder.add(builder.mul(seconds, ir.Constant(whole, 1_000_000_000)), rest)

    return types.int64(), read


@kernel
def begin(last, passes):
    """Reads the clock before the first stage; last: (1,), passes: (1,)."""
    passes[0] += 1
    last[0] = nanoseconds()


@kernel
def lap(last, total, stage):
    """Adds the ns since the last reading to what a stage has taken; last: (1,), total: (n,)."""
    now = nanoseconds()
    total[stage] += now - last[0]
    last[0] = now


@kernel
def read_only(last, total, readings):
    """Nothing but readings."""
    for _ in range(readings):
        lap(last, total, 0)


@cache
def reading() -> float:
    """What one reading takes, ns; the least of a few tries, as all else is somebody else's work."""
    last, total = np.zeros((2, 1), np.int64)
    read_only(last, total, 10)
    tries = []
    for _ in range(20):
        total[0] = 0
        last[0] = time.monotonic_ns()
        read_only(last, total, 1000)
        tries.append(float(total[0]) / 1000)
    return min(tries)


class Laps:
    """Stages with clock readings between them."""

    def __init__(self, stages: Sequence[Stage]) -> None:
        self.names = tuple(stage.name for stage in stages)
        self._passes: Integers = np.zeros(1, np.int64)
        self._total: Integers = np.zeros(len(stages), np.int64)
        last: Integers = np.zeros(1, np.int64)
        self.stages = [Stage("", begin, (last, self._passes))]
        for i, stage in enumerate(stages):
            self.stages += [stage, Stage("", lap, (last, self._total, i))]

    def take(self) -> tuple[int, dict[str, float]]:
        """How often all stages have run since this was last asked, and the us that each name has taken in all."""
        passes, total = int(self._passes[0]), dict.fromkeys(self.names, 0.0)
        for name, spent in zip(self.names, self._total, strict=True):
            total[name] += 1e-3 * (float(spent) - passes * reading())
        self._passes[:] = self._total[:] = 0
        return passes, total

    def readings(self, passes: int) -> float:
        """The us that readings have taken in so many passes."""
        return 1e-3 * passes * (len(self.names) + 1) * reading()


def times(step: Laps, within: str, nested: Sequence[Laps]) -> dict[str, float]:
    """us per step of each stage since last asked; the stage `within` is told without those nested in it, '<within>: '
    before their names."""
    steps, outer = step.take()
    inner: dict[str, float] = {}
    for laps in nested:
        passes, spent = laps.take()
        outer[within] -= sum(spent.values()) + laps.readings(passes)
        for name, us in spent.items():
            inner[name] = inner.get(name, 0.0) + us
    every: dict[str, float] = {}
    for name, us in outer.items():
        every[name] = us
        if name == within:
            every |= {f"{within}: {part}": us for part, us in inner.items()}
    return {name: max(us, 0.0) / steps for name, us in every.items()} if steps else {}
