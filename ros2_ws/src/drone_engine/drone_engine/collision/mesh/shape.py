"""The collision shape of a mesh: octree, topology, bounding box and bounding sphere."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.mesh import octree, traversal
from drone_engine.collision.mesh.topology import Topology, find_topology
from drone_engine.collision.placement import set_all_axes
from drone_engine.geometry import mesh


def axes_at(poses: Floats) -> Floats:
    """The axes of a body in the world at poses (n, 7): (n, 3, 3), one a row."""
    axes = np.empty((len(poses), 3, 3))
    set_all_axes(np.ascontiguousarray(poses[:, 3:]), axes)
    return axes


def _transform_points(axes: Floats, poses: Floats, points: Floats) -> Floats:
    """Points (..., 3) of a body in the world at poses (n, 7), with the roundings of `transforms.transform_point`:
    (n, 3), or (k, ..., 3) for one pose."""
    x, y, z = (points[..., k, None] for k in range(3))
    return (axes[:, 0] * x + axes[:, 1] * y + axes[:, 2] * z) + poses[:, :3]


@dataclass(frozen=True, eq=False)
class Shape:
    """The collision shape of a mesh. The octree of each mesh is built once per process. Poses are rows x y z m and a
    unit quaternion x y z w."""

    tree: octree.Octree

    @classmethod
    def of(cls, vertices: ArrayLike, faces: ArrayLike) -> Self:
        """From vertices (v, 3) in m and faces (f, 3), counter-clockwise seen from outside. Raises ValueError unless
        they are a mesh."""
        return cls(octree.build_cached(vertices, faces))

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """From an OBJ file. Raises mesh.MeshError for a file that cannot be read."""
        return cls.of(*mesh.surface(Path(path)))

    @cached_property
    def topology(self) -> Topology:
        """Normals, and the triangles that own each corner and edge."""
        return find_topology(self.tree.corners)

    @cached_property
    def reach(self) -> float:
        """Upper bound of the distance of the mesh's points from its origin, m."""
        box = self.tree.box[0]
        return float(np.linalg.norm(np.abs(box[:3]) + box[3:]))

    def bounding_boxes(self, poses: Floats) -> tuple[Floats, Floats, Floats]:
        """The bounding box at poses (n, 7): centers (n, 3), axes (n, 3, 3), half extents (n, 3), m, grown by the
        rounding of leaf boxes."""
        box = self.tree.box[0]
        axes = axes_at(poses)
        return _transform_points(axes, poses, box[:3]), axes, box[3:] + 2.0 * self._pad(poses)[:, None]

    def leaf_boxes(self, poses: Floats, nodes: Integers) -> tuple[Floats, Floats, Floats]:
        """The boxes of leaves, nodes (k,), at one pose (1, 7), as `bounding_boxes`, grown by the rounding of
        triangles."""
        box = self.tree.box[nodes]
        axes = axes_at(poses)
        return (_transform_points(axes, poses, box[:, :3]), np.repeat(axes, len(nodes), axis=0),
                box[:, 3:] + self._pad(poses)[:, None])

    def bounding_spheres(self, poses: Floats) -> tuple[Floats, Floats]:
        """The bounding sphere at poses (n, 7): centers (n, 3), radii (n,), m, grown by the rounding of boxes."""
        center, _, _ = self.bounding_boxes(poses)
        return center, np.linalg.norm(self.tree.box[0, 3:]) + 5.0 * self._pad(poses)

    def _pad(self, poses: Floats) -> Floats:
        """Growth of leaf boxes at poses (n, 7), (n,) m."""
        distance: Floats = np.linalg.norm(poses[:, :3], axis=1)
        return traversal.PAD * (distance + self.reach)
