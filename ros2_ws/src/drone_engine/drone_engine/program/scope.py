"""The names that kernels' parameters are bound by, and the arrays behind them."""

from collections.abc import Iterator
from typing import Any, NamedTuple


class BindingError(TypeError):
    """A parameter that cannot be bound, or a name that is given twice; one line."""


class Entry(NamedTuple):
    """Where an array is: the attribute of an object, looked up at each binding, since arrays are replaced as they
    grow."""

    owner: Any
    attribute: str


class Scope:
    """A table of names, each with one meaning. A child scope adds names to those of its parent."""

    def __init__(self, parent: "Scope | None" = None) -> None:
        self._parent = parent
        self._entries: dict[str, Entry] = {}

    def share(self, owner: Any, *names: str, **renamed: str) -> None:
        """Shares attributes of an object: by their own names, or as name=attribute. Raises BindingError."""
        for name, attribute in [*((name, name) for name in names), *renamed.items()]:
            if name in self:
                raise BindingError(f"'{name}' is shared by {_type(self.entry(name).owner)} and by {_type(owner)}")
            getattr(owner, attribute)  # an attribute that does not exist is an error here, not in the first step
            self._entries[name] = Entry(owner, attribute)

    def child(self, owner: Any = None, *names: str, **renamed: str) -> "Scope":
        """A scope that also knows these attributes of an object."""
        child = Scope(self)
        child.share(owner, *names, **renamed)
        return child

    def __contains__(self, name: str) -> bool:
        return name in self._entries or (self._parent is not None and name in self._parent)

    def __iter__(self) -> Iterator[str]:
        yield from self._entries
        if self._parent is not None:
            yield from self._parent

    def entry(self, name: str) -> Entry:
        """Where a name leads. Raises KeyError."""
        if name in self._entries or self._parent is None:
            return self._entries[name]
        return self._parent.entry(name)

    def __getitem__(self, name: str) -> Any:
        """The array, number or record behind a name, as it is now. Raises KeyError."""
        owner, attribute = self.entry(name)
        return getattr(owner, attribute)


def _type(owner: Any) -> str:
    return type(owner).__name__
