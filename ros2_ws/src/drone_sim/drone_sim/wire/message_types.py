"""Installed message types by name, such as geometry_msgs/msg/Twist: their class, definition and hash."""

import json
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

SEPARATOR = "=" * 80


class UnknownTypeError(LookupError):
    """A message type that is not installed, in one line."""


def full_name(name: str) -> str:
    """Expands the abbreviation geometry_msgs/Twist to geometry_msgs/msg/Twist; returns other names unchanged."""
    package, _, message = name.partition("/")
    return f"{package}/msg/{message}" if message and "/" not in message else name


@cache
def message_class(name: str) -> type[Any]:
    """The Python class of a type. Raises UnknownTypeError."""
    package, message = _split(name)
    try:
        found: type[Any] = getattr(import_module(f"{package}.msg"), message)
    except (ImportError, AttributeError):
        raise UnknownTypeError(f"message type: expected an installed one, got '{name}'") from None
    return found


@cache
def definition(name: str) -> str:
    """The text of the .msg file and of those it refers to, in MCAP's encoding 'ros2msg'. Raises UnknownTypeError."""
    parts = [_share(name, "msg").read_text()]
    for reference in _description(name)["type_description_msg"]["referenced_type_descriptions"]:
        package, message = _split(reference["type_name"])
        parts.append(f"{SEPARATOR}\nMSG: {package}/{message}\n" + _share(reference["type_name"], "msg").read_text())
    return "\n".join(parts)


@cache
def type_hash(name: str) -> str:
    """The hash of a type by REP-2011: 'RIHS01_' and 64 hexadecimal digits. Raises UnknownTypeError."""
    return next(str(each["hash_string"]) for each in _description(name)["type_hashes"] if each["type_name"] == name)


def _split(name: str) -> tuple[str, str]:
    """Package and message of a full name. Raises UnknownTypeError."""
    match name.split("/"):
        case [package, "msg", message] if package.isidentifier() and message.isidentifier():
            return package, message
    raise UnknownTypeError(f"message type: expected a name such as geometry_msgs/msg/Twist, got '{name}'")


def _description(name: str) -> dict[str, Any]:
    description: dict[str, Any] = json.loads(_share(name, "json").read_text())
    return description


def _share(name: str, suffix: str) -> Path:
    """A file of a type in the share folder of its package. Raises UnknownTypeError."""
    package, message = _split(name)
    try:
        path = Path(get_package_share_directory(package)) / "msg" / f"{message}.{suffix}"
    except (OSError, PackageNotFoundError):
        raise UnknownTypeError(f"{name}: expected package '{package}' in AMENT_PREFIX_PATH, found none") from None
    if not path.is_file():
        raise UnknownTypeError(f"{name}: expected an installed {message}.{suffix}, found none")
    return path
