"""Moments of inertia of a model: of the solid that its surface encloses, or of its box if the surface is open."""

from pathlib import Path

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.file_cache import read_once
from drone_engine.geometry.obj import Obj

MIN_VOLUME = 1e-6  # of the box's volume; a surface that encloses less counts as open
MAX_HOLE = 0.1  # of a surface's area; a surface with larger holes counts as open


@read_once
def moments(path: Path) -> tuple[float, float, float]:
    """Moments about the x, y and z axes through the center of mass, in m^2 (kg m^2 per kg), at uniform density.

    Sums over tetrahedra from the origin to each triangle (Tonon 2004, Explicit Exact Formulas for the 3-D Tetrahedron
    Inertia Tensor). Products of inertia are neglected: a body rotates about the axes of its box. Raises MeshError.
    """
    obj = Obj.read(path)
    low, high = obj.bounds
    squares = (high - low) ** 2 / 12.0
    vertices, faces = obj.vertices, obj.faces
    if len(faces) and faces.min() >= 0 and faces.max() < len(vertices):
        a, b, c = (vertices[faces[:, k]] - (low + high) / 2.0 for k in range(3))
        det = np.einsum("ij,ij->i", a, np.cross(b, c))
        volume = det.sum() / 6.0
        if is_closed(a, b, c) and volume > MIN_VOLUME * float(np.prod(high - low)):
            total = a + b + c
            center = (det[:, None] * total).sum(axis=0) / 24.0 / volume
            second = (det[:, None] * (total**2 + a**2 + b**2 + c**2)).sum(axis=0) / 120.0 / volume
            squares = second - center**2
    x, y, z = squares.tolist()
    return y + z, z + x, x + y


def is_closed(a: Floats, b: Floats, c: Floats) -> bool:
    """Whether triangles with these corners, (f, 3) each, form a surface almost without holes: the area vectors of a
    closed surface add up to zero."""
    areas = np.cross(b - a, c - a)
    return bool(np.linalg.norm(areas.sum(axis=0)) <= MAX_HOLE * np.linalg.norm(areas, axis=1).sum())
