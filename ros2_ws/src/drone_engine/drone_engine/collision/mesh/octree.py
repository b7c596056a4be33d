"""Octrees over the triangles of models: built once, kept by content, met pairwise in `traversal`.

A node splits its triangles by the octant of their centroids around the middle of the centroids' box, but only along
the axes that this box is long in: flat patches, and most of a surface is flat, split into four and not into eight.
"""

import hashlib
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.mesh import node_boxes as tight
from drone_engine.kernel import kernel

LEAF = 4
DEPTH = 40  # edges from the root to the deepest leaf; `traversal` sizes its stack by it
FAR = 1e30  # m; coordinates beyond are refused: the squares of such lengths overflow, and so does float32
LONG = 0.5  # of the longest side: a side as long as this is split


class Octree(NamedTuple):
    """The octree of one mesh, or of several one after the other; a mesh's root comes first among its nodes.

    box: (k, 6) centre and half extents of the tight AABB of a node's triangles, in the model's frame. link: (k, 4)
    first child, number of children (0: a leaf), first triangle, number of triangles (those of the whole subtree).
    corners: (m, 3, 3) triangles in the order of the leaves, a corner per row. face: (m,) each one's index as given.
    tight, wide and inner: the boxes that `tight` prunes by, of a node and of its children, and where these are.
    """

    box: Floats
    link: NDArray[np.int32]
    corners: Floats
    face: Integers
    tight: NDArray[np.float32]
    wide: NDArray[np.float32]
    inner: NDArray[np.int32]


def build(vertices: ArrayLike, faces: ArrayLike) -> Octree:
    """The octree of a mesh: vertices (v, 3) in m, faces (f, 3) indices. Raises ValueError for what is not a mesh."""
    points, indices = _mesh(vertices, faces)
    corners = points[indices]
    order = np.arange(len(indices))
    box, link = np.empty((2 * len(indices) - 1, 6)), np.empty((2 * len(indices) - 1, 4), np.int32)
    nodes = _split(corners, corners.mean(axis=1), order, np.empty_like(order), box, link)
    box, link, corners = box[:nodes].copy(), link[:nodes].copy(), corners[order]
    boxes, inner = np.empty((nodes, tight.ROWS), np.float32), np.empty(nodes, np.int32)
    tight.fit(box, link, corners, boxes)
    wide = np.empty((int((link[:, 1] > 0).sum()), tight.ROWS, tight.LANES), np.float32)
    tight.spread(link, boxes, inner, wide)
    return _sealed(Octree(box, link, corners, order, boxes, wide, inner))


_kept: dict[bytes, Octree] = {}


def of(vertices: ArrayLike, faces: ArrayLike) -> Octree:
    """As `build`, but the same mesh is built once in the life of the program."""
    points, indices = _mesh(vertices, faces)
    digest = hashlib.sha256(points.tobytes() + indices.tobytes()).digest()
    if digest not in _kept:
        _kept[digest] = build(points, indices)
    return _kept[digest]


def join(trees: Sequence[Octree]) -> tuple[Octree, Integers]:
    """Several trees in one set of arrays, and the root (n,) of each; `face` still counts within each mesh."""
    nodes = np.cumsum([0, *(len(tree.box) for tree in trees)])
    triangles = np.cumsum([0, *(len(tree.corners) for tree in trees)])
    if triangles[-1] > np.iinfo(np.int32).max:
        raise ValueError(f"trees: expected at most 2^31 - 1 triangles, got {triangles[-1]}")
    link = [tree.link + np.array([node, 0, triangle, 0], np.int32)
            for tree, node, triangle in zip(trees, nodes, triangles, strict=False)]
    wide = np.cumsum([0, *(len(tree.wide) for tree in trees)])
    inner = [np.where(tree.inner < 0, -1, tree.inner + start).astype(np.int32)
             for tree, start in zip(trees, wide, strict=False)]
    whole = (np.concatenate(arrays) for arrays in zip(*trees, strict=True))
    forest = Octree(*whole)._replace(link=np.concatenate(link), inner=np.concatenate(inner))
    return _sealed(forest), nodes[:-1]


def _sealed(tree: Octree) -> Octree:
    """The same, not to be written to: trees are shared, and kernels compile once and not for either kind of array."""
    for array in tree:
        array.flags.writeable = False
    return tree


# Of no mesh, for kernels that ask for one.
EMPTY = _sealed(Octree(np.empty((0, 6)), np.empty((0, 4), np.int32), np.empty((0, 3, 3)), np.empty(0, np.int64),
                       np.empty((0, tight.ROWS), np.float32), np.empty((0, tight.ROWS, tight.LANES), np.float32),
                       np.empty(0, np.int32)))


