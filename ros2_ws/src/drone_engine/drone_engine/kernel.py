"""The one way to compile a function: `@kernel`, or `@inlined` for what many loops share."""

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numba.core import sigutils
from numba.core.ccallback import CFunc
from numba.core.dispatcher import Dispatcher

from drone_engine.cache import KernelCache

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compiles a function of numbers, tuples and arrays when it is first called. No fast-math: runs repeat bitwise.

    With NUMBA_DISABLE_JIT=1 the function stays Python's, so that a debugger can step through it.
    """
    return _cached(numba.njit(error_model="numpy")(function), function)  # type: ignore[no-any-return]


def inlined(function: F) -> F:
    """A kernel that is compiled into each of its callers: their loops over it can then be vectorised."""
    return _cached(numba.njit(error_model="numpy", forceinline=True)(function), function)  # type: ignore[no-any-return]


def c_function(signature: str) -> Callable[[F], Any]:
    """Compiles a function at once, with a C calling convention; `.address` is where it lies."""

    def compile_now(function: F) -> Any:
        arguments, result = sigutils.normalize_signature(signature)
        compiled: Any = CFunc(function, (arguments, result), {}, {})
        compiled._cache = KernelCache(function)
        compiled.compile()
        return compiled

    return compile_now


def _cached(compiled: Any, function: Callable[..., Any]) -> Any:
    if isinstance(compiled, Dispatcher):
        compiled._cache = KernelCache(function)  # type: ignore[attr-defined]
    return compiled


def reached(compiled: Any) -> list[Any]:
    """A kernel and all kernels that it calls, and they, in the order in which they are met."""
    found = [compiled]
    for caller in found:  # which grows meanwhile
        function = caller.py_func
        for name in function.__code__.co_names:
            callee = function.__globals__.get(name)
            if isinstance(callee, Dispatcher) and callee not in found:
                found.append(callee)
    return found
