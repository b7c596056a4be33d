"""Meshes for tests, as vertices (v, 3) in m and faces (f, 3) of vertex indices."""

from pathlib import Path

import numpy as np


def ball(rows: int = 22, columns: int = 46, bumps: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh of about a unit sphere about the origin: 2 (rows - 1) columns triangles.

    bumps: relative height of the bumps that make it concave.
    """
    theta, phi = np.linspace(0, np.pi, rows + 1)[1:-1], np.linspace(0, 2 * np.pi, columns, endpoint=False)
    t, p = (grid.ravel() for grid in np.meshgrid(theta, phi, indexing="ij"))
    vertices = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], 1)
    vertices *= 1 + bumps * np.sin(5 * p + 3 * t)[:, None]
    vertices = np.vstack([vertices, [0, 0, 1], [0, 0, -1]])
    north, south = len(vertices) - 2, len(vertices) - 1
    faces = []
    for i in range(rows - 2):
        for j in range(columns):
            a, b = i * columns + j, i * columns + (j + 1) % columns
            faces += [(a, a + columns, b), (b, a + columns, b + columns)]
    last = (rows - 2) * columns
    for j in range(columns):
        faces += [(north, j, (j + 1) % columns), (south, last + (j + 1) % columns, last + j)]
    return vertices, np.array(faces)


def block(x: float, y: float, z: float) -> tuple[np.ndarray, np.ndarray]:
    """A closed box of half extents x, y, z about the origin: 12 triangles."""
    vertices = np.array([(i * x, j * y, k * z) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def write_box(path: Path, size: tuple[float, float, float], center_z: float) -> None:
    """Writes an OBJ file of a box of 12 triangles; size: edge lengths in m, center_z: height of its center."""
    x, y, z = (side / 2 for side in size)
    corners = [(sx * x, sy * y, sz * z + center_z) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    quads = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {a!r} {b!r} {c!r}" for a, b, c in corners]
    lines += [f"f {a} {b} {c}\nf {a} {c} {d}" for a, b, c, d in quads]
    path.write_text("\n".join(lines) + "\n")


def flat_sheet(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A flat sheet of n x n squares of 1 m, facing up, from the origin on."""
    vertices = np.array([(i, j, 0.0) for i in range(n + 1) for j in range(n + 1)])
    faces = []
    for a in (i * (n + 1) + j for i in range(n) for j in range(n)):
        b, c, d = a + n + 1, a + n + 2, a + 1
        faces += [(a, b, c), (a, c, d)]
    return vertices, np.array(faces)
