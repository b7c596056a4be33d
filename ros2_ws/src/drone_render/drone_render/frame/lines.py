"""Lines and spheres drawn over the picture, such as those of the debug view."""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np
import numpy.typing as npt

from drone_engine.arrays import Floats, Integers
from drone_render.arrays import Float32s

WORLD = "world"


class Lines(NamedTuple):
    """n lines and k spheres in the world, m. Colors are red, green, blue, alpha from 0 to 1."""

    ends: Float32s  # (n, 2, 3)
    colors: Float32s  # (n, 4)
    widths: Integers  # (n,) pixels
    centers: Float32s  # (k, 3)
    radii: Float32s  # (k,)
    sphere_colors: Float32s  # (k, 4)

    @classmethod
    def of(cls, ends: npt.ArrayLike, colors: npt.ArrayLike, width: int = 2) -> Self:
        """Lines of one width in pixels, without spheres; ends: (n, 2, 3) m, colors: (n, 4)."""
        lines, none = np.asarray(ends, np.float32), np.empty((0, 4), np.float32)
        widths = np.full(len(lines), width, np.int64)
        return cls(lines, np.asarray(colors, np.float32), widths, none[:, :3], none[:, 0], none)


class Shapes(NamedTuple):
    """n lines and k spheres of m markers, each in the frame of its marker."""

    frames: tuple[str, ...]  # (m,) names of the markers' frames
    matrices: Floats  # (m, 4, 4) of the markers in their frames
    ends: Float32s  # (n, 2, 3) m
    colors: Float32s  # (n, 4)
    widths: Integers  # (n,) pixels
    line_marker: Integers  # (n,) marker of each line
    sphere_marker: Integers  # (k,) marker of each sphere
    radii: Float32s  # (k,) m
    sphere_colors: Float32s  # (k, 4)

    def placed(self, names: Sequence[str], world: Floats) -> Lines:
        """The shapes in the world; names, world: names and matrices (o, 4, 4) of the objects.

        Shapes in a frame that is neither the world nor one of the objects are left out.
        """
        row = {name: i for i, name in enumerate(names, 1)} | {WORLD: 0}
        rows = np.array([row.get(frame, -1) for frame in self.frames], np.int64)
        known = rows >= 0
        matrix = (np.concatenate([np.eye(4)[None], world])[rows] @ self.matrices).astype(np.float32)
        lines, spheres = known[self.line_marker], known[self.sphere_marker]
        line_matrix = matrix[self.line_marker[lines]]
        ends = self.ends[lines] @ line_matrix[:, :3, :3].transpose(0, 2, 1) + line_matrix[:, None, :3, 3]
        centers = matrix[self.sphere_marker[spheres], :3, 3]
        return Lines(ends, self.colors[lines], self.widths[lines], centers, self.radii[spheres],
                     self.sphere_colors[spheres])
