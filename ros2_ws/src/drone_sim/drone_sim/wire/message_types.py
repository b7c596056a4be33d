"""Message types by name ('geometry_msgs/msg/Twist'): their class, definition and hash, from what is installed."""

import json
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

SEPARATOR = "=" * 80


class UnknownTypeError(LookupError):
    """A message type that is not installed here, in one line."""


def full_name(name: str) -> str:
    """'geometry_msgs/Twist', as people abbreviate it, becomes 'geometry_msgs/msg/Twist'."""
    package, _, message = name.partition("/")
    return f"{package}/msg/{message}" if message and "/" not in message else name


@cache
def message_class(name: str) -> type[Any]:
    """The Python class of a type. Raises UnknownTypeError."""
    package, message = _split(name)
    try:
        found: type[Any] = getattr(import_module(f"{package}.msg"), message)
    except (ImportError, AttributeError):
        raise UnknownTypeError(f"no message type '{name}' is installed here") from None
    return found


@cache
def definition(name: str) -> str:
    """The text of the .msg file and of those that it refers to, as MCAP's encoding 'ros2msg' asks for it."""
    parts = [_share(name, "msg").read_text()]
    for reference in _description(name)["type_description_msg"]["referenced_type_descriptions"]:
        package, message = _split(reference["type_name"])
        parts.append(f"{SEPARATOR}\nMSG: {package}/{message}\n" + _share(reference["type_name"], "msg").read_text())
    return "\n".join(parts)


@cache
def type_hash(name: str) -> str:
    """The hash of a type by REP-2011: 'RIHS01_' and 64 hexadecimal digits."""
    return next(str(each["hash_string"]) for each in _description(name)["type_hashes"] if each["type_name"] == name)


def _split(name: str) -> tuple[str, str]:
    """Package and message of a full name."""
    match name.split("/"):
        case [package, "msg", message] if package.isidentifier() and message.isidentifier():
            return package, message
    raise UnknownTypeError(f"'{name}' is no message type; one is written like geometry_msgs/msg/Twist")


def _description(name: str) -> dict[str, Any]:
    description: dict[str, Any] = json.loads(_share(name, "json").read_text())
    return description


def _share(name: str, suffix: str) -> Path:
    """A file about a type in the share folder of its package."""
    package, message = _split(name)
    try:
        path = Path(get_package_share_directory(package)) / "msg" / f"{message}.{suffix}"
    except (OSError, PackageNotFoundError):
        raise UnknownTypeError(f"package '{package}' of '{name}' is not in AMENT_PREFIX_PATH") from None
    if not path.is_file():
        raise UnknownTypeError(f"no {message}.{suffix} is installed for '{name}'")
    return path
