"""The words of a scene file: its kinds of numbers and names, and the one line that says what is wrong with them."""

from typing import Annotated, Any, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError

Vector = tuple[float, float, float]
Unit = Annotated[float, Field(ge=0.0, le=1.0)]
Colour = tuple[Unit, Unit, Unit]
Rate = Annotated[float, Field(ge=0.01, le=10_000.0)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=100)]
Topic = Annotated[str, Field(pattern=r"^/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*$", max_length=200)]
Mass = Annotated[float, Field(ge=1e-6, le=1e9)]  # kg
Place = Annotated[float, Field(ge=-1e7, le=1e7)]  # m, where a number still tells a hundredth of a micrometre
Pose = tuple[Place, Place, Place, float, float, float]
ORIGIN: Pose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


FOUND = "found"  # marks what is known of a file without standing in it


class Strict(BaseModel):
    """Unknown keys, strings for numbers and non-finite numbers are errors; nothing changes after loading."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


def first_error(error: ValidationError, model: Any, prefix: tuple[str, ...] = ()) -> str:
    """The first thing that is wrong with a `model`, or another type, in one line: its key after the prefix, and what
    was expected."""
    first = error.errors(include_url=False)[0]
    message = first["msg"].removeprefix("Value error, ")
    if first["type"] == "extra_forbidden":
        message = "unknown key"
        if part := _part(model, first["loc"][:-1]):
            words = sorted(key for key, field in part.model_fields.items() if FOUND not in field.metadata)
            message += "; allowed are " + (", ".join(words) or "none")
    elif first["type"] == "missing" and isinstance(first["loc"][-1], int):
        message = "expected more numbers"
    elif first["type"] not in ("value_error", "missing"):
        message += f", got {quoted(first['input'])}"
    key = ".".join(str(part) for part in (*prefix, *first["loc"]))
    return f"{key}: {message}" if key else message


def quoted(value: Any) -> str:
    """What stands in a file, as an error shows it: as YAML has it, an empty place is None."""
    return "nothing" if value is None else repr(str(value)[:60])


def _part(kind: Any, loc: tuple[int | str, ...]) -> type[BaseModel] | None:
    """The model that stands at a key path below a type."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        if not loc:
            return kind
        field = kind.model_fields.get(str(loc[0]))
        return _part(field.annotation, loc[1:]) if field else None
    below = loc[1:] if get_origin(kind) in (dict, tuple) else loc
    return next((part for inner in get_args(kind) if (part := _part(inner, below))), None)