def _mesh(vertices: ArrayLike, faces: ArrayLike) -> tuple[Floats, Integers]:
    points = np.ascontiguousarray(vertices, dtype=np.float64)
    indices = np.asarray(faces)
    if points.ndim != 2 or points.shape[1] != 3 or not (np.abs(points) <= FAR).all():
        raise ValueError(f"vertices: expected finite numbers up to {FAR:g} m of shape (v, 3), got shape {points.shape}")
    if indices.ndim != 2 or indices.shape[1] != 3 or not len(indices) or indices.dtype.kind not in "iu":
        raise ValueError(f"faces: expected integers of shape (f, 3), at least one face, got {indices.dtype} of shape "
                         f"{indices.shape}")
    if indices.min() < 0 or indices.max() >= len(points):
        raise ValueError(f"faces: expected indices from 0 to {len(points) - 1}, got {indices.min()} to {indices.max()}")
    return points, np.ascontiguousarray(indices, dtype=np.int64)


@kernel
def _half(low, high, centre):
    """The half extent that reaches both ends from the centre, never less than in exact arithmetic."""
    half = 0.0
    for end, sign in ((high, 1.0), (low, -1.0)):
        difference = end - centre
        # The rounding error of a difference, exactly (Knuth 1969, TwoSum).
        lost = difference - end
        error = (end - (difference - lost)) - (centre + lost)
        reach = sign * difference
        if sign * error > 0.0:
            reach = np.nextafter(reach, np.inf)
        half = max(half, reach)
    return half


@kernel
def _bound(corners, order, first, count, box, node):
    """Writes the box of the triangles order[first : first + count]."""
    for axis in range(3):
        low, high = np.inf, -np.inf
        for i in range(first, first + count):
            for corner in range(3):
                x = corners[order[i], corner, axis]
                low, high = min(low, x), max(high, x)
        centre = 0.5 * low + 0.5 * high
        box[node, axis], box[node, 3 + axis] = centre, _half(low, high, centre)


@kernel
def _middle(centroid, order, first, count):
    """Where to cut triangles order[first : first + count]: the middle of their centroids along the long axes, else
    infinity."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for i in range(first, first + count):
        for axis in range(3):
            low[axis] = min(low[axis], centroid[order[i], axis])
            high[axis] = max(high[axis], centroid[order[i], axis])
    longest = max(0.5 * high[0] - 0.5 * low[0], 0.5 * high[1] - 0.5 * low[1], 0.5 * high[2] - 0.5 * low[2])
    for axis in range(3):
        is_long = 0.5 * high[axis] - 0.5 * low[axis] >= LONG * longest
        low[axis] = 0.5 * low[axis] + 0.5 * high[axis] if is_long else np.inf
    return low[0], low[1], low[2]


@kernel
def _octant(centroid, i, middle):
    return ((centroid[i, 0] > middle[0]) + 2 * (centroid[i, 1] > middle[1]) + 4 * (centroid[i, 2] > middle[2]))


@kernel
def _split(corners, centroid, order, spare, box, link):
    """Writes all nodes, parents before children and siblings side by side, sorts `order` by leaves; returns how many.

    The nodes are their own queue: those before `node` are done, those up to `nodes` wait with their triangles set.
    """
    link[0, 0], link[0, 1], link[0, 2], link[0, 3] = 0, 0, 0, order.shape[0]
    depth = np.zeros(box.shape[0], np.uint8)
    start = np.empty(9, np.int64)
    nodes, node = 1, 0
    while node < nodes:
        first, count = link[node, 2], link[node, 3]
        _bound(corners, order, first, count, box, node)
        link[node, 0], link[node, 1] = nodes, 0
        if count > LEAF and depth[node] < DEPTH:
            middle = _middle(centroid, order, first, count)
            start[:] = 0
            for i in range(first, first + count):
                start[_octant(centroid, order[i], middle) + 1] += 1
            children = 0
            for octant in range(8):
                children += start[octant + 1] > 0
                start[octant + 1] += start[octant]
            if children > 1:
                for octant in range(8):
                    size = start[octant + 1] - start[octant]
                    if size:
                        link[nodes, 2], link[nodes, 3] = first + start[octant], size
                        depth[nodes] = depth[node] + 1
                        nodes += 1
                link[node, 1] = children
                for i in range(first, first + count):
                    octant = _octant(centroid, order[i], middle)
                    spare[first + start[octant]] = order[i]
                    start[octant] += 1
                order[first:first + count] = spare[first:first + count]
        node += 1
    return nodes
