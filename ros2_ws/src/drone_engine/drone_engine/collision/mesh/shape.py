"""A mesh as the collision detection sees it: octree, surface, box and ball."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.mesh import octree, traversal
from drone_engine.collision.mesh import topology as surface
from drone_engine.collision.placement import set_all_axes
from drone_engine.geometry import mesh


def axes_at(poses: Floats) -> Floats:
    """A body's axes at poses (n, 7): (n, 3, 3), one a row."""
    axes = np.empty((len(poses), 3, 3))
    set_all_axes(np.ascontiguousarray(poses[:, 3:]), axes)
    return axes


def placed(axes: Floats, poses: Floats, points: Floats) -> Floats:
    """Points (..., 3) of a body at poses (n, 7) in the world, rounded as everywhere: (n, 3), or (k, ..., 3) for one."""
    x, y, z = (points[..., k, None] for k in range(3))
    return (axes[:, 0] * x + axes[:, 1] * y + axes[:, 2] * z) + poses[:, :3]


@dataclass(frozen=True, eq=False)
class Shape:
    """A mesh as the collision detection sees it. Made from the same numbers, its octree is built once."""

    tree: octree.Octree

    @classmethod
    def of(cls, vertices: ArrayLike, faces: ArrayLike) -> Self:
        """From vertices (v, 3) in m and triangles (f, 3), counter-clockwise seen from outside. Raises ValueError."""
        return cls(octree.of(vertices, faces))

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """From an OBJ file. Raises mesh.MeshError."""
        return cls.of(*mesh.surface(Path(path)))

    @cached_property
    def surface(self) -> surface.Surface:
        """Normals, and who owns which corner and edge."""
        return surface.describe(self.tree.corners)

    @cached_property
    def reach(self) -> float:
        """How far the box reaches from the shape's origin, m."""
        box = self.tree.box[0]
        return float(np.linalg.norm(np.abs(box[:3]) + box[3:]))

    def boxes(self, poses: Floats) -> tuple[Floats, Floats, Floats]:
        """The box at poses (n, 7): centres (n, 3), axes (n, 3, 3), half extents (n, 3), grown by what rounding may move
        a leaf."""
        box = self.tree.box[0]
        axes = axes_at(poses)
        return placed(axes, poses, box[:3]), axes, box[3:] + 2.0 * self._pad(poses)[:, None]

    def leaves(self, poses: Floats, nodes: Integers) -> tuple[Floats, Floats, Floats]:
        """The boxes of nodes (k,) at one pose (1, 7), as `boxes`, grown by what rounding may move a triangle."""
        box = self.tree.box[nodes]
        axes = axes_at(poses)
        return (placed(axes, poses, box[:, :3]), np.repeat(axes, len(nodes), axis=0),
                box[:, 3:] + self._pad(poses)[:, None])

    def balls(self, poses: Floats) -> tuple[Floats, Floats]:
        """The bounding sphere at poses (n, 7): centres (n, 3), radii (n,), grown likewise."""
        centre, _, _ = self.boxes(poses)
        return centre, np.linalg.norm(self.tree.box[0, 3:]) + 5.0 * self._pad(poses)

    def _pad(self, poses: Floats) -> Floats:
        away: Floats = np.linalg.norm(poses[:, :3], axis=1)
        return traversal.PAD * (away + self.reach)
