"""Levels of detail: the same surface with fewer triangles, for when it is small in the picture."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from drone_render.view import Array

SHARES = (0.6, 0.36, 0.2, 0.11, 0.06)  # of the triangles, that the levels behind the full one aim at
FEWEST = 160  # triangles; what has no more is not worth a level
BEND = 1.0  # of an edge's length: how far off in place counts like a normal off by 1
SLIP = 0.5  # m off in place that count like a texture that slips by 1 m
FLIPPED = 0.2  # cosine of the turn that makes a triangle face another way
CHEAP = 0.6  # the share of vertices that may go in a round; the dear ones wait, later they may be cheap
ROUNDS = 40  # at most, of collapses that do not touch each other
BLOCK = 2048  # triangles; a wide surface of more is cut, so that its far parts may have fewer

Index = npt.NDArray[np.intp]
Faces = npt.NDArray[np.int32]


class Level(NamedTuple):
    """Triangles (m, 3) of the surface's own vertices, and how far off they are, in m."""

    faces: Faces
    error: float


def levels(position: Array, normal: Array, uv: Array, faces: Faces, kept: npt.NDArray[np.bool_]) -> list[Level]:
    """The surface at every level, the full one first; `kept` (n,): vertices that no level may leave out.

    Half-edges collapse, the cheapest first, by the quadrics of Garland and Heckbert (1998, Simplifying Surfaces with
    Color and Texture): a triangle's plane in the space of place, normal and texture coordinates.
    """
    found = [Level(faces, 0.0)]
    if len(faces) <= FEWEST:
        return found
    reach = float(np.ptp(position, axis=0).max())
    spread = max(float(np.ptp(uv, axis=0).max()), 1e-9)
    edge = float(np.median(np.linalg.norm(position[faces[:, 0]] - position[faces[:, 1]], axis=1)))
    points = np.hstack([position, BEND * edge * normal, SLIP * reach / spread * uv]).astype(np.float64)
    place = np.unique(position, axis=0, return_inverse=True)[1].ravel()
    kept = np.bincount(place, weights=kept) > 0
    quadrics, weight = _quadrics(points, faces)
    _hold_borders(quadrics, position, place, faces)
    error, lots = 0.0, np.random.default_rng(1)
    for share in SHARES:
        wanted = max(int(share * len(found[0].faces)), 24)
        for _ in range(ROUNDS):
            if len(faces) <= wanted:
                break
            fewer, worst = _collapse(points, place, faces, kept, quadrics, weight, len(faces) - wanted, lots)
            if len(fewer) == len(faces):
                break
            faces, error = fewer, max(error, worst)
        if len(faces) < 0.8 * len(found[-1].faces):
            found.append(Level(faces.astype(np.int32), error))
    return found


def blocks(position: npt.NDArray[np.floating], faces: Faces) -> list[Index]:
    """The triangles' numbers in blocks of BLOCK at most, cut across the longest side again and again."""
    middles = position[faces].mean(axis=1)
    done: list[Index] = []
    left = [np.arange(len(faces))]
    while left:
        block = left.pop()
        if len(block) <= BLOCK:
            done.append(block)
            continue
        spread = np.ptp(middles[block], axis=0)
        order = block[np.argsort(middles[block, int(np.argmax(spread))], kind="stable")]
        left += [np.sort(half) for half in np.array_split(order, 2)]
    return done


def _quadrics(points: Array, faces: Faces) -> tuple[Array, Array]:
    """Of each vertex: the sum of its triangles' quadrics (n, d + 1, d + 1), weighted by area, and the weights (n,)."""
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
    each = np.empty((len(faces), points.shape[1] + 1, points.shape[1] + 1))
    each[:, :-1, :-1] = plane
    each[:, :-1, -1] = each[:, -1, :-1] = linear
    each[:, -1, -1] = -np.einsum("fi,fi->f", linear, corner)
    each *= area[:, None, None]
    quadrics, weight = np.zeros((len(points), *each.shape[1:])), np.zeros(len(points))
    for i in range(3):
        np.add.at(quadrics, faces[:, i], each)
        np.add.at(weight, faces[:, i], area)
    return quadrics, weight


def _hold_borders(quadrics: Array, position: Array, place: Index, faces: Faces) -> None:
    """Adds to the quadrics what keeps open edges in line: planes through them that stand upright on the surface."""
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
    each = plane[:, :, None] * plane[:, None] * square[:, None, None]
    np.add.at(quadrics, u, each)
    np.add.at(quadrics, v, each)


