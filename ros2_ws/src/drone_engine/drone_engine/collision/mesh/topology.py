"""What the contact of two meshes needs to know about a triangle besides its corners: normals, and who owns what.

A vertex and an edge are shared by several triangles. Each is owned by one of them, so that each is looked at once
(representative triangles: Curtis, Tamstorf, Manocha 2008, Fast Collision Detection for Deformable Models).
"""

from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Floats, Integers

CORNER, EDGE = 1, 8  # bit of the first corner and of the first edge that a triangle owns
FLAT = 1e-6  # of the edge's length: how far the neighbour must lie behind the triangle's plane for a sharp edge


class Surface(NamedTuple):
    """m triangles, in the frame and order of their corners."""

    normal: Floats  # (m, 7, 3) unit: the face's; across each edge i to i + 1 the neighbour's; each corner's
    owned: Integers  # (m,) bits: corners 0 to 2, then edges 0 to 2, these only where they stick out


def describe(corners: Floats) -> Surface:
    """The surface of triangles (m, 3, 3); corners that share a place are one vertex. A degenerate triangle has a
    normal of zeros; the neighbour across a border is the triangle's own back."""
    m = len(corners)
    _, vertex = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    vertex = vertex.reshape(m, 3)
    side = np.roll(corners, -1, axis=1) - corners
    face = _unit(np.cross(side[:, 0], -side[:, 2]))
    normal = np.empty((m, 7, 3))
    normal[:, 0] = face
    normal[:, 4:] = _corner_normals(side, face, vertex)
    owned = np.zeros(m, np.int64)
    first = np.unique(vertex.ravel(), return_index=True)[1]
    np.bitwise_or.at(owned, first // 3, CORNER << first % 3)
    neighbour, stands_out = _edges(corners, side, face, vertex)
    normal[:, 1:4] = np.where(neighbour[..., None] >= 0, face[neighbour], -face[:, None])
    owned |= (stands_out * (EDGE << np.arange(3))).sum(1)
    return Surface(normal, owned)


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: Floats = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
    return unit


def _corner_normals(side: Floats, face: Floats, vertex: Integers) -> Floats:
    """(m, 3, 3): of each corner the mean of the normals around its vertex, by their angles there, which looks
    towards any point that the vertex is the closest to (Baerentzen and Aanaes 2005, Signed Distance Computation)."""
    along = _unit(side)
    back = -np.roll(along, 1, axis=1)
    angle = np.arccos(np.clip((along * back).sum(-1), -1.0, 1.0))
    sums = np.zeros((vertex.max(initial=-1) + 1, 3))
    np.add.at(sums, vertex, angle[..., None] * face[:, None])
    normals: Floats = _unit(sums)[vertex]
    return normals


def _edges(corners: Floats, side: Floats, face: Floats, vertex: Integers) -> tuple[Integers, Integers]:
    """For each triangle's edges, (m, 3): the triangle across or -1; 1 where it stands out and this one owns it."""
    m = len(corners)
    ends = np.sort(np.stack([vertex, np.roll(vertex, -1, axis=1)], -1).reshape(-1, 2), axis=1)
    _, edge = np.unique(ends, axis=0, return_inverse=True)
    order = np.argsort(edge, kind="stable")
    start = np.flatnonzero(np.diff(edge[order], prepend=-1))
    count = np.diff(start, append=3 * m)
    first = order[start][edge]
    second = np.where(count > 1, order[np.minimum(start + 1, 3 * m - 1)], -1)[edge]
    own = np.arange(3 * m)
    across = np.where(own == first, second, first)
    opposite = corners.reshape(-1, 3)[across // 3 * 3 + (across % 3 + 2) % 3]
    height = ((opposite - corners.reshape(-1, 3)) * np.repeat(face, 3, axis=0)).sum(-1)
    sharp = (across < 0) | (height < -FLAT * np.linalg.norm(side, axis=-1).ravel())
    neighbour = np.where(across < 0, -1, across // 3)
    return neighbour.reshape(m, 3), (sharp & (own == first)).astype(np.int64).reshape(m, 3)
