"""Shader programs, put together from the files in shaders/ and what a scene calls for."""

import re
from dataclasses import dataclass
from importlib import resources

VERSION = "#version 330 core\n"
INCLUDE = re.compile(r'^#include "([a-z_]+\.glsl)"$', re.MULTILINE)


@dataclass(frozen=True)
class Variant:
    """A program: the pair of files shaders/<name>.vert and .frag, with each define set to its number."""

    name: str
    defines: frozenset[tuple[str, int]] = frozenset()

    @classmethod
    def of(cls, name: str, **defines: int | bool) -> "Variant":
        """What is False is not defined; True is 1. A number, 0 as well, is."""
        return cls(name, frozenset((key, int(value)) for key, value in defines.items() if value is not False))

    def has(self, define: str) -> bool:
        """Whether the define is set."""
        return any(key == define for key, _ in self.defines)

    def sources(self) -> tuple[str, str]:
        """The text of the vertex and of the fragment shader, without what is not defined."""
        vertex, fragment = (_expand(f"{self.name}.{kind}", self.defines) for kind in ("vert", "frag"))
        return vertex, fragment


def _expand(file: str, defines: frozenset[tuple[str, int]]) -> str:
    head = "".join(f"#define {key} {value}\n" for key, value in sorted(defines))
    return VERSION + head + INCLUDE.sub(lambda match: _read(match[1]), _read(file))


def _read(file: str) -> str:
    return (resources.files("drone_render") / "shaders" / file).read_text(encoding="utf-8")
