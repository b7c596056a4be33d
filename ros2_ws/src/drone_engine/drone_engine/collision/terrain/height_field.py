"""Height field of a terrain model: its uppermost surface, exact on its triangles.

Faces and ridges are stored in the cells of a horizontal grid. Faces are the triangles whose normals point up; where
several lie one above the other, the highest counts. Ridges are their convex edges, on which boxes may rest between
their corners. Outside of the model, and in its holes, the ground is horizontal at the height of its lowest point.
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

CELL_SIZE = 1.0  # m, unless that needs more than MAX_CELLS
MAX_CELLS = 512  # along x or y
FACE_PAD = 0.05  # m, growth of a face's rectangle when cells are filled
MIN_UP_COSINE = 0.02  # cosine of the slope of the steepest face
ON_FACE_TOLERANCE = 1e-9  # m by which a point may lie outside of a face and still count as on it
PROBE_DISTANCE = 1e-3  # m from a border edge at which the height outside of the face is looked up
MIN_RIDGE_SINE = 1e-6  # sine of the angle between two faces above which their edge is a ridge

MIN_X, MIN_Y, CELLS_PER_M, COLUMNS, ROWS, LOWEST, HIGHEST = range(7)  # columns of `grid`


class HeightField(NamedTuple):
    """A height field with c cells, f faces and r ridges; m, world frame. Cells are numbered row * COLUMNS + column."""

    grid: Floats  # (7,) minimum of x and y, cells per m, number of columns (along x) and rows (along y), lowest and
    # highest height
    start: NDArray[np.int32]  # (c + 1,) where each cell's faces begin in `entry`
    entry: NDArray[np.int32]  # faces, by cell
    flat: Floats  # (c,) height of everything in a cell if that is one horizontal plane, else NaN
    top: Floats  # (c,) largest height in a cell
    face: Floats  # (f, 13) unit normal, its dot product with a point of the plane; for each side: inner unit normal in
    # the horizontal plane (2), and the distance of the origin along it
    ridge_start: NDArray[np.int32]  # (c + 1,) where each cell's ridges begin in `ridge_entry`
    ridge_entry: NDArray[np.int32]  # ridges, by cell
    ridge: Floats  # (r, 15) both ends; for each of the two faces the unit vector down the face, perpendicular to the
    # ridge; the mean of the faces' normals, unit
    ridge_cell: NDArray[np.int32]  # (r, 2) first column and row of the cells that a ridge is in


# A height field without any ground, for kernels that need one where a scene has no terrain.
NO_GROUND = HeightField(
    np.empty(0), np.empty(0, np.int32), np.empty(0, np.int32), np.empty(0), np.empty(0), np.empty((0, 13)),
    np.empty(0, np.int32), np.empty(0, np.int32), np.empty((0, 15)), np.empty((0, 2), np.int32))


@kernel
def cell_of(grid, x, y):
    """The column and row of the cell at a point, which may be outside of the grid; grid: as in HeightField."""
    limit = 1e9
    return (np.int64(math.floor(min(max((x - grid[MIN_X]) * grid[CELLS_PER_M], -limit), limit))),
            np.int64(math.floor(min(max((y - grid[MIN_Y]) * grid[CELLS_PER_M], -limit), limit))))


@kernel
def distance_inside(face, f, x, y):
    """The horizontal distance of a point inside of face f from its nearest side, m; negative outside."""
    return min(face[f, 4] * x + face[f, 5] * y + face[f, 6],
               min(face[f, 7] * x + face[f, 8] * y + face[f, 9], face[f, 10] * x + face[f, 11] * y + face[f, 12]))


@kernel
def face_below(field, x, y):
    """The highest face at (x, y), -1 outside of all faces, and the height there, m."""
    grid, start, entry, face = field.grid, field.start, field.entry, field.face
    found, height = -1, grid[LOWEST]
    column, row = cell_of(grid, x, y)
    if 0 <= column < grid[COLUMNS] and 0 <= row < grid[ROWS]:
        cell = row * np.int64(grid[COLUMNS]) + column
        for k in range(start[cell], start[cell + 1]):
            f = entry[k]
            if distance_inside(face, f, x, y) >= -ON_FACE_TOLERANCE:
                z = (face[f, 3] - face[f, 0] * x - face[f, 1] * y) / face[f, 2]
                if found < 0 or z > height:
                    found, height = f, z
    return found, height


@kernel
def rectangle_heights(field, x0, y0, x1, y1):
    """The height of the ground below a rectangle if that is one horizontal plane, else NaN; and an upper bound of its
    height; m."""
    grid, flat, top = field.grid, field.flat, field.top
    column, row = cell_of(grid, x0, y0)
    last_column, last_row = cell_of(grid, x1, y1)
    height = most = -math.inf
    level = True
    if column < 0 or row < 0 or last_column >= grid[COLUMNS] or last_row >= grid[ROWS]:
        height = most = grid[LOWEST]
    for j in range(max(row, 0), min(last_row + 1, np.int64(grid[ROWS]))):
        for i in range(max(column, 0), min(last_column + 1, np.int64(grid[COLUMNS]))):
            cell = j * np.int64(grid[COLUMNS]) + i
            most = max(most, top[cell])
            if height == -math.inf:
                height = flat[cell]
            level = level and flat[cell] == height
    return height if level else math.nan, most


def of_model(model: Model) -> HeightField | None:
    """The height field of a scene's terrain, None if it has none. Raises mesh.MeshError."""
    if model.terrain is None:
        return None
    start = model.bodies.start_w
    pose = object_poses(model.bodies, start[:, :3], start[:, 3:])[model.terrain]
    return _load(model.paths[model.terrain], tuple(pose.tolist()))


