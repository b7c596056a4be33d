"""Stages become one compiled loop: a step, or a thousand, without returning to Python.

For every stage there is a C function and a row with the addresses of its arguments; the loop contains nothing else, so
that a scene with other stages compiles only the kernels that other scenes did not have. The loop returns to Python for
a stage that has no kernel, and when a kernel returns a code other than 0, because a buffer is too small, for instance.

With NUMBA_DISABLE_JIT=1 the same stages are called one by one from Python, for debugging.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from drone_engine.arrays import Integers
from drone_engine.kernel import kernel
from drone_engine.program import binding
from drone_engine.program.stage import Stage

IN_PYTHON = -1  # the code of a stage without a kernel


class Compiled(NamedTuple):
    """Compiled stages, in order, as kernels take them."""

    function: Integers  # (n,) addresses of C functions; 0: runs in Python
    row: Integers  # (n,) addresses of the rows of arguments


@intrinsic
def call(typing, function, row):
    """Calls the C function at an address with the address of its row; returns its code."""
    def jump(context, builder, signature, arguments):
        whole = ir.IntType(64)
        target = builder.inttoptr(arguments[0], ir.FunctionType(whole, [whole]).as_pointer())
        return builder.call(target, [arguments[1]])

    return types.int64(types.int64, types.int64), jump


@kernel
def run_steps(function, row, first, steps):
    """Runs the stages from number `first` on, then whole steps. function, row: as in Compiled.

    Returns how many steps are complete, the stage that stopped the loop, and its code: 0 if none did.
    """
    done, at = 0, first
    while done < steps:
        while at < function.shape[0]:
            code = call(function[at], row[at]) if function[at] else IN_PYTHON
            if code != 0:
                return done, at, code
            at += 1
        done, at = done + 1, 0
    return done, 0, 0


@kernel
def _run_once(program):
    """Runs all stages of a Compiled program, in order, from within another kernel."""
    for i in range(program.function.shape[0]):
        call(program.function[i], program.row[i])


def _run_once_in_python(program: "Program") -> None:
    """Runs all stages of a program, in order, where kernels are not compiled."""
    program.run(1)


run_once: Any = _run_once_in_python if numba.config.DISABLE_JIT else _run_once


class Program:
    """Stages in the order in which they run."""

    def __init__(self, stages: Sequence[Stage]) -> None:
        """Binds every stage. Raises BindingError for a parameter that has no argument."""
        self.stages = tuple(stages)
        self._place = {stage: i for i, stage in enumerate(self.stages)}
        self._rows: list[Integers] = [np.empty(0, np.int64)] * len(stages)
        self._arguments: list[tuple[Any, ...]] = [()] * len(stages)  # what the addresses point to
        self._function: Integers = np.zeros(len(stages), np.int64)
        self._row: Integers = np.zeros(len(stages), np.int64)
        self.bind()

    @property
    def argument(self) -> "Compiled | Program":
        """What a kernel that runs this program takes, for run_once."""
        return self if numba.config.DISABLE_JIT else Compiled(self._function, self._row)

    def bind(self, *stages: Stage) -> None:
        """Binds stages (all, if none is named) again: needed once an array of theirs has been replaced."""
        for stage in stages or self.stages:
            if stage.kernel is not None:
                i = self._place[stage]
                self._arguments[i] = binding.arguments(stage)
                if not numba.config.DISABLE_JIT:
                    self._rows[i] = binding.row(self._arguments[i])
                    self._row[i] = self._rows[i].ctypes.data

    def compile(self, report: Callable[[int, int, str], None] = lambda done, total, name: None) -> None:
        """Compiles the stages or takes them from disk; reports how many of how many are done, and the next one."""
        if numba.config.DISABLE_JIT:
            return
        for i, stage in enumerate(self.stages):
            report(i, len(self.stages), stage.name)
            if stage.kernel is not None:
                self._function[i] = binding.c_entry(stage, self._arguments[i])
        run_steps(self._function[:0], self._row[:0], 0, 0)

    def run(self, steps: int) -> None:
        """Runs all stages this many times."""
        self._run(steps, self._function, self._row)

    def run_through(self, first: Stage, last: Stage) -> None:
        """Runs the stages from `first` to `last`, both included, once."""
        end = self._place[last] + 1
        self._run(1, self._function[:end], self._row[:end], self._place[first])

    def _run(self, steps: int, function: Integers, row: Integers, first: int = 0) -> None:
        """Runs the stages of function and row from number `first` on, then all of them until all steps are done;
        handles what stops the loop."""
        run = self._run_in_python if numba.config.DISABLE_JIT else run_steps
        while steps:
            done, at, code = run(function, row, first, steps)
            steps -= done
            first = 0
            if code:
                stage = self.stages[at].handle(code)
                first = at + 1 if stage is None else self._place[stage]
                if first == len(function):
                    steps, first = steps - 1, 0

    def _run_in_python(self, function: Integers, row: Integers, first: int, steps: int) -> tuple[int, int, int]:
        """As run_steps, without compiled code."""
        done, at = 0, first
        while done < steps:
            while at < len(function):
                stage = self.stages[at]
                code = IN_PYTHON if stage.kernel is None else stage.kernel(*self._arguments[at]) or 0
                if code:
                    return done, at, int(code)
                at += 1
            done, at = done + 1, 0
        return done, 0, 0
