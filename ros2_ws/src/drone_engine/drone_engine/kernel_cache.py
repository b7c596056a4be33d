"""Compiled kernels on disk, valid for as long as no module that they depend on changes.

Numba's own cache hashes only the file of a kernel. It does not notice an edit in a module that the kernel calls into or
takes a constant from, and would then run a stale kernel: a wrong simulation. Here the stamp of a kernel covers its
module and all modules that this one imports at top level, directly or not, within the same packages. An edit thus
recompiles the kernels that depend on it, and no others.
"""

import hashlib
import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

from numba.core.caching import CompileResultCacheImpl, FunctionCache, InTreeCacheLocator

PACKAGE = Path(__file__).parent
FALLBACK = Path.home() / ".cache" / "drone_engine"  # where the installation is read-only
GENERATED = "generated_stages"  # folder of the modules that program.py writes
_IMPORT = re.compile(rb"^(?:from[ ]+([\w.]+)[ ]+import[ ]+(?:\(([^)]*)\)|([^\n(]*))|import[ ]+([\w.]+))", re.MULTILINE)


def _file_of(module: str) -> Path | None:
    """Source file of an imported module; None if it is not a Python file."""
    path = getattr(sys.modules.get(module), "__file__", None)
    return Path(path) if path and path.endswith(".py") else None


@cache
def _imports(path: Path) -> tuple[bytes, tuple[str, ...]]:
    """The text of a file, and the names of modules that it may import at top level."""
    text = path.read_bytes()
    names: list[str] = []
    for package, several, one, plain in _IMPORT.findall(text):
        module = (package or plain).decode()
        members = re.sub(r"#[^\n]*", "", (several or one).decode()).split(",")
        names += [module, *(f"{module}.{name.split()[0]}" for name in members if name.strip())]
    return text, tuple(names)


def dependencies(path: Path) -> list[Path]:
    """A file and all files that it imports, directly or not: those of the engine, of its own package, and of any module
    that uses the engine, such as a user's effect."""
    found = [path]
    for file in found:  # grows meanwhile
        own = _package_of(file)
        for module in _imports(file)[1]:
            other = _file_of(module)
            if other and other not in found and (
                    PACKAGE in other.parents or own in other.parents or b"drone_engine" in _imports(other)[0]):
                found.append(other)
    return found


def _package_of(path: Path) -> Path:
    """The folder of the top-level package that a file belongs to; the file itself if it belongs to none."""
    if not (path.parent / "__init__.py").exists():
        return path
    folder = path.parent
    while (folder.parent / "__init__.py").exists():
        folder = folder.parent
    return folder


@cache
def stamp(path: Path) -> str:
    """SHA-256 over the texts of a file and its dependencies, in hexadecimal."""
    digest = hashlib.sha256()
    for file in sorted(dependencies(path)):
        digest.update(_imports(file)[0])
    return digest.hexdigest()


@cache
def folder_of(path: Path) -> Path:
    """Folder for the compiled kernels of a file: its __pycache__, or one below FALLBACK if that is not writable."""
    beside = path.parent / "__pycache__"
    try:
        beside.mkdir(exist_ok=True)
        probe = beside / ".writable"
        probe.touch()
        probe.unlink(missing_ok=True)
    except OSError:
        return FALLBACK / hashlib.sha256(str(path.parent).encode()).hexdigest()[:12]
    return beside


class _Locator(InTreeCacheLocator):
    def __init__(self, function: Any, file: str) -> None:
        super().__init__(function, file)
        self._cache_path = str(folder_of(Path(file)))

    def get_source_stamp(self) -> str:
        return stamp(Path(self._py_file))


class _Implementation(CompileResultCacheImpl):
    _locator_classes = (_Locator,)


class KernelCache(FunctionCache):
    """Numba's on-disk cache of one function, invalidated by `stamp`."""

    _impl_class = _Implementation

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """As numba's, but an index that refers to a module or record that no longer exists counts as out of date."""
        try:
            return super().load_overload(sig, target_context)
        except (ImportError, AttributeError):
            self.flush()
            return None


def generated_folder() -> Path:
    """Folder of the modules that program.py writes."""
    return folder_of(PACKAGE / "program" / "program.py") / GENERATED


def compiled_before() -> bool:
    """Whether compiled stages are on disk: a start then takes seconds rather than minutes."""
    return any(generated_folder().rglob("*.nbc"))
