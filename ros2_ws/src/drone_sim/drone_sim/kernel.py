"""The one way to compile a function: `@kernel`, or `@inlined` for what many loops share.

Kernels are cached on disk, in a folder named after the text of all files that have one: numba's own cache does not
notice an edit in a file that a kernel calls into, and a stale kernel would be a wrong simulation.
"""

import hashlib
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.dispatcher import Dispatcher

F = TypeVar("F", bound=Callable[..., Any])

_package = Path(__file__).parent


def _cache_folder() -> Path:
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(_package.rglob("*.py")):
        text = path.read_bytes()
        if b"@kernel" in text or b"@inlined" in text:
            digest.update(text)
    return _package / "__pycache__" / f"kernels-{digest.hexdigest()[:16]}"


_folder = _cache_folder()
try:
    _folder.mkdir(parents=True, exist_ok=True)
except OSError:  # an installation that may not be written to
    _folder = Path.home() / ".cache" / "drone_sim" / _folder.name
    _folder.mkdir(parents=True, exist_ok=True)
for old in _folder.parent.glob("kernels-*"):
    if old != _folder:
        shutil.rmtree(old, ignore_errors=True)
numba.config.CACHE_DIR = str(_folder)


def generated_folder() -> Path:
    """Where modules that are written by the program may lie; as old as the kernels' caches."""
    return _folder / "generated"


def compiled_before() -> bool:
    """Whether there are kernels on disk, so that a start need not compile them."""
    return any(_folder.rglob("*.nbc"))


def kernel(function: F) -> F:
    """Compiles a function of numbers, tuples and arrays when it is first called. No fast-math: runs repeat bitwise."""
    return numba.njit(cache=True, error_model="numpy")(function)  # type: ignore[no-any-return]


def inlined(function: F) -> F:
    """A kernel that is compiled into each of its callers: their loops over it can then be vectorised."""
    return numba.njit(cache=True, error_model="numpy", forceinline=True)(function)  # type: ignore[no-any-return]


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
