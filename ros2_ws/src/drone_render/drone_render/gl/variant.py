"""Variants of shader programs, assembled from the files in shaders/ and the features of a scene."""

import re
from dataclasses import dataclass
from importlib import resources

VERSION = "#version 330 core\n"
INCLUDE = re.compile(r'^#include "([a-z_]+\.glsl)"$', re.MULTILINE)


@dataclass(frozen=True)
class Variant:
    """A program: the files shaders/<name>.vert and shaders/<name>.frag with a set of defines."""

    name: str
    defines: frozenset[tuple[str, int]] = frozenset()

    @classmethod
    def of(cls, name: str, **defines: int | bool) -> "Variant":
        """A variant with these defines: False is not defined, True is 1, and numbers, 0 included, are themselves."""
        return cls(name, frozenset((key, int(value)) for key, value in defines.items() if value is not False))

    def sources(self) -> tuple[str, str]:
        """GLSL text of the vertex shader and the fragment shader."""
        vertex, fragment = (_expand(f"{self.name}.{kind}", self.defines) for kind in ("vert", "frag"))
        return vertex, fragment


def _expand(file: str, defines: frozenset[tuple[str, int]]) -> str:
    head = "".join(f"#define {key} {value}\n" for key, value in sorted(defines))
    return VERSION + head + INCLUDE.sub(lambda match: _read(match[1]), _read(file))


def _read(file: str) -> str:
    return (resources.files("drone_render.gl") / "shaders" / file).read_text(encoding="utf-8")
