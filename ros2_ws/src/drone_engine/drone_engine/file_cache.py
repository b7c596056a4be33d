"""Results of reading files, kept for as long as the files stay unchanged."""

from collections.abc import Callable
from functools import cache, wraps
from pathlib import Path
from typing import Any, TypeVar, TypeVarTuple

Others = TypeVarTuple("Others")
Content = TypeVar("Content")


def read_once(read: Callable[[Path, *Others], Content]) -> Callable[[Path, *Others], Content]:
    """Decorator: caches the result of a function of a file (and hashable arguments) until the file is modified."""

    @cache
    def cached(path: Path, modified: int, *others: Any) -> Content:
        return read(path, *others)

    @wraps(read)
    def current(path: Path, *others: *Others) -> Content:
        return cached(path, path.stat().st_mtime_ns if path.exists() else 0, *others)

    return current
