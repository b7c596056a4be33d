"""User extensions: modules and classes from a user's own package that a scene names.

A name with a dot, `my_package.spring`, is a module that can be imported, from the environment or from the folder of the
scene file. A name without one that is not built in is an entry point, in the group 'drone_engine.effects' for effects,
for instance, so that an installed package can offer a short name; or a module in the folder of the scene file.
"""

import sys
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.metadata import entry_points
from importlib.util import module_from_spec
from pathlib import Path
from typing import Any


class ExtensionError(ValueError):
    """Why an extension cannot be used; one line without the scene's name and key."""


def find(kind: str, name: str, folder: Path, known: tuple[str, ...] = (), package: str = "drone_engine") -> Any:
    """What a name leads to: a module, or whatever an entry point loads.

    kind: 'effects', 'flight_models', 'behaviors'...; folder: of the scene file; known: what is built in, for the error;
    package: the entry points are those of the group '<package>.<kind>'. Raises ExtensionError.
    """
    try:
        if "." in name:
            return _module(name, folder)
        for point in entry_points(group=f"{package}.{kind}", name=name):
            return point.load()
        if PathFinder.find_spec(name, [str(folder)]) is not None:
            return _module(name, folder)
    except ExtensionError:
        raise
    except Exception as error:  # whatever the user's module raises while it is imported
        raise ExtensionError(f"cannot be imported: {type(error).__name__}: {_line(error)}") from error
    built_in = f"; there are {', '.join(known)}" if known else ""
    raise ExtensionError(f"unknown {_singular(kind).replace('_', ' ')}{built_in}")


def member(found: Any, name: str, key: str) -> Any:
    """An attribute that an extension needs to have. Raises ExtensionError."""
    if not hasattr(found, key):
        raise ExtensionError(f"'{name}' has no '{key}'")
    return getattr(found, key)


def _module(name: str, folder: Path) -> Any:
    """Imports a module from the environment, or else from a folder. Raises ExtensionError and what the import
    raises."""
    top = name.partition(".")[0]
    if top not in sys.modules and not _importable(top):
        spec = PathFinder.find_spec(top, [str(folder)])
        if spec is None or spec.loader is None:
            raise ExtensionError(f"no module '{top}', neither in the environment nor in {folder}")
        package = module_from_spec(spec)
        sys.modules[top] = package
        try:
            spec.loader.exec_module(package)
        except BaseException:
            del sys.modules[top]
            raise
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name is None or not name.startswith(error.name):
            raise
        parent, _, last = name.rpartition(".")
        if error.name == name and hasattr(sys.modules.get(parent), last):  # a class or an object in a module
            return getattr(sys.modules[parent], last)
        raise ExtensionError(f"no module '{error.name}'") from None


def _importable(top: str) -> bool:
    return PathFinder.find_spec(top) is not None or top in sys.builtin_module_names


def _singular(kind: str) -> str:
    return kind.removesuffix("es" if kind.endswith("sses") else "s")


def _line(error: BaseException) -> str:
    return (str(error).splitlines() or [""])[0]
