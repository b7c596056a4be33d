"""Scene data written in Python, converted to the plain data that a YAML file holds."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from drone_engine.scene.strict_yaml import DEPTH_LIMIT


def plain(value: Any, key: str = "", depth: int = 0) -> Any:
    """Dicts, lists, numbers, strings, booleans and None from the same in Python's and NumPy's types.

    Also accepts tuples, arrays, paths and parts of the schema, such as `Camera(...)`. Raises ValueError in one line
    for anything else, naming its key.
    """
    where = f"{key}: " if key else ""
    if depth > DEPTH_LIMIT:
        raise ValueError(f"{where}nested in more than {DEPTH_LIMIT} levels")
    if isinstance(value, BaseModel):
        value = value.model_dump(exclude_unset=True)
    elif isinstance(value, np.ndarray):
        value = value.tolist()
    elif isinstance(value, np.generic):
        value = value.item()
    elif isinstance(value, Path):
        value = str(value)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Mapping):
        for name in value:
            if not isinstance(name, str):
                raise ValueError(f"{where}expected strings as keys, got {name!r}")
        return {str(name): plain(inner, f"{key}.{name}" if key else name, depth + 1) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner, f"{key}.{i}" if key else str(i), depth + 1) for i, inner in enumerate(value)]
    raise ValueError(f"{where}expected a mapping, a sequence, a number, a string, a boolean or None, "
                     f"got {type(value).__name__}")
