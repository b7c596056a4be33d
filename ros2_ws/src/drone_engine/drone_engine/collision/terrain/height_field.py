"""Ground that is not flat: the upper surface of a model, as rain would find it, exact on its triangles.

Faces and ridges stand in cells of a horizontal grid. Faces are the triangles that look up; where several lie one above
the other, the highest counts. Ridges are their convex edges, which boxes rest on between their corners. What lies
beyond the model, or in a hole of it, is flat and as low as its lowest point.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Floats, Integers
from drone_engine.file_cache import read_once
from drone_engine.geometry import mesh
from drone_engine.kernel import kernel
from drone_engine.math.poses import rotate_all
from drone_engine.model import Model, object_poses

CELL = 1.0  # m, of ground that is not too wide for it
CELLS = 512  # along x or y, at most
PAD = 0.05  # m, how far beyond itself a face is known
STEEPEST = 0.02  # cosine of the slope up to which a triangle looks up
SLACK = 1e-9  # m that a point may lie outside of a face and still be on it
BEYOND = 1e-3  # m beyond an edge at which the ground is asked for its height there
BENT = 1e-6  # sine of the angle from which an edge is a ridge


NOTHING = (np.empty(0), *np.empty((2, 0), np.int32), np.empty((0, 13)))  # frame, start, entry, face without any ground


class Terrain(NamedTuple):
    """c cells, f faces, r ridges; m, frame of the world."""

    frame: Floats  # (7,) least x and y, cells per metre, cells along x and y, lowest and highest height
    start: NDArray[np.int32]  # (c + 1,) where each cell's faces begin in `entry`
    entry: NDArray[np.int32]
    flat: Floats  # (c,) the height of all that is in a cell, NaN if that is not one plane
    top: Floats  # (c,) the greatest height in a cell
    face: Floats  # (f, 13) unit normal, its product with a point of the plane; of each side the inner normal in the
    # horizontal plane, and the distance at the origin
    ridge_start: NDArray[np.int32]
    ridge_entry: NDArray[np.int32]
    ridge: Floats  # (r, 15) its ends; the ways down its two faces; the mean of their normals; all but the ends unit
    ridge_cell: NDArray[np.int32]  # (r, 2) the first column and row that it is in


@kernel
def cell_of(frame, x, y):
    """The column and row of the cell at a point; they may be outside of the grid."""
    limit = 1e9
    return (np.int64(math.floor(min(max((x - frame[0]) * frame[2], -limit), limit))),
            np.int64(math.floor(min(max((y - frame[1]) * frame[2], -limit), limit))))


@kernel
def within(face, f, x, y):
    """How far a point is inside of a face seen from above, m; negative outside."""
    return min(face[f, 4] * x + face[f, 5] * y + face[f, 6],
               min(face[f, 7] * x + face[f, 8] * y + face[f, 9], face[f, 10] * x + face[f, 11] * y + face[f, 12]))


@kernel
def below(frame, start, entry, face, x, y):
    """The highest face at a point, -1 where there is none, and the height there."""
    found, height = -1, frame[5]
    column, row = cell_of(frame, x, y)
    if 0 <= column < frame[3] and 0 <= row < frame[4]:
        cell = row * np.int64(frame[3]) + column
        for k in range(start[cell], start[cell + 1]):
            f = entry[k]
            if within(face, f, x, y) >= -SLACK:
                z = (face[f, 3] - face[f, 0] * x - face[f, 1] * y) / face[f, 2]
                if found < 0 or z > height:
                    found, height = f, z
    return found, height


@kernel
def lies_under(frame, flat, top, x0, y0, x1, y1):
    """The height of a rectangle if it is one plane, else NaN; and its greatest height, or more."""
    column, row = cell_of(frame, x0, y0)
    last_column, last_row = cell_of(frame, x1, y1)
    height = most = -math.inf
    level = True
    if column < 0 or row < 0 or last_column >= frame[3] or last_row >= frame[4]:
        height = most = frame[5]
    for j in range(max(row, 0), min(last_row + 1, np.int64(frame[4]))):
        for i in range(max(column, 0), min(last_column + 1, np.int64(frame[3]))):
            cell = j * np.int64(frame[3]) + i
            most = max(most, top[cell])
            if height == -math.inf:
                height = flat[cell]
            level = level and flat[cell] == height
    return height if level else math.nan, most


def of(model: Model) -> Terrain | None:
    """That of a scene's ground, if it has one. Raises mesh.MeshError."""
    if model.terrain is None:
        return None
    start = model.bodies.start_w
    pose = object_poses(model.bodies, start[:, :3], start[:, 3:])[model.terrain]
    return _read(model.paths[model.terrain], tuple(pose.tolist()))