@read_once
def _load(path: Path, pose: tuple[float, ...]) -> HeightField:
    """The height field of a model at a pose: x y z m and a unit quaternion x y z w."""
    vertices, faces = mesh.surface(path)
    if pose[3:] != (0.0, 0.0, 0.0, 1.0):
        vertices = rotate_all(np.tile(pose[3:], (len(vertices), 1)), vertices)
    return build(vertices + pose[:3], faces, path)


def build(vertices: Floats, faces: Integers, path: Path) -> HeightField:
    """The height field of faces (f, 3) of vertices (v, 3), m, world frame; path: of the model, for messages. Raises
    mesh.MeshError if no face points up."""
    corners = vertices[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    up = across[:, 2] > MIN_UP_COSINE * np.linalg.norm(across, axis=1)
    if not up.any():
        raise mesh.MeshError(f"{path}: expected a triangle that faces up, as the collision level is ground, got none")
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
    border = _border_edges(faces, len(vertices))

    low, high = vertices.min(axis=0), vertices.max(axis=0)
    cell_size = max(CELL_SIZE, float((high[:2] - low[:2]).max()) / MAX_CELLS)
    size = np.floor((high[:2] - low[:2]) / cell_size).astype(int) + 1
    grid = np.array([low[0], low[1], 1.0 / cell_size, *size, low[2], corners[..., 2].max()])
    cells, which = _cells_of_rectangles(corners[..., :2].min(axis=1) - FACE_PAD,
                                        corners[..., :2].max(axis=1) + FACE_PAD, grid)
    flat, top = np.full(size.prod(), np.nan), np.full(size.prod(), low[2])
    np.maximum.at(top, cells, corners[which, :, 2].max(axis=1))
    least = np.full(size.prod(), np.inf)
    np.minimum.at(least, cells, corners[which, :, 2].min(axis=1))
    flat = np.where((least == top) | np.isinf(least), top, np.nan)
    ends = vertices[_edges(faces)[border]][..., :2]  # beyond these the ground may be at its lowest height
    at_border, _ = _cells_of_rectangles(ends.min(axis=1) - FACE_PAD, ends.max(axis=1) + FACE_PAD, grid)
    flat[at_border[top[at_border] != low[2]]] = np.nan
    start, entry = _sorted_by_cell(cells, which, size.prod())
    no_ridges = np.zeros(1, np.int32), np.empty(0, np.int32), np.empty((0, 15)), np.empty((0, 2), np.int32)
    field = HeightField(grid, start, entry, flat, top, table, *no_ridges)
    border_ridges = _border_ridges(vertices, faces, normal, border, lambda x, y: face_below(field, x, y)[1])
    ridge = np.concatenate([_convex_edge_ridges(vertices, faces, normal), border_ridges])
    ends = ridge[:, :6].reshape(-1, 2, 3)[..., :2]
    ridge_low = ends.min(axis=1)
    ridge_cells, of_ridge = _cells_of_rectangles(ridge_low, ends.max(axis=1), grid)
    ridge_start, ridge_entry = _sorted_by_cell(ridge_cells, of_ridge, size.prod())
    first = np.floor((ridge_low - grid[:2]) * grid[2]).astype(np.int32).reshape(-1, 2)
    ridge_cell = np.ascontiguousarray(np.clip(first, 0, size - 1).astype(np.int32))
    return field._replace(ridge_start=ridge_start, ridge_entry=ridge_entry, ridge=ridge, ridge_cell=ridge_cell)


def _edges(faces: Integers) -> Integers:
    """The edges (3 f, 2) of faces, three of each, with the face on their left."""
    return np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)


