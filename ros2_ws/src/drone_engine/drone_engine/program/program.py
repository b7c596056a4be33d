"""Stages become one compiled loop: a step, or a thousand, without returning to Python.

Each stage is a kernel and its arguments. For every kernel there is a small C function that takes the arguments from a
row of addresses and calls it; the loop knows nothing but these functions and rows, so that another scene, with other
stages, compiles nothing but what it has and others had not. A stage may be left to Python, too: the loop then
returns, and goes on after it. So it does when a kernel returns a code other than 0, a buffer that is too small, say.
"""

import hashlib
import os
import sys
from collections.abc import Callable, Sequence
from importlib.util import module_from_spec, spec_from_file_location
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from drone_engine.arrays import Integers
from drone_engine.cache import generated_folder
from drone_engine.kernel import kernel
from drone_engine.program.stage import Stage

PYTHON = -1  # the code with which a stage is left to Python


@intrinsic
def address(typing, number):
    """The pointer that a whole number is."""
    def cast(context, builder, signature, arguments):
        return builder.inttoptr(arguments[0], ir.IntType(8).as_pointer())

    return types.voidptr(types.int64), cast


@intrinsic
def real(typing, number):
    """The float64 with the bits of a whole number."""
    def cast(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.DoubleType())

    return types.float64(types.int64), cast


@intrinsic
def call(typing, function, row):
    """Calls the C function at an address with the address of its row; returns its code."""
    def jump(context, builder, signature, arguments):
        whole = ir.IntType(64)
        target = builder.inttoptr(arguments[0], ir.FunctionType(whole, [whole]).as_pointer())
        return builder.call(target, [arguments[1]])

    return types.int64(types.int64, types.int64), jump


@kernel
def run(function, row, first, steps):
    """Runs the stages from number `first` on, then whole steps; function, row: (n,) addresses, 0 for Python's.

    Returns how many steps are complete, and the stage that stopped it with which code, 0 if none did.
    """
    done, at = 0, first
    while done < steps:
        while at < function.shape[0]:
            code = call(function[at], row[at]) if function[at] else PYTHON
            if code != 0:
                return done, at, code
            at += 1
        done, at = done + 1, 0
    return done, 0, 0


@kernel
def run_once(function, row):
    """Runs compiled stages, in order, from within another kernel."""
    for i in range(function.shape[0]):
        call(function[i], row[i])


TEMPLATE = '''"""{name}: the arguments of {kernel} from a row of addresses."""
import numba
import numpy as np
from {module} import {kernel} as kernel
from drone_engine.kernel import c_function
from drone_engine.program.program import address, real


@c_function("int64(int64)")
def enter(row):
    a = numba.carray(address(row), ({size},), np.int64)
    {result}kernel({arguments})
    return {code}
'''
_entered: dict[str, Any] = {}  # C functions by the text of their modules


class Program:
    """Stages in the order in which they run."""

    def __init__(self, stages: Sequence[Stage]) -> None:
        self.stages = tuple(stages)
        self._rows: list[Integers] = [np.empty(0, np.int64)] * len(stages)
        self._kept: list[tuple[Any, ...]] = [()] * len(stages)  # what the addresses point to
        self.function: Integers = np.zeros(len(stages), np.int64)
        self.row: Integers = np.zeros(len(stages), np.int64)
        self.bind()

    def bind(self, *names: str) -> None:
        """Takes the arguments of the stages (all, or those named) anew: do so once any of their arrays is another."""
        for i, stage in enumerate(self.stages):
            if stage.kernel is not None and (not names or stage.name in names):
                arguments = stage.arguments() if callable(stage.arguments) else stage.arguments
                self._kept[i] = arguments
                self._rows[i] = np.array([word for a in arguments for word in _words(a)] or [0], np.int64)
                self.row[i] = self._rows[i].ctypes.data

    def compile(self, report: Callable[[int, int, str], None] = lambda done, total, name: None) -> None:
        """Compiles the stages or takes them from disk, telling which comes next. Once is enough."""
        for i, stage in enumerate(self.stages):
            report(i, len(self.stages), stage.name)
            if stage.kernel is not None:
                self.function[i] = _enter(stage.kernel, self._kept[i]).address
        run(self.function[:0], self.row[:0], 0, 0)

    def run(self, steps: int, first: int = 0, last: int | None = None) -> None:
        """Runs this many times from stage `first` to before `last`, attending to what stops it."""
        function, row = self.function, self.row
        if last is not None:
            function, row = function[:last], row[:last]
        while steps:
            done, at, code = run(function, row, first, steps)
            steps -= done
            if code:
                name = self.stages[at].attend(code)
                first = at + 1 if name is None else next(i for i, stage in enumerate(self.stages) if stage.name == name)
                if first == len(function):
                    steps, first = steps - 1, 0
            else:
                first = 0


def _words(argument: Any) -> list[int]:
    """What stands for an argument in a row: an array's address and shape, or a number's bits."""
    if isinstance(argument, np.ndarray):
        if not argument.flags.c_contiguous:
            raise TypeError(f"stages take contiguous arrays, got one of shape {argument.shape}")
        return [argument.ctypes.data, *argument.shape]
    if isinstance(argument, float):
        return [int(np.float64(argument).view(np.int64))]
    return [int(argument)]


def _enter(compiled: Any, arguments: tuple[Any, ...]) -> Any:
    """The C function that calls a kernel with arguments of these types."""
    parts, at = [], 0
    for argument in arguments:
        if isinstance(argument, np.ndarray):
            shape = "".join(f"a[{at + 1 + k}], " for k in range(argument.ndim))
            kind = "bool_" if argument.dtype == np.bool_ else argument.dtype.name
            parts.append(f"numba.carray(address(a[{at}]), ({shape}), np.{kind})")
            at += 1 + argument.ndim
        else:
            parts.append(f"real(a[{at}])" if isinstance(argument, float) else f"a[{at}]")
            at += 1
    signature = tuple(numba.typeof(argument) for argument in arguments)
    compiled.compile(signature)
    silent = compiled.overloads[signature].signature.return_type == types.none
    name, module = compiled.py_func.__name__, compiled.py_func.__module__
    text = TEMPLATE.format(name=name, kernel=name, module=module, size=max(at, 1), arguments=", ".join(parts),
                           result="" if silent else "code = ", code="0" if silent else "code")
    if text not in _entered:
        _entered[text] = _load(text, name)
    return _entered[text]


def _load(text: str, name: str) -> Any:
    """The function `enter` of a module with this text, kept among the caches so that it compiles once."""
    path = generated_folder() / f"{name}_{hashlib.sha256(text.encode()).hexdigest()[:12]}.py"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_suffix(f".{os.getpid()}")
        draft.write_text(text)
        draft.replace(path)  # at once, should two programs start together
    spec = spec_from_file_location(f"drone_engine_{path.stem}", path)
    assert spec and spec.loader
    module = module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module.enter
