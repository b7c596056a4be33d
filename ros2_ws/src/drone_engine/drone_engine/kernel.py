"""Decorators that compile functions: `@kernel`, or `@inlined` for small functions called from many loops."""

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numba.core import sigutils
from numba.core.ccallback import CFunc
from numba.core.dispatcher import Dispatcher

from drone_engine.kernel_cache import KernelCache

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compiles a function of numbers, tuples and arrays when it is first called. No fast-math: runs repeat bitwise.

    It must not allocate arrays or lists: it writes to buffers that it receives. It then needs no reference counts,
    which would take a third of the time of a short step. With NUMBA_DISABLE_JIT=1 the function stays a Python
    function, so that a debugger can step through it.
    """
    return _cached(numba.njit(error_model="numpy", _nrt=False)(function), function)  # type: ignore[no-any-return]


def inlined(function: F) -> F:
    """As `kernel`, compiled into each of its callers, so that their loops can be vectorized."""
    compiled = numba.njit(error_model="numpy", forceinline=True, _nrt=False)(function)
    return _cached(compiled, function)  # type: ignore[no-any-return]


def allocating(function: F) -> F:
    """As `kernel`, for a function that allocates scratch arrays, and for its callers: queries from Python, and exact
    arithmetic where rounding errors leave the answer open."""
    return _cached(numba.njit(error_model="numpy")(function), function)  # type: ignore[no-any-return]


def c_function(signature: str) -> Callable[[F], Any]:
    """Decorator: compiles a function immediately, with a C calling convention and a numba signature such as
    "int64(int64)"; `.address` of the result is its address."""

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
    """A kernel and all kernels that it calls, directly or not, in breadth-first order."""
    found = [compiled]
    for caller in found:  # grows in the loop
        function = caller.py_func
        for name in function.__code__.co_names:
            callee = function.__globals__.get(name)
            if isinstance(callee, Dispatcher) and callee not in found:
                found.append(callee)
    return found