def _collapse(
    points: Array, place: Index, faces: Faces, kept: npt.NDArray[np.bool_], quadrics: Array, weight: Array, most: int,
    lots: np.random.Generator,
) -> tuple[Faces, float]:
    """One round: moves vertices onto neighbours where it is cheap; returns the triangles left and the worst error, m.

    `most` triangles go at most. What moves has a ring of triangles to itself, so that no two collapses meet.
    """
    # Half-edges between places; the vertices at their ends differ where a seam runs along.
    start, end = faces[:, [0, 1, 2, 1, 2, 0]].ravel(), faces[:, [1, 2, 0, 0, 1, 2]].ravel()
    count = len(kept)
    pair, along = np.unique(start.astype(np.int64) * len(points) + end, return_counts=True)
    u, v = np.divmod(pair, len(points))
    _, edge_of = np.unique(place[u] * np.int64(count) + place[v], return_inverse=True)
    edge_of = edge_of.ravel()
    shared = np.bincount(edge_of, weights=along)
    source, target = np.empty(len(shared), np.intp), np.empty(len(shared), np.intp)
    source[edge_of], target[edge_of] = place[u], place[v]

    # A place may move if each of its vertices has one at the target to become; along a border only on the border.
    vertices = np.bincount(place[np.unique(faces)], minlength=count)
    moved_by = np.unique(edge_of * np.int64(len(points)) + u) // len(points)  # each of them once, however many it has
    movable = (np.bincount(moved_by, minlength=len(shared)) == vertices[source]) & ~kept[source] & (shared <= 2)
    border = np.zeros(count, bool)
    border[source[shared != 2]] = True
    movable &= ~(border[source] & (shared == 2))
    homogeneous = np.hstack([points[v], np.ones((len(v), 1))])
    price = np.maximum(((quadrics[u] @ homogeneous[:, :, None])[:, :, 0] * homogeneous).sum(axis=1), 0.0)
    cost = np.bincount(edge_of, weights=price, minlength=len(shared))
    mass = np.bincount(edge_of, weights=weight[u], minlength=len(shared))
    off = np.sqrt(cost / np.maximum(mass, 1e-30))
    off[~movable] = np.inf

    # Every place has its cheapest way to go. Of the cheap ones those go that draw a lower lot than their neighbours.
    order = np.lexsort((off, source))
    living, begin = np.unique(source[order], return_index=True)
    first, price_of = np.zeros(count, np.intp), np.full(count, np.inf)
    first[living] = order[begin]
    price_of[living] = off[first[living]]
    ready = np.isfinite(price_of)
    if not ready.any():
        return faces, 0.0
    ready &= price_of <= np.quantile(price_of[ready], CHEAP)
    lot = np.where(ready, lots.permutation(count), count)
    corners = place[faces]
    lowest = lot.copy()
    around = lot[corners].min(axis=1)
    for i in range(3):
        np.minimum.at(lowest, corners[:, i], around)
    moving = np.flatnonzero(ready & (lot == lowest))
    moving = moving[np.argsort(price_of[moving], kind="stable")][: max(most // 2, 1)]
    chosen = np.zeros(len(shared), bool)
    chosen[first[moving]] = True
    becomes = np.arange(len(points))
    picked = chosen[edge_of]
    becomes[u[picked]] = v[picked]

    # Not where a triangle would face another way.
    moved = becomes[faces]
    old, new = (_normals(points[index, :3]) for index in (faces, moved))
    gone = (place[moved] == place[np.roll(moved, 1, axis=1)]).any(axis=1)
    length = np.linalg.norm(old, axis=1) * np.linalg.norm(new, axis=1)
    wrong = ~gone & (np.einsum("fi,fi->f", old, new) <= FLIPPED * length)
    refused = np.isin(place, place[faces[wrong][moved[wrong] != faces[wrong]]])
    becomes[refused] = np.flatnonzero(refused)
    moved = becomes[faces]
    gone = (place[moved] == place[np.roll(moved, 1, axis=1)]).any(axis=1)
    left = np.flatnonzero(becomes != np.arange(len(points)))
    np.add.at(quadrics, becomes[left], quadrics[left])
    np.add.at(weight, becomes[left], weight[left])
    taken = chosen & ~np.isin(source, place[refused])
    return moved[~gone], float(off[taken].max(initial=0.0))


def _normals(triangles: Array) -> Array:
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
