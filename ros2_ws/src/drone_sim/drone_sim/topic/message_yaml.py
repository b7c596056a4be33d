"""Converts messages to YAML and back, checked against their types."""

import array
from collections.abc import Sequence
from typing import Any

import numpy as np
import yaml

from drone_sim.wire.message_types import full_name, message_class

LONG = 128  # items of an array or characters of a string; longer ones are shortened

RANGES = {"octet": (0, 255)}
for _bits in (8, 16, 32, 64):
    RANGES[f"uint{_bits}"] = (0, 2**_bits - 1)
    RANGES[f"int{_bits}"] = (-(2 ** (_bits - 1)), 2 ** (_bits - 1) - 1)


class FieldError(ValueError):
    """A field that a message does not have, or a value of another type, in one line."""


def as_data(value: Any, full: bool = False) -> Any:
    """Converts a message or a field into dictionaries, lists, numbers and strings. full: do not shorten long ones."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: as_data(getattr(value, name), full) for name in _fields(value)}
    if isinstance(value, str):
        return value if full or len(value) <= LONG else value[:LONG] + "..."
    if isinstance(value, bytes):
        return list(value) if len(value) != 1 else value[0]
    if isinstance(value, np.ndarray | array.array | list | tuple):
        items = value if full else value[:LONG]
        data = [as_data(item, full) for item in (items.tolist() if isinstance(items, np.ndarray) else items)]
        return data if len(items) == len(value) else [*data, "..."]
    return value


def dump(data: Any) -> str:
    """The YAML text as `ros2 topic echo` prints it, fields in the order of the definition."""
    if not isinstance(data, dict | list):
        return f"{data}\n"
    text: str = yaml.dump(data, Dumper=yaml.CSafeDumper, sort_keys=False, allow_unicode=True, width=1000)
    return text


def pick(message: Any, path: str) -> Any:
    """The field at a path such as 'pose.position' or 'transforms[0].header', None beyond the end of a list.

    Raises FieldError.
    """
    value = message
    for part in path.replace("[", ".").replace("]", "").split("."):
        if part.isdigit() and isinstance(value, Sequence | np.ndarray):
            if int(part) >= len(value):
                return None
            value = value[int(part)]
        elif part in _fields(value):
            value = getattr(value, part)
        elif isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) and len(value) == 0:
            return None
        else:
            raise FieldError(_no_field(path, part, value))
    return value


def fill(message: Any, values: Any, path: str = "") -> None:
    """Sets the fields named in `values`; the others keep their values. path: of `message`. Raises FieldError."""
    if not isinstance(values, dict):
        raise FieldError(f"{path or 'message'}: expected fields ({', '.join(_fields(message))}), got {values!r}")
    for name, value in values.items():
        here = f"{path}.{name}" if path else str(name)
        if name not in _fields(message):
            raise FieldError(_no_field(here, name, message))
        kind = _fields(message)[name]
        current = getattr(message, name)
        if hasattr(current, "get_fields_and_field_types"):
            fill(current, value, here)
            continue
        setattr(message, name, _converted(kind, current, value, here))


def _converted(kind: str, current: Any, value: Any, path: str) -> Any:
    """Converts a value to the type of a field: integers to floats, lists to arrays and messages. Raises FieldError."""
    if isinstance(current, np.ndarray | array.array | list):
        if not isinstance(value, list):
            raise FieldError(f"{path}: expected a list ({kind}), got {value!r}")
        item = kind.removeprefix("sequence<").split("[")[0].split(",")[0].rstrip(">").strip()
        if "/" in item:
            return [_message(item, each, f"{path}[{index}]") for index, each in enumerate(value)]
        items = [_scalar(item, each, f"{path}[{index}]") for index, each in enumerate(value)]
        if isinstance(current, np.ndarray) and len(items) != len(current):
            raise FieldError(f"{path}: expected {len(current)} items ({kind}), got {len(items)}")
        return np.array(items, dtype=current.dtype) if isinstance(current, np.ndarray) else items
    return _scalar(kind, value, path)


def _scalar(kind: str, value: Any, path: str) -> Any:
    """Checks a single value: the generated message classes do not, and crash on publishing. Raises FieldError."""
    if kind in RANGES and type(value) is int and RANGES[kind][0] <= value <= RANGES[kind][1]:
        return bytes([value]) if kind == "octet" else value
    if kind in ("float", "double") and type(value) in (int, float):
        return float(value)
    if (kind == "boolean" and type(value) is bool) or (kind.startswith(("string", "wstring")) and type(value) is str):
        return value
    raise FieldError(f"{path}: expected {kind}, got {value!r}")


def _message(kind: str, values: Any, path: str) -> Any:
    message = message_class(full_name(kind))()
    fill(message, values, path)
    return message


def _fields(message: Any) -> dict[str, str]:
    fields: dict[str, str] = getattr(message, "get_fields_and_field_types", dict)()
    return fields


def _no_field(path: str, name: str, message: Any) -> str:
    fields = ", ".join(_fields(message))
    return f"{path}: expected {f'one of {fields}' if fields else 'no field, as it is a value'}, got '{name}'"
