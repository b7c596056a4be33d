"""One-line messages for scenes that are not valid."""

from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

from drone_engine.scene.fields import FOUND


class SceneError(ValueError):
    """A scene that is not valid, in one line: the file or name, the key, what was expected and what was found."""


def first_error(error: ValidationError, model: Any, prefix: tuple[str, ...] = ()) -> str:
    """The first error of validating a `model` (or another type) in one line: its key after the prefix, then what was
    expected and found."""
    first = error.errors(include_url=False)[0]
    message = first["msg"].removeprefix("Value error, ")
    if first["type"] == "extra_forbidden":
        message = "unknown key"
        if part := _part(model, first["loc"][:-1]):
            allowed = sorted(key for key, field in part.model_fields.items() if FOUND not in field.metadata)
            message += "; allowed are " + (", ".join(allowed) or "none")
    elif first["type"] == "missing" and isinstance(first["loc"][-1], int):
        message = "expected more numbers"
    elif first["type"] not in ("value_error", "missing"):
        message += f", got {quoted(first['input'])}"
    key = ".".join(str(part) for part in (*prefix, *first["loc"]))
    return f"{key}: {message}" if key else message


def quoted(value: Any) -> str:
    """A value as an error shows it: shortened and quoted; None, an empty place in YAML, is 'nothing'."""
    return "nothing" if value is None else repr(str(value)[:60])


def _part(kind: Any, loc: tuple[int | str, ...]) -> type[BaseModel] | None:
    """The pydantic model at a key path below a type; None if there is none."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        if not loc:
            return kind
        field = kind.model_fields.get(str(loc[0]))
        return _part(field.annotation, loc[1:]) if field else None
    below = loc[1:] if get_origin(kind) in (dict, tuple) else loc
    return next((part for inner in get_args(kind) if (part := _part(inner, below))), None)
