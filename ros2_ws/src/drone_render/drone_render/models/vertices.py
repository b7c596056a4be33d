"""Vertex attributes that models lack: tangents for normal maps, and bounds for culling."""

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.geometry.mesh import Part
from drone_render.arrays import Float32s


def tangents(part: Part) -> Float32s:
    """Unit tangents (n, 4) of a part's vertices: x y z along increasing u, and the sign (1 or -1) of the bitangent.

    After Lengyel, Computing Tangent Space Basis Vectors for an Arbitrary Mesh.
    """
    corners, uv = part.vertices[part.faces].astype(np.float64), part.uv[part.faces].astype(np.float64)
    edges, spans = corners[:, 1:] - corners[:, :1], uv[:, 1:] - uv[:, :1]
    area = spans[:, 0, 0] * spans[:, 1, 1] - spans[:, 1, 0] * spans[:, 0, 1]
    scale = np.where(np.abs(area) > 1e-12, 1 / np.where(area == 0, 1, area), 0.0)[:, None]
    along_u = (edges[:, 0] * spans[:, 1, 1, None] - edges[:, 1] * spans[:, 0, 1, None]) * scale
    along_v = (edges[:, 1] * spans[:, 0, 0, None] - edges[:, 0] * spans[:, 1, 0, None]) * scale
    u, v = np.zeros((2, len(part.vertices), 3))
    for corner in range(3):
        np.add.at(u, part.faces[:, corner], along_u)
        np.add.at(v, part.faces[:, corner], along_v)
    normals = part.normals.astype(np.float64)
    u -= normals * np.einsum("ni,ni->n", normals, u)[:, None]
    length = np.linalg.norm(u, axis=1, keepdims=True)
    any_perpendicular = np.cross(normals, np.where(np.abs(normals[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]]))
    u = np.where(length > 1e-9, u / np.maximum(length, 1e-9), any_perpendicular)
    sign = np.where(np.einsum("ni,ni->n", np.cross(normals, u), v) < 0, -1.0, 1.0)
    return np.hstack([u, sign[:, None]]).astype(np.float32)


def bounds(vertices: Float32s) -> tuple[Floats, Floats, float]:
    """Bounding box and sphere of vertices (n, 3): center (3,), half extents (3,), and radius of the sphere about the
    center."""
    points = vertices.astype(np.float64)
    low, high = points.min(axis=0), points.max(axis=0)
    center = (low + high) / 2
    return center, (high - low) / 2, float(np.linalg.norm(points - center, axis=1).max())
