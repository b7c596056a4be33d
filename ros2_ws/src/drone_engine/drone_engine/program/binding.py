"""Binds a stage's kernel to its arguments, by parameter name, and gives it one C function that takes them all.

The compiled loop knows stages only as a C function and a row of addresses. The function is a small module written per
kernel and argument types: it takes arrays, numbers and records (NamedTuples of these) from the row and calls the
kernel.
"""

import hashlib
import inspect
import os
import sys
from collections.abc import Iterator
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from drone_engine.kernel_cache import generated_folder
from drone_engine.program.scope import BindingError
from drone_engine.program.stage import Stage


@intrinsic
def address(typing, number):
    """The pointer with the value of an int64."""
    def cast(context, builder, signature, arguments):
        return builder.inttoptr(arguments[0], ir.IntType(8).as_pointer())

    return types.voidptr(types.int64), cast


@intrinsic
def real(typing, number):
    """The float64 with the bits of an int64."""
    def cast(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.DoubleType())

    return types.float64(types.int64), cast


def is_record(value: Any) -> bool:
    """Whether a value is a record: a tuple, named or not, of arrays, numbers and other records."""
    return isinstance(value, tuple)


def parameters(stage: Stage) -> tuple[str, ...]:
    """The names of the kernel's parameters, in order."""
    return _parameters(stage.kernel)


@cache
def _parameters(kernel: Any) -> tuple[str, ...]:
    """Kept, since a signature takes longer to inspect than everything else in a binding."""
    return tuple(inspect.signature(getattr(kernel, "py_func", kernel)).parameters)


def arguments(stage: Stage) -> tuple[Any, ...]:
    """The kernel's arguments, in order of its parameters. Raises BindingError for a name that means nothing or two
    things."""
    names = parameters(stage)
    where = f"stage '{stage.name}': kernel {_name(stage)}"
    for name in stage.given:
        if name not in names:
            raise BindingError(f"{where} has no parameter '{name}', which is given")
        if name in stage.scope:
            raise BindingError(f"{where}: '{name}' is given and shared")
    values = []
    for name in names:
        if name not in stage.given and name not in stage.scope:
            raise BindingError(f"{where}: parameter '{name}' is neither given nor shared")
        value = stage.given[name] if name in stage.given else stage.scope[name]
        if not _contiguous(value):
            part, array = next(leaf for leaf in leaves(value, name) if not _contiguous(leaf[1]))
            raise BindingError(f"{where}: '{part}' has to be contiguous, got an array of shape {array.shape}")
        values.append(value)
    return tuple(values)


def leaves(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """The arrays and numbers of a value with their names, 'record.field' for those of records."""
    if is_record(value):
        for field, part in zip(getattr(value, "_fields", range(len(value))), value, strict=True):
            yield from leaves(part, f"{name}.{field}")
    else:
        yield name, value


def _contiguous(value: Any) -> bool:
    """Whether all arrays of a value are contiguous."""
    if isinstance(value, np.ndarray):
        return bool(value.flags.c_contiguous)
    return all(map(_contiguous, value)) if isinstance(value, tuple) else True


def row(values: tuple[Any, ...]) -> np.ndarray:
    """What the C function takes: per array its address and shape, per number its bits, int64."""
    words: list[int] = []
    _append_words(values, words)
    return np.array(words or [0], np.int64)


def _append_words(values: tuple[Any, ...], words: list[int]) -> None:
    """Appends what stands for values, and for the parts of records, to words."""
    for value in values:
        if isinstance(value, np.ndarray):
            words.append(value.ctypes.data)
            words.extend(value.shape)
        elif isinstance(value, tuple):
            _append_words(value, words)
        elif isinstance(value, float):
            words.append(int(np.float64(value).view(np.int64)))
        else:
            words.append(int(value))


TEMPLATE = '''"""{name}: its arguments from a row of addresses."""
import numba
import numpy as np
from drone_engine.kernel import c_function
from drone_engine.program.binding import address, real
from {module} import {name} as kernel
{imports}

@c_function("int64(int64)")
def enter(row):
    a = numba.carray(address(row), ({size},), np.int64)
    {result}kernel(
        {arguments})
    return {code}
'''
_entered: dict[str, Any] = {}  # C functions by the text of their modules


def c_entry(stage: Stage, values: tuple[Any, ...]) -> int:
    """The address of the C function that calls a stage's kernel with values of these types; compiles it if need be."""
    reader = _Reader()
    parts = [reader.read(value) for value in values]
    signature = tuple(numba.typeof(value) for value in values)
    compiled = stage.kernel
    compiled.compile(signature)
    silent = compiled.overloads[signature].signature.return_type == types.none
    text = TEMPLATE.format(
        name=compiled.py_func.__name__, module=compiled.py_func.__module__, size=max(reader.at, 1),
        imports="".join(f"from {record.__module__} import {record.__qualname__}\n" for record in reader.records),
        arguments=",\n        ".join(parts), result="" if silent else "code = ", code="0" if silent else "code")
    if text not in _entered:
        _entered[text] = _load(text, compiled.py_func.__name__)
    return int(_entered[text].address)


class _Reader:
    """Writes the expressions that read values from a row; counts the words read."""

    def __init__(self) -> None:
        self.at = 0
        self.records: list[type] = []

    def read(self, value: Any) -> str:
        if is_record(value):
            record = type(value)
            if record is not tuple and record not in self.records:
                self.records.append(record)
            return f"{'' if record is tuple else record.__name__}({''.join(f'{self.read(part)}, ' for part in value)})"
        first = self.at
        if isinstance(value, np.ndarray):
            self.at += 1 + value.ndim
            shape = "".join(f"a[{first + 1 + k}], " for k in range(value.ndim))
            kind = "bool_" if value.dtype == np.bool_ else value.dtype.name
            return f"numba.carray(address(a[{first}]), ({shape}), np.{kind})"
        self.at += 1
        return f"real(a[{first}])" if isinstance(value, float) else f"a[{first}]"


def _load(text: str, name: str) -> Any:
    """The function `enter` of a module with this text, kept among the caches so that it compiles once."""
    path = generated_folder() / f"{name}_{hashlib.sha256(text.encode()).hexdigest()[:12]}.py"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_suffix(f".{os.getpid()}")
        draft.write_text(text)
        draft.replace(path)  # in one step, should two programs start together
    spec = spec_from_file_location(f"drone_engine_{path.stem}", path)
    assert spec
    assert spec.loader
    module = module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module.enter


def _name(stage: Stage) -> str:
    function = getattr(stage.kernel, "py_func", stage.kernel)
    return f"{function.__module__}.{function.__name__}"
