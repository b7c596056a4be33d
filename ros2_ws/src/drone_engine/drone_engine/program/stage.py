"""What a step is made of: stages, put together once from what the scene calls for."""

from collections.abc import Callable
from typing import Any, NamedTuple

Arguments = tuple[Any, ...]  # contiguous arrays, floats and whole numbers


class Stage(NamedTuple):
    """A kernel and its arguments, and what stages are called in reports.

    Arguments may also be a function that gives them, asked again when the stage is bound anew. A kernel that returns a
    code other than 0 stops the loop: `attend` is called with it, and names the stage to go on from, None for the next.
    Without a kernel the stage is Python's, and `attend` all that there is to do.
    """

    name: str
    kernel: Any
    arguments: Arguments | Callable[[], Arguments] = ()
    attend: Callable[[int], str | None] = lambda code: None


def in_python(name: str, run: Callable[[], None]) -> Stage:
    """A stage that is not compiled."""
    def attend(code: int) -> None:
        run()

    return Stage(name, None, (), attend)
