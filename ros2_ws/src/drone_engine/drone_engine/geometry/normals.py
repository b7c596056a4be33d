"""Vertex normals of meshes that come without any."""

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Floats


def vertex_normals(vertices: Floats, faces: NDArray[np.integer]) -> Floats:
    """Unit normals (v, 3) of vertices (v, 3): the mean of the normals of their triangles (f, 3), weighted by area.

    Vertices without area around them get +z. (trimesh has the same, but needs SciPy for it.)
    """
    first, second, third = (vertices[faces[:, corner]] for corner in range(3))
    sums = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(sums, faces[:, corner], np.cross(second - first, third - first))
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.where(length > 0, sums / np.where(length > 0, length, 1.0), [0.0, 0.0, 1.0])