@read_once
def _read(path: Path, pose: tuple[float, ...]) -> Terrain:
    vertices, faces = mesh.surface(path)
    if pose[3:] != (0.0, 0.0, 0.0, 1.0):
        vertices = rotate_all(np.tile(pose[3:], (len(vertices), 1)), vertices)
    return build(vertices + pose[:3], faces, path)


def build(vertices: Floats, faces: Integers, path: Path) -> Terrain:
    """That of triangles (f, 3) of vertices (v, 3). Raises mesh.MeshError if none of them looks up."""
    corners = vertices[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    up = across[:, 2] > STEEPEST * np.linalg.norm(across, axis=1)
    if not up.any():
        raise mesh.MeshError(f"{path}: is ground, but no triangle of it looks up")
    faces, corners, across = faces[up], corners[up], across[up]
    normal = across / np.linalg.norm(across, axis=1, keepdims=True)
    middle = corners.mean(axis=1)
    level = np.ptp(corners[..., 2], axis=1) == 0.0
    normal[level] = 0.0, 0.0, 1.0
    offset = np.where(level, corners[:, 0, 2], (normal * middle).sum(axis=1))
    side = np.roll(corners[..., :2], -1, axis=1) - corners[..., :2]
    inner = np.stack([-side[..., 1], side[..., 0]], axis=-1) / np.linalg.norm(side, axis=-1, keepdims=True)
    distance = -(inner * corners[..., :2]).sum(axis=-1)
    table = np.concatenate([normal, offset[:, None], np.dstack([inner, distance]).reshape(-1, 9)], axis=1)
    table = np.ascontiguousarray(table)
    rim = _rim(faces, len(vertices))

    low, high = vertices.min(axis=0), vertices.max(axis=0)
    cell = max(CELL, float((high[:2] - low[:2]).max()) / CELLS)
    size = np.floor((high[:2] - low[:2]) / cell).astype(int) + 1
    frame = np.array([low[0], low[1], 1.0 / cell, *size, low[2], corners[..., 2].max()])
    cells, which = _spread(corners[..., :2].min(axis=1) - PAD, corners[..., :2].max(axis=1) + PAD, frame)
    flat, top = np.full(size.prod(), np.nan), np.full(size.prod(), low[2])
    np.maximum.at(top, cells, corners[which, :, 2].max(axis=1))
    least = np.full(size.prod(), np.inf)
    np.minimum.at(least, cells, corners[which, :, 2].min(axis=1))
    flat = np.where((least == top) | np.isinf(least), top, np.nan)
    ends = vertices[_ends(faces)[rim]][..., :2]  # beyond which it is as low as can be
    at_rim, _ = _spread(ends.min(axis=1) - PAD, ends.max(axis=1) + PAD, frame)
    flat[at_rim[top[at_rim] != low[2]]] = np.nan
    start, entry = _sorted(cells, which, size.prod())
    steps = _steps(vertices, faces, normal, rim, lambda x, y: below(frame, start, entry, table, x, y)[1])
    ridge = np.concatenate([_ridges(vertices, faces, normal), steps])
    ends = ridge[:, :6].reshape(-1, 2, 3)[..., :2]
    ridge_low = ends.min(axis=1)
    ridge_cells, of_ridge = _spread(ridge_low, ends.max(axis=1), frame)
    ridge_start, ridge_entry = _sorted(ridge_cells, of_ridge, size.prod())
    first = np.floor((ridge_low - frame[:2]) * frame[2]).astype(np.int32).reshape(-1, 2)
    return Terrain(frame, start, entry, flat, top, table, ridge_start, ridge_entry, ridge,
                   np.ascontiguousarray(np.clip(first, 0, size - 1).astype(np.int32)))


def _ends(faces: Integers) -> Integers:
    """The edges (3 f, 2) of faces, three of each, the face to their left."""
    return np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)


