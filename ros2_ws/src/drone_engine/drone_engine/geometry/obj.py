"""The text of an OBJ file: its vertices, triangles and the materials that it names."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Self

import numpy as np

from drone_engine.arrays import Floats, Integers


class MeshError(ValueError):
    """A model that cannot be used, in one line: the file, and what is wrong with it."""


@dataclass(frozen=True)
class Obj:
    """One reading of an OBJ file; what is asked of it is parsed once."""

    path: Path
    text: str

    @classmethod
    def read(cls, path: Path) -> Self:
        """Raises MeshError for a file that cannot be read."""
        try:
            return cls(path, path.read_text(encoding="utf-8", errors="replace"))
        except OSError as error:
            raise MeshError(f"{path}: {error.strerror}") from None

    @cached_property
    def vertices(self) -> Floats:
        """The vertices (v, 3) in m, in the order of the file. Raises MeshError."""
        rows = [line.split()[1:4] for line in self._lines if line.startswith("v ")]
        try:
            vertices = np.array(rows, dtype=np.float64)
        except ValueError:
            raise MeshError(f"{self.path}: a vertex is not three numbers") from None
        check_vertices(self.path, vertices)
        return vertices

    @cached_property
    def faces(self) -> Integers:
        """Triangles (f, 3) of indices into `vertices`; polygons are split into fans.

        Faces with corners that are no numbers are left out; indices out of range are kept.
        """
        faces, known = [], 0
        for line in self._lines:
            if line.startswith("f "):
                corners = [part.split("/")[0] for part in line.split()[1:]]
                if all(corner.removeprefix("-").isdigit() for corner in corners):
                    # Numbers count from 1, or, if negative, backwards from the latest vertex.
                    first, *rest = (int(corner) + (known if corner[0] == "-" else -1) for corner in corners)
                    faces += [(first, *pair) for pair in pairwise(rest)]
            known += line.startswith("v ")
        return np.array(faces, np.int64).reshape(-1, 3)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of the box around the vertices, (3,) each, in m. Raises MeshError."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @property
    def has_normals(self) -> bool:
        """Whether the file has vertex normals."""
        return "\nvn " in self.text

    @property
    def libraries(self) -> list[str]:
        """Names of the MTL files, in the order of the file."""
        return [line[7:].strip() for line in self._lines if line.startswith("mtllib ")]

    @property
    def materials(self) -> set[str]:
        """Names of the materials that faces use."""
        return {line[7:].strip() for line in self._lines if line.startswith("usemtl ")}

    @cached_property
    def _lines(self) -> list[str]:
        return self.text.splitlines()


def check_vertices(path: Path, vertices: Floats) -> None:
    """Raises MeshError unless there are vertices, of three finite numbers each."""
    if vertices.ndim != 2 or vertices.shape[1:] != (3,):
        raise MeshError(f"{path}: has no vertices of three numbers")
    if not np.isfinite(vertices).all():
        raise MeshError(f"{path}: vertex {int(np.argmin(np.isfinite(vertices).all(axis=1))) + 1} is not finite")
