"""A stage of a step: a compiled kernel whose parameters are bound by name, or a call into Python."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from drone_engine.program.scope import Scope


@dataclass(frozen=True, eq=False)
class Stage:
    """One stage. Stages are compared by identity, since a stage may name another one to continue with.

    Each parameter of the kernel is bound by its name: to an entry of `given`, the arguments of this stage alone, or to
    the array that `scope` knows by that name. `program.binding` does that once, when the program is built.

    A kernel that returns a code other than 0 stops the compiled loop. `handle` is called with the code; it returns the
    stage to continue with, or None for the next one.

    A stage without a kernel runs in Python: `handle` is called with -1. It then lists the arrays that it changes in
    `writes`; for kernels, what they read and write is derived from their text (`program.access`).
    """

    name: str  # in reports; not necessarily unique
    kernel: Any = None
    scope: Scope = field(default_factory=Scope)
    given: Mapping[str, Any] = field(default_factory=dict)
    handle: "Callable[[int], Stage | None]" = lambda code: None
    writes: tuple[str, ...] = ()
    timer: bool = False  # reads the clock between stages; not shown in reports


def in_python(name: str, run: Callable[[], None], writes: tuple[str, ...] = ()) -> Stage:
    """A stage that calls a Python function once a step."""

    def handle(code: int) -> None:
        run()

    return Stage(name, handle=handle, writes=writes)
