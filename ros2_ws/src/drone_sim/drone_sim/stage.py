"""What a step is made of: a tuple of named functions, put together once from what the scene calls for."""

from collections.abc import Callable
from typing import NamedTuple

Stage = Callable[[], None]


class Named(NamedTuple):
    """A stage and what it is called in reports."""

    name: str
    run: Stage
