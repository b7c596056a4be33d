"""Topology of a triangle mesh for contacts: normals of faces, edges and corners, and the owners of shared features.

A vertex or an edge is shared by several triangles. One of them owns it, so that each is tested once (representative
triangles: Curtis, Tamstorf, Manocha 2008, Fast Collision Detection for Deformable Models).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Floats, Integers

CORNER, EDGE = 1, 8  # bit of the first corner and of the first edge that a triangle owns
CONVEX_HEIGHT = 1e-6  # of the edge's length: how far the neighbor must lie behind the triangle's plane at a convex edge


class Topology(NamedTuple):
    """Topology of m triangles, in the frame and order of their corners."""

    normal: Floats  # (m, 7, 3) unit: of the face; of the neighbor across each edge i to i + 1; of each corner
    owned: Integers  # (m,) bits of owned features: corners 0 to 2, then edges 0 to 2; convex edges only


class MeshCorners(NamedTuple):
    """The corners of the meshes of n bodies, each to be tested once: k nodes, m triangles of a forest of octrees."""

    link: NDArray[np.int32]  # (k, 4) as in Octree
    corners: Floats  # (m, 3, 3) m, in the frames of the meshes
    owned: Integers  # (m,) as in Topology
    roots: Integers  # (n,) root node of each body, -1 without a mesh


def find_topology(corners: Floats) -> Topology:
    """The topology of triangles (m, 3, 3), m; corners at the same place are one vertex. A degenerate triangle has a
    normal of zeros; the neighbor across a border is the triangle's own back."""
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
    neighbor, owned_edge = _edges(corners, side, face, vertex)
    normal[:, 1:4] = np.where(neighbor[..., None] >= 0, face[neighbor], -face[:, None])
    owned |= (owned_edge * (EDGE << np.arange(3))).sum(1)
    return Topology(normal, owned)


def _unit(vectors: Floats) -> Floats:
    """Vectors (..., 3) scaled to length 1; zero vectors stay."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: Floats = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
    return unit


def _corner_normals(side: Floats, face: Floats, vertex: Integers) -> Floats:
    """The normal of each corner, (m, 3, 3): the mean of the face normals around its vertex, weighted by the angles of
    the faces there. It points to the side of every point that the vertex is the closest to (Baerentzen and Aanaes 2005,
    Signed Distance Computation Using the Angle Weighted Pseudonormal).

    side: (m, 3, 3) edges as vectors; face: (m, 3) unit normals; vertex: (m, 3) indices.
    """
    along = _unit(side)
    back = -np.roll(along, 1, axis=1)
    angle = np.arccos(np.clip((along * back).sum(-1), -1.0, 1.0))
    sums = np.zeros((vertex.max(initial=-1) + 1, 3))
    np.add.at(sums, vertex, angle[..., None] * face[:, None])
    normals: Floats = _unit(sums)[vertex]
    return normals


def _edges(corners: Floats, side: Floats, face: Floats, vertex: Integers) -> tuple[Integers, Integers]:
    """Two arrays (m, 3) for each triangle's edges: the neighbor across, -1 at a border; 1 if the edge is convex and the
    triangle owns it, else 0. Arguments as in `_corner_normals`."""
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
    convex = (across < 0) | (height < -CONVEX_HEIGHT * np.linalg.norm(side, axis=-1).ravel())
    neighbor = np.where(across < 0, -1, across // 3)
    return neighbor.reshape(m, 3), (convex & (own == first)).astype(np.int64).reshape(m, 3)