def _rim(faces: Integers, count: int) -> Integers:
    """Which of the edges are those of one face alone, (k,)."""
    ends = _ends(faces)
    key = ends.min(axis=1).astype(np.int64) * count + ends.max(axis=1)
    _, first, times = np.unique(key, return_index=True, return_counts=True)
    return np.asarray(first[times == 1])


def _steps(
    vertices: Floats, faces: Integers, normal: Floats, rim: Integers, height: Callable[[float, float], float]
) -> Floats:  # fmt: skip
    """Rows (s, 15) as Terrain has them, of the edges `rim` beyond which the ground, of a height (x, y), is lower: as if
    a second face went straight down there."""
    p, q = (vertices[_ends(faces)[rim, k]] for k in range(2))
    along = (q - p) / np.linalg.norm(q - p, axis=1, keepdims=True)
    out = np.cross(along, [0.0, 0.0, 1.0])
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    beyond = 0.5 * (p + q) + BEYOND * out
    lower = np.array([height(x, y) < z - 2.0 * BEYOND for x, y, z in beyond.tolist()], bool)
    mean = normal[rim // 3] + out
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    down = np.tile([0.0, 0.0, -1.0], (len(p), 1))
    return np.asarray(np.concatenate([p, q, np.cross(normal[rim // 3], along), down, mean], axis=1)[lower])


def _ridges(vertices: Floats, faces: Integers, normal: Floats) -> Floats:
    """Rows (r, 15) as Terrain has them, of the edges where two faces bend down."""
    begin, end = faces, np.roll(faces, -1, axis=1)
    key = np.minimum(begin, end).astype(np.int64) * len(vertices) + np.maximum(begin, end)
    order = np.argsort(key.ravel(), kind="stable")
    same = key.ravel()[order]
    first = np.flatnonzero(same[1:] == same[:-1])
    a, b = order[first] // 3, order[first + 1] // 3
    p, q = (vertices[ends.ravel()[order[first]]] for ends in (begin, end))
    along = (q - p) / np.linalg.norm(q - p, axis=1, keepdims=True)
    # The face is to the left of its own side, and the other face has that side the other way round.
    down_a, down_b = np.cross(normal[a], along), -np.cross(normal[b], along)
    mean = normal[a] + normal[b]
    bent = (normal[b] * down_a).sum(axis=1) < -BENT
    bent &= (begin.ravel()[order[first]] != begin.ravel()[order[first + 1]])  # else they turn against each other
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    return np.ascontiguousarray(np.concatenate([p, q, down_a, down_b, mean], axis=1)[bent])


def _spread(low: Floats, high: Floats, frame: Floats) -> tuple[Integers, Integers]:
    """The cells that rectangles overlap, and the rectangle of each."""
    size = frame[3:5].astype(int)
    first, last = (np.clip(np.floor((corner - frame[:2]) * frame[2]).astype(int), 0, size - 1)
                   for corner in (low, high))
    cells = [(np.arange(first[i, 1], last[i, 1] + 1)[:, None] * size[0]
              + np.arange(first[i, 0], last[i, 0] + 1)).ravel() for i in range(len(low))]
    counts = [len(some) for some in cells]
    return np.concatenate([np.empty(0, np.int64), *cells]), np.repeat(np.arange(len(low)), counts)


def _sorted(cells: Integers, which: Integers, count: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Where each cell begins, (count + 1,), and what is in it."""
    start = np.searchsorted(np.sort(cells), np.arange(count + 1)).astype(np.int32)
    return start, which[np.argsort(cells, kind="stable")].astype(np.int32)
