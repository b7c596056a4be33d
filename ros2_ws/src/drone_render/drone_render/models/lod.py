"""Levels of detail (LOD): the same surface with fewer triangles, for when it is small in the picture.

Edge collapse with the quadric error metric of Garland and Heckbert (1998), Simplifying Surfaces with Color and Texture.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats
from drone_render.arrays import Faces, Indices

SHARES = (0.6, 0.36, 0.2, 0.11, 0.06)  # target shares of the triangles for the levels after the full one
MIN_TRIANGLES = 160  # surfaces with no more than this get no further levels
NORMAL_WEIGHT = 1.0  # edge lengths of position error that weigh as much as an error of 1 in the normal
UV_WEIGHT = 0.5  # m of position error that weigh as much as 1 m of texture slip
FLIP_COSINE = 0.2  # between a triangle's normals before and after a collapse; at or below it the collapse is refused
CHEAP_QUANTILE = 0.6  # of the candidates' errors: those above wait for a later round
MAX_ROUNDS = 40  # of independent collapses per level
BLOCK = 2048  # triangles; larger wide surfaces are cut into blocks, so that distant parts can use coarser levels


class Level(NamedTuple):
    """One level of detail of a surface."""

    faces: Faces  # (m, 3) indices of the surface's own vertices
    error: float  # m, distance to the full surface


def levels(position: Floats, normal: Floats, uv: Floats, faces: Faces, kept: Booleans) -> list[Level]:
    """All levels of detail of a surface, the full one first.

    position, normal: (n, 3), uv: (n, 2), of the vertices; faces: (m, 3); kept: (n,), vertices that every level keeps.
    Half-edges are collapsed in order of their quadric error, where a triangle's quadric measures the distance to its
    plane in the space of position, normal and texture coordinates.
    """
    found = [Level(faces, 0.0)]
    if len(faces) <= MIN_TRIANGLES:
        return found
    extent = float(np.ptp(position, axis=0).max())
    uv_extent = max(float(np.ptp(uv, axis=0).max()), 1e-9)
    edge = float(np.median(np.linalg.norm(position[faces[:, 0]] - position[faces[:, 1]], axis=1)))
    points = np.hstack([position, NORMAL_WEIGHT * edge * normal, UV_WEIGHT * extent / uv_extent * uv])
    points = points.astype(np.float64)
    place = np.unique(position, axis=0, return_inverse=True)[1].ravel()
    kept = np.bincount(place, weights=kept) > 0
    quadrics, weight = _quadrics(points, faces)
    _add_border_quadrics(quadrics, position, place, faces)
    error, random = 0.0, np.random.default_rng(1)
    for share in SHARES:
        target = max(int(share * len(found[0].faces)), 24)
        for _ in range(MAX_ROUNDS):
            if len(faces) <= target:
                break
            fewer, worst = _collapse(points, place, faces, kept, quadrics, weight, len(faces) - target, random)
            if len(fewer) == len(faces):
                break
            faces, error = fewer, max(error, worst)
        if len(faces) < 0.8 * len(found[-1].faces):
            found.append(Level(faces.astype(np.int32), error))
    return found


def blocks(position: NDArray[np.floating], faces: Faces) -> list[Indices]:
    """Splits a surface into blocks of at most BLOCK triangles: indices of `faces` (m, 3) for each block.

    Blocks are halved across their longest side, by the triangles' centroids; position: (n, 3).
    """
    centroids = position[faces].mean(axis=1)
    done: list[Indices] = []
    left = [np.arange(len(faces))]
    while left:
        block = left.pop()
        if len(block) <= BLOCK:
            done.append(block)
            continue
        extent = np.ptp(centroids[block], axis=0)
        order = block[np.argsort(centroids[block, int(np.argmax(extent))], kind="stable")]
        left += [np.sort(half) for half in np.array_split(order, 2)]
    return done


def _quadrics(points: Floats, faces: Faces) -> tuple[Floats, Floats]:
    """Per vertex: the area-weighted sum of its triangles' quadrics (n, d + 1, d + 1), and the summed areas (n,).

    points: (n, d), vertices in the space of position, normal and texture coordinates.
    """
    corner, first, second = (points[faces[:, i]] for i in range(3))
    along = first - corner
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    across = second - corner
    across -= along * np.einsum("fi,fi->f", along, across)[:, None]
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    area = 0.5 * np.linalg.norm(
        np.cross(first[:, :3] - corner[:, :3], second[:, :3] - corner[:, :3]), axis=1)  # fmt: skip
    plane = np.eye(points.shape[1]) - along[:, :, None] * along[:, None] - across[:, :, None] * across[:, None]
    linear = -np.einsum("fij,fj->fi", plane, corner)
    quadric = np.empty((len(faces), points.shape[1] + 1, points.shape[1] + 1))
    quadric[:, :-1, :-1] = plane
    quadric[:, :-1, -1] = quadric[:, -1, :-1] = linear
    quadric[:, -1, -1] = -np.einsum("fi,fi->f", linear, corner)
    quadric *= area[:, None, None]
    quadrics, weight = np.zeros((len(points), *quadric.shape[1:])), np.zeros(len(points))
    for i in range(3):
        np.add.at(quadrics, faces[:, i], quadric)
        np.add.at(weight, faces[:, i], area)
    return quadrics, weight


def _add_border_quadrics(quadrics: Floats, position: Floats, place: Indices, faces: Faces) -> None:
    """Adds to `quadrics` the planes through open edges, perpendicular to the surface: they keep borders straight.

    place: (n,) number of each vertex's position, equal for vertices at the same point.
    """
    edges = np.vstack([faces[:, [0, 1, 2]], faces[:, [1, 2, 0]], faces[:, [2, 0, 1]]])
    ends = np.sort(place[edges[:, :2]], axis=1)
    _, back, count = np.unique(ends[:, 0] * np.intp(len(place)) + ends[:, 1], return_inverse=True, return_counts=True)
    u, v, opposite = edges[count[back.ravel()] == 1].T
    along, inwards = position[v] - position[u], position[opposite] - position[u]
    square = np.maximum(np.einsum("ei,ei->e", along, along), 1e-30)
    inwards = inwards - along * (np.einsum("ei,ei->e", along, inwards) / square)[:, None]
    inwards /= np.maximum(np.linalg.norm(inwards, axis=1, keepdims=True), 1e-15)
    plane = np.zeros((len(u), quadrics.shape[1]))
    plane[:, :3] = inwards
    plane[:, -1] = -np.einsum("ei,ei->e", inwards, position[u])
    quadric = plane[:, :, None] * plane[:, None] * square[:, None, None]
    np.add.at(quadrics, u, quadric)
    np.add.at(quadrics, v, quadric)


def _collapse(
    points: Floats, place: Indices, faces: Faces, kept: Booleans, quadrics: Floats, weight: Floats, most: int,
    random: np.random.Generator,
) -> tuple[Faces, float]:
    """One round of collapses: moves cheap vertices onto a neighbor. Returns the remaining faces and the worst error, m.

    points, quadrics, weight: as in _quadrics, updated in place; place: as in _add_border_quadrics; kept: (places,).
    Removes about `most` triangles at most. Collapses of one round share no triangle, so they are independent.
    """
    # Half-edges between places; along a texture seam, one edge between places has several pairs of vertices.
    start, end = faces[:, [0, 1, 2, 1, 2, 0]].ravel(), faces[:, [1, 2, 0, 0, 1, 2]].ravel()
    count = len(kept)
    pair, along = np.unique(start.astype(np.int64) * len(points) + end, return_counts=True)
    u, v = np.divmod(pair, len(points))
    _, edge_of = np.unique(place[u] * np.int64(count) + place[v], return_inverse=True)
    edge_of = edge_of.ravel()
    shared = np.bincount(edge_of, weights=along)
    source, target = np.empty(len(shared), np.intp), np.empty(len(shared), np.intp)
    source[edge_of], target[edge_of] = place[u], place[v]

    # A place can move if each of its vertices has one at the target to merge with; at borders, only along them.
    vertices = np.bincount(place[np.unique(faces)], minlength=count)
    moved_by = np.unique(edge_of * np.int64(len(points)) + u) // len(points)  # each vertex counts once per edge
    movable = (np.bincount(moved_by, minlength=len(shared)) == vertices[source]) & ~kept[source] & (shared <= 2)
    border = np.zeros(count, bool)
    border[source[shared != 2]] = True
    movable &= ~(border[source] & (shared == 2))
    homogeneous = np.hstack([points[v], np.ones((len(v), 1))])
    cost = np.maximum(((quadrics[u] @ homogeneous[:, :, None])[:, :, 0] * homogeneous).sum(axis=1), 0.0)
    edge_cost = np.bincount(edge_of, weights=cost, minlength=len(shared))
    edge_weight = np.bincount(edge_of, weights=weight[u], minlength=len(shared))
    error = np.sqrt(edge_cost / np.maximum(edge_weight, 1e-30))
    error[~movable] = np.inf

    # The cheapest edge of each place; of the cheap places, those with a lower random number than all their neighbors.
    order = np.lexsort((error, source))
    used, begin = np.unique(source[order], return_index=True)
    cheapest, place_error = np.zeros(count, np.intp), np.full(count, np.inf)
    cheapest[used] = order[begin]
    place_error[used] = error[cheapest[used]]
    ready = np.isfinite(place_error)
    if not ready.any():
        return faces, 0.0
    ready &= place_error <= np.quantile(place_error[ready], CHEAP_QUANTILE)
    priority = np.where(ready, random.permutation(count), count)
    corners = place[faces]
    lowest = priority.copy()
    around = priority[corners].min(axis=1)
    for i in range(3):
        np.minimum.at(lowest, corners[:, i], around)
    moving = np.flatnonzero(ready & (priority == lowest))
    moving = moving[np.argsort(place_error[moving], kind="stable")][: max(most // 2, 1)]
    chosen = np.zeros(len(shared), bool)
    chosen[cheapest[moving]] = True
    becomes = np.arange(len(points))
    picked = chosen[edge_of]
    becomes[u[picked]] = v[picked]

    # Refuse collapses that would flip a triangle.
    moved = becomes[faces]
    old, new = (_normals(points[index, :3]) for index in (faces, moved))
    gone = (place[moved] == place[np.roll(moved, 1, axis=1)]).any(axis=1)
    length = np.linalg.norm(old, axis=1) * np.linalg.norm(new, axis=1)
    flipped = ~gone & (np.einsum("fi,fi->f", old, new) <= FLIP_COSINE * length)
    refused = np.isin(place, place[faces[flipped][moved[flipped] != faces[flipped]]])
    becomes[refused] = np.flatnonzero(refused)
    moved = becomes[faces]
    gone = (place[moved] == place[np.roll(moved, 1, axis=1)]).any(axis=1)
    merged = np.flatnonzero(becomes != np.arange(len(points)))
    np.add.at(quadrics, becomes[merged], quadrics[merged])
    np.add.at(weight, becomes[merged], weight[merged])
    taken = chosen & ~np.isin(source, place[refused])
    return moved[~gone], float(error[taken].max(initial=0.0))


def _normals(triangles: Floats) -> Floats:
    """Normals (m, 3), as long as twice the area, of triangles (m, 3, 3)."""
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
