"""Moments of inertia of a model: of the solid that its surface encloses, or of its box if the surface is open."""

from pathlib import Path

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.assets import read_once
from drone_engine.geometry.mesh import bounds, read_faces, read_vertices

LEAST = 1e-6  # of the box's volume, under which a surface encloses nothing
HOLE = 0.1  # of a surface's area, up to which holes in it do not matter


@read_once
def moments(path: Path) -> tuple[float, float, float]:
    """Moments about the axes through the centre of mass, m2 for each kg, of even density. Raises MeshError.

    Sums over tetrahedra from the origin to each triangle (Tonon 2004, Explicit Exact Formulas for the 3-D Tetrahedron
    Inertia Tensor). Products of inertia are left out: a body turns about the axes of its box.
    """
    low, high = bounds(path)
    squares = (high - low) ** 2 / 12.0
    vertices, faces = read_vertices(path), read_faces(path)
    if len(faces) and faces.min() >= 0 and faces.max() < len(vertices):
        a, b, c = (vertices[faces[:, k]] - (low + high) / 2.0 for k in range(3))
        det = np.einsum("ij,ij->i", a, np.cross(b, c))
        volume = det.sum() / 6.0
        if is_closed(a, b, c) and volume > LEAST * float(np.prod(high - low)):
            total = a + b + c
            centre = (det[:, None] * total).sum(axis=0) / 24.0 / volume
            second = (det[:, None] * (total**2 + a**2 + b**2 + c**2)).sum(axis=0) / 120.0 / volume
            squares = second - centre**2
    x, y, z = squares.tolist()
    return y + z, z + x, x + y


def is_closed(a: Floats, b: Floats, c: Floats) -> bool:
    """Whether triangles with these corners, (f, 3) each, leave hardly any hole: the areas of a closed surface, as
    vectors, sum up to nothing."""
    areas = np.cross(b - a, c - a)
    return bool(np.linalg.norm(areas.sum(axis=0)) <= HOLE * np.linalg.norm(areas, axis=1).sum())
