"""Time per stage, measured in the compiled loop itself: timing stages read the clock between the others.

A reading takes about 25 ns. A world that is not timed has no timing stages.
"""

import time
from collections.abc import Sequence
from functools import cache

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.extending import intrinsic

from drone_engine.arrays import Integers
from drone_engine.kernel import kernel
from drone_engine.program.stage import Stage

MONOTONIC = time.CLOCK_MONOTONIC


@intrinsic
def nanoseconds(typing):
    """The monotonic clock, ns: clock_gettime of the C library."""
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


if config.DISABLE_JIT:  # an intrinsic exists in compiled code only
    nanoseconds = time.monotonic_ns


@kernel
def begin(last, passes):
    """Reads the clock before the first stage and counts the pass. last: (1,) ns, passes: (1,), both written."""
    passes[0] += 1
    last[0] = nanoseconds()


@kernel
def lap(last, total, stage):
    """Adds the ns since the last reading to the total of a stage. last: (1,) ns, total: (n,) ns, both in and out."""
    now = nanoseconds()
    total[stage] += now - last[0]
    last[0] = now


@kernel
def read_only(last, total, readings):
    """Reads the clock `readings` times, to measure what a reading takes."""
    for _ in range(readings):
        lap(last, total, 0)


@cache
def reading() -> float:
    """Duration of one clock reading, ns: the minimum of several tries, since anything above is interference."""
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
        self.stages = [Stage("", begin, given={"last": last, "passes": self._passes}, timer=True)]
        for i, stage in enumerate(stages):
            self.stages += [stage, Stage("", lap, given={"last": last, "total": self._total, "stage": i}, timer=True)]

    def take(self) -> tuple[int, dict[str, float]]:
        """How often all stages have run since the last call, and the us that each name has taken in total."""
        passes, total = int(self._passes[0]), dict.fromkeys(self.names, 0.0)
        for name, spent in zip(self.names, self._total, strict=True):
            total[name] += 1e-3 * (float(spent) - passes * reading())
        self._passes[:] = self._total[:] = 0
        return passes, total

    def readings(self, passes: int) -> float:
        """The us that the clock readings of so many passes have taken."""
        return 1e-3 * passes * (len(self.names) + 1) * reading()


def times(step: Laps, within: str, nested: Sequence[Laps]) -> dict[str, float]:
    """us per step of each stage since the last call. The time of the stage `within` excludes the stages nested in it,
    which follow it under '<within>: <name>'."""
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