def _border_edges(faces: Integers, count: int) -> Integers:
    """The indices (k,) of edges, as from `_edges`, that belong to one face only; count: number of vertices."""
    ends = _edges(faces)
    key = ends.min(axis=1).astype(np.int64) * count + ends.max(axis=1)
    _, first, times = np.unique(key, return_index=True, return_counts=True)
    return np.asarray(first[times == 1])


def _border_ridges(
    vertices: Floats, faces: Integers, normal: Floats, border: Integers, height: Callable[[float, float], float]
) -> Floats:  # fmt: skip
    """Ridges (s, 15), as in HeightField, at those border edges outside of which the ground is lower, as if a second
    face went straight down there; border: (k,) indices of edges; height: of the ground at (x, y)."""
    p, q = (vertices[_edges(faces)[border, k]] for k in range(2))
    along = (q - p) / np.linalg.norm(q - p, axis=1, keepdims=True)
    out = np.cross(along, [0.0, 0.0, 1.0])
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    beyond = 0.5 * (p + q) + PROBE_DISTANCE * out
    lower = np.array([height(x, y) < z - 2.0 * PROBE_DISTANCE for x, y, z in beyond.tolist()], bool)
    mean = normal[border // 3] + out
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    down = np.tile([0.0, 0.0, -1.0], (len(p), 1))
    return np.asarray(np.concatenate([p, q, np.cross(normal[border // 3], along), down, mean], axis=1)[lower])


def _convex_edge_ridges(vertices: Floats, faces: Integers, normal: Floats) -> Floats:
    """Ridges (r, 15), as in HeightField, at the convex edges between two faces."""
    begin, end = faces, np.roll(faces, -1, axis=1)
    key = np.minimum(begin, end).astype(np.int64) * len(vertices) + np.maximum(begin, end)
    order = np.argsort(key.ravel(), kind="stable")
    same = key.ravel()[order]
    first = np.flatnonzero(same[1:] == same[:-1])
    a, b = order[first] // 3, order[first + 1] // 3
    p, q = (vertices[ends.ravel()[order[first]]] for ends in (begin, end))
    along = (q - p) / np.linalg.norm(q - p, axis=1, keepdims=True)
    # The first face is on the left of the edge; the other face has the edge in the opposite direction.
    down_a, down_b = np.cross(normal[a], along), -np.cross(normal[b], along)
    mean = normal[a] + normal[b]
    convex = (normal[b] * down_a).sum(axis=1) < -MIN_RIDGE_SINE
    # Otherwise the two faces are oriented inconsistently.
    convex &= begin.ravel()[order[first]] != begin.ravel()[order[first + 1]]
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    return np.ascontiguousarray(np.concatenate([p, q, down_a, down_b, mean], axis=1)[convex])


def _cells_of_rectangles(low: Floats, high: Floats, grid: Floats) -> tuple[Integers, Integers]:
    """The cells that rectangles from low (k, 2) to high (k, 2) overlap, (m,), and the rectangle of each, (m,)."""
    size = grid[3:5].astype(int)
    first, last = (np.clip(np.floor((corner - grid[:2]) * grid[2]).astype(int), 0, size - 1)
                   for corner in (low, high))
    cells = [(np.arange(first[i, 1], last[i, 1] + 1)[:, None] * size[0]
              + np.arange(first[i, 0], last[i, 0] + 1)).ravel() for i in range(len(low))]
    counts = [len(overlapped) for overlapped in cells]
    return np.concatenate([np.empty(0, np.int64), *cells]), np.repeat(np.arange(len(low)), counts)


def _sorted_by_cell(cells: Integers, which: Integers, count: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Sorts entries by cell: where each cell begins, (count + 1,), and the entries; cells, which: (m,)."""
    start = np.searchsorted(np.sort(cells), np.arange(count + 1)).astype(np.int32)
    return start, which[np.argsort(cells, kind="stable")].astype(np.int32)
