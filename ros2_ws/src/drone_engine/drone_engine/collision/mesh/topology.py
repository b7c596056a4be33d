"""Topology of a triangle mesh for contacts: normals of faces, edges and corners, and the owners of shared features.

A vertex or an edge is shared by several triangles. One of them owns it, so that each is tested once (representative
triangles: Curtis, Tamstorf, Manocha 2008, Fast Collision Detection for Deformable Models).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Floats, Int32s, Integers
from drone_engine.kernel import kernel

# Bits of a triangle: the first corner and the first edge that it owns, the first corner that it owns and that is
# pointed, and whether its surface is open.
CORNER, EDGE, POINTED, OPEN = 1, 8, 64, 512
CONVEX_HEIGHT = 1e-6  # of the edge's length: how far the neighbor must lie behind the triangle's plane at a convex edge
POINTED_SINE = 1e-4  # how far all edges of a pointed vertex must lie behind a plane through it, as a sine
CONE_ITERATIONS = 64  # of the search for that plane; nearly all vertices need one


class Topology(NamedTuple):
    """Topology of m triangles, in the frame and order of their corners."""

    normal: Floats  # (m, 7, 3) unit: of the face; of the neighbor across each edge i to i + 1; of each corner
    owned: Integers  # (m,) bits of owned features: corners 0 to 2, edges 0 to 2 (convex edges only), pointed corners
    # 0 to 2; OPEN for a triangle of a surface with a border
    ring_range: Int32s  # (m, 3, 2) first and last + 1 row of `ring` of each corner
    ring: Floats  # (k, 3) unit vectors along the edges that leave each vertex


class MeshCorners(NamedTuple):
    """The corners of the meshes of n bodies, each to be tested once: k nodes, m triangles of a forest of octrees."""

    link: NDArray[np.int32]  # (k, 4) as in Octree
    corners: Floats  # (m, 3, 3) m, in the frames of the meshes
    owned: Integers  # (m,) as in Topology
    roots: Integers  # (n,) root node of each body, -1 without a mesh


def find_topology(corners: Floats) -> Topology:
    """The topology of triangles (m, 3, 3), m; corners at the same place are one vertex. A degenerate triangle has a
    normal of zeros; the neighbor across a border is the triangle's own back.

    A vertex is pointed if all its edges lie behind some plane through it: only there, and along convex edges, can
    another flat surface touch the mesh. A vertex within a flat face, on a straight edge or of a saddle is not.
    """
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
    ring_start, ring = _rings(corners, vertex)
    pointed = np.zeros(len(ring_start) - 1, np.bool_)
    vertex_normal = np.zeros((len(pointed), 3))
    vertex_normal[vertex] = normal[:, 4:]
    _find_pointed(ring_start, ring, vertex_normal, pointed)
    owns_corner = owned[:, None] & (CORNER << np.arange(3)) != 0
    owned |= ((owns_corner & pointed[vertex]) * (POINTED << np.arange(3))).sum(1)
    owned |= _is_open(neighbor) * OPEN
    return Topology(normal, owned, np.stack([ring_start[vertex], ring_start[vertex + 1]], axis=-1).astype(np.int32),
                    ring)


def _rings(corners: Floats, vertex: Integers) -> tuple[Integers, Floats]:
    """Where the ring of each of v vertices begins, (v + 1,), and unit vectors along the edges that leave it, (k, 3)."""
    ends = np.stack([vertex, np.roll(vertex, -1, axis=1)], axis=-1).reshape(-1, 2)
    ends = np.unique(np.concatenate([ends, ends[:, ::-1]]), axis=0)
    ends = ends[ends[:, 0] != ends[:, 1]]
    place = np.empty((vertex.max(initial=-1) + 1, 3))
    place[vertex] = corners
    start = np.searchsorted(ends[:, 0], np.arange(len(place) + 1))
    return start, _unit(place[ends[:, 1]] - place[ends[:, 0]])


@kernel
def _find_pointed(ring_start, ring, normal, pointed):
    """Writes whether each vertex is pointed to pointed (v,): whether a direction exists against which all edges of its
    ring run by more than POINTED_SINE, on the side of its normal (v, 3). A perceptron finds it."""
    for v in range(pointed.shape[0]):
        first, last = ring_start[v], ring_start[v + 1]
        x, y, z = normal[v, 0], normal[v, 1], normal[v, 2]
        outward = x * x + y * y + z * z > 0.0
        if not outward:
            for k in range(first, last):
                x, y, z = x - ring[k, 0], y - ring[k, 1], z - ring[k, 2]
        for _ in range(CONE_ITERATIONS):
            length = math.sqrt(x * x + y * y + z * z)
            if length < 1e-12:
                break
            x, y, z = x / length, y / length, z / length
            worst, most = first, -2.0
            for k in range(first, last):
                along = x * ring[k, 0] + y * ring[k, 1] + z * ring[k, 2]
                if along > most:
                    worst, most = k, along
            if most < -POINTED_SINE:
                side = x * normal[v, 0] + y * normal[v, 1] + z * normal[v, 2]
                pointed[v] = side > 0.0 or not outward
                break
            shift = most + 2.0 * POINTED_SINE
            x, y, z = x - shift * ring[worst, 0], y - shift * ring[worst, 1], z - shift * ring[worst, 2]


def _is_open(neighbor: Integers) -> Integers:
    """1 for each triangle (m,) of a connected surface that has a border, else 0; neighbor: (m, 3) from `_edges`."""
    surface = np.arange(len(neighbor))
    _join_neighbors(neighbor, surface)
    has_border = np.zeros(len(neighbor), np.int64)
    np.maximum.at(has_border, surface, (neighbor < 0).any(axis=1).astype(np.int64))
    return has_border[surface]


@kernel
def _join_neighbors(neighbor, surface):
    """Writes the first triangle of each triangle's connected surface to surface (m,), 0 to m - 1 on input: union-find
    with path halving. neighbor: (m, 3)."""
    for i in range(surface.shape[0]):
        for k in range(3):
            a, b = i, neighbor[i, k]
            if b < 0:
                continue
            while surface[a] != a:
                surface[a] = surface[surface[a]]
                a = surface[a]
            while surface[b] != b:
                surface[b] = surface[surface[b]]
                b = surface[b]
            surface[max(a, b)] = min(a, b)
    for i in range(surface.shape[0]):
        while surface[i] != surface[surface[i]]:
            surface[i] = surface[surface[i]]


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
