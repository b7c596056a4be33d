"""The scene of bench.render: a hill of 32,768 triangles and 40 balls of 1,008, all with textures.

Renderers with three lights have the sun and two lamps, those with four a third lamp. The camera flies a circle, so all
pictures differ. Positions are in m, z is up.
"""

from functools import cache
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image

from drone_engine.arrays import Floats, Integers

SIZES = ((320, 240), (640, 480), (1280, 720))
HEIGHT_OF_VIEW = 60.0  # degrees, from the bottom of the picture to its top
NEAR, FAR = 0.1, 300.0  # m
AMBIENT = 0.25
BACKGROUND = (AMBIENT, AMBIENT, AMBIENT)
SUN = np.array([-0.3, -0.4, 0.85]) / np.linalg.norm([0.3, 0.4, 0.85])  # direction to the sun
SUN_SHARE, LAMP_SHARE = 0.7, 0.5  # of white
LAMPS = ((-15.0, -10.0, 12.0), (18.0, 8.0, 10.0), (2.0, -16.0, 9.0))
REACH = 60.0**0.5  # m, distance at which a lamp has half its intensity
SPECULAR, SHININESS = 0.2, 32.0
RADIUS, ALTITUDE, STEP = 38.0, 16.0, 0.02  # m, m, rad a picture: of the camera's circle

Bytes = npt.NDArray[np.uint8]


class Mesh(NamedTuple):
    """vertices (n, 3) in m, unit normals (n, 3), uv (n, 2) with v up, faces (m, 3), counter-clockwise."""

    vertices: Floats
    normals: Floats
    uv: Floats
    faces: Integers


class Ball(NamedTuple):
    """Position of a ball in m and its scale relative to the mesh."""

    position: tuple[float, float, float]
    scale: float


def _noise(rng: np.random.Generator, n: int, octaves: tuple[int, ...]) -> Floats:
    """Value noise (n, n) as a sum over octaves."""
    result = np.zeros((n, n))
    for o in octaves:
        grid = rng.uniform(-1, 1, (o + 1, o + 1))
        x = np.linspace(0, o, n, endpoint=False)
        i, f = x.astype(int), x - x.astype(int)
        rows = grid[i] * (1 - f)[:, None] + grid[i + 1] * f[:, None]
        result += (rows[:, i] * (1 - f) + rows[:, i + 1] * f) / o
    return result


@cache
def hill(n: int = 129, side: float = 100.0) -> Mesh:
    """A square of terrain."""
    z = 12 * _noise(np.random.default_rng(1), n, (4, 8, 16))
    u = np.linspace(0, 1, n)
    x, y = np.meshgrid((u - 0.5) * side, (u - 0.5) * side)
    slope_y, slope_x = np.gradient(z, side / (n - 1))
    normals = np.column_stack([-slope_x.ravel(), -slope_y.ravel(), np.ones(n * n)])
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.column_stack([a, a + 1, a + n + 1]), np.column_stack([a, a + n + 1, a + n])])
    return Mesh(np.column_stack([x.ravel(), y.ravel(), z.ravel()]),
                normals / np.linalg.norm(normals, axis=1, keepdims=True),
                np.stack(np.meshgrid(u, u), -1).reshape(-1, 2), faces)


@cache
def ball(rows: int = 22, columns: int = 24) -> Mesh:
    """A sphere mesh of about 1 m with dents and the normals of the sphere."""
    polar, around = (grid.ravel() for grid in np.meshgrid(
        np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, columns + 1), indexing="ij"))
    direction = np.column_stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)])
    uv = np.column_stack([around / (2 * np.pi), 1 - polar / np.pi])
    faces = []
    for i in range(rows):
        for j in range(columns):
            a, b = i * (columns + 1) + j, (i + 1) * (columns + 1) + j
            faces += [(a, b, b + 1)] * (i < rows - 1) + [(a, b + 1, a + 1)] * (i > 0)
    radius = 1 + 0.15 * np.sin(5 * polar) * np.cos(4 * around)
    return Mesh(direction * radius[:, None], direction, uv, np.array(faces))


def balls() -> list[Ball]:
    """Forty balls, in rows above the hill."""
    rng = np.random.default_rng(2)
    places = np.stack(np.meshgrid(np.arange(8), np.arange(5)), -1).reshape(-1, 2)
    return [Ball(((x - 3.5) * 6 + rng.uniform(-1, 1), (y - 2) * 6 + rng.uniform(-1, 1), 3.5 + rng.uniform(0, 3)),
                 rng.uniform(0.9, 1.8)) for x, y in places]


def colors(number: int | None) -> Bytes:
    """Texture (n, n, 3) of a ball by its number, or of the hill; the first row is the top."""
    n, seed = (1024, 10) if number is None else (256, 100 + number)
    rng = np.random.default_rng(seed)
    base = rng.uniform(60, 200, 3)
    grain = 160 * _noise(rng, n, (8, 32, n // 4))[..., None] + rng.normal(0, 8, (n, n, 1))
    return np.clip(base + grain, 0, 255).astype(np.uint8)


def bumps(number: int | None) -> Bytes:
    """Normal map that belongs to `colors`: tangent space, red to the right, green up."""
    n, seed = (1024, 11) if number is None else (256, 200 + number)
    relief = n / 40 * _noise(np.random.default_rng(seed), n, (n // 16, n // 8))
    right = (np.roll(relief, -1, axis=1) - np.roll(relief, 1, axis=1)) / 2
    up = (np.roll(relief, 1, axis=0) - np.roll(relief, -1, axis=0)) / 2
    normal = np.dstack([-right, -up, np.ones_like(relief)])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    return np.rint(127.5 + 127.5 * normal).astype(np.uint8)


def eye(number: float) -> Floats:
    """Camera position (3,) in the picture of that number; the camera looks at the center of the hill."""
    angle = STEP * number
    return np.array([RADIUS * np.cos(angle), RADIUS * np.sin(angle), ALTITUDE])


def camera(number: float) -> Floats:
    """Camera matrix (4, 4), camera to world; the camera looks along -z with y up, as in OpenGL."""
    position = eye(number)
    back = position / np.linalg.norm(position)
    right = np.cross((0.0, 0.0, 1.0), back)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([right, np.cross(back, right), back, position])
    return matrix


def obj(mesh: Mesh, library: str = "", scale: float = 1.0) -> str:
    """Text of an OBJ file; library: name of a material library with the material 'paint', if any."""
    lines = [f"mtllib {library}", "usemtl paint"] if library else []
    lines += [f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in mesh.vertices * scale]
    lines += [f"vt {u:.6g} {v:.6g}" for u, v in mesh.uv]
    lines += [f"vn {x:.6g} {y:.6g} {z:.6g}" for x, y, z in mesh.normals]
    lines += ["f " + " ".join(f"{i}/{i}/{i}" for i in face) for face in mesh.faces + 1]
    return "\n".join(lines) + "\n"


def save(pixels: Bytes, path: Path | IO[bytes]) -> None:
    """Writes a picture (height, width, 3) as PNG."""
    Image.fromarray(pixels).save(path, "PNG")
