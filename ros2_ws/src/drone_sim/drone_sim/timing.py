"""How long stages take, measured while they run: a clock is read between them, in the compiled loop itself.

A reading takes about 20 ns of vDSO and no way back to Python. Worlds that nobody measures have no such stages.
"""

import time
from collections.abc import Sequence

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from drone_sim.arrays import Integers
from drone_sim.kernel import kernel
from drone_sim.stage import Stage

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
def lap(last, total, stage):
    """Adds the ns since the last reading to what a stage has taken; last: (1,), total: (n,)."""
    now = nanoseconds()
    total[stage] += now - last[0]
    last[0] = now


class Laps:
    """What stages have taken since they were last asked, in ns."""

    def __init__(self, names: Sequence[str]) -> None:
        self.names = tuple(names)
        self._last: Integers = np.zeros(1, np.int64)
        self._total: Integers = np.zeros(len(names) + 1, np.int64)  # the last: from the end of a pass to the next

    def between(self, stages: Sequence[Stage]) -> list[Stage]:
        """The stages with a reading before the first and after each."""
        timed = [self._reading(len(self.names))]
        for i, stage in enumerate(stages):
            timed += [stage, self._reading(i)]
        return timed

    def _reading(self, stage: int) -> Stage:
        return Stage("", lap, (self._last, self._total, stage))

    def take(self) -> Integers:
        """The ns of each stage since this was called last, (n,)."""
        taken = self._total[:-1].copy()
        self._total[:] = 0
        return taken
