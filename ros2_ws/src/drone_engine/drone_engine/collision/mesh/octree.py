"""Octrees over the triangles of meshes, built once for each content.

A node splits its triangles by the octant of their centroids around the center of the centroids' bounding box, but only
along the long axes of that box: flat patches, which most of a surface is, split into four children instead of eight.
"""

import hashlib
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drone_engine.arrays import Floats, Integers
from drone_engine.collision.mesh.node_boxes import LANES, ROWS, fit_boxes, group_children
from drone_engine.kernel import allocating, kernel

LEAF_SIZE = 4  # triangles; a node with more is split
MAX_DEPTH = 40  # edges from the root to the deepest leaf; traversals size their stacks by it
MAX_COORDINATE = 1e30  # m; the squares of larger coordinates overflow, and so does float32
SPLIT_RATIO = 0.5  # of the longest side: sides at least as long are split


class Octree(NamedTuple):
    """The octree of one mesh, or of several meshes one after the other (a forest); k nodes, m triangles, g inner nodes.

    The root of a mesh is the first of its nodes. Coordinates are in the frame of the mesh, m.
    """

    box: Floats  # (k, 6) center and half extents of the axis-aligned bounding box of a node's triangles
    link: NDArray[np.int32]  # (k, 4) first child, number of children (0: leaf), first triangle, number of triangles in
    # the subtree
    corners: Floats  # (m, 3, 3) triangles in the order of the leaves, a corner per row
    face: Integers  # (m,) index of each triangle among the faces given
    node_box: NDArray[np.float32]  # (k, ROWS) oriented and axis-aligned box of each node, see `node_boxes`
    child_boxes: NDArray[np.float32]  # (g, ROWS, LANES) the same of an inner node's children, side by side
    child_group: NDArray[np.int32]  # (k,) row of child_boxes, -1 for a leaf


def build(vertices: ArrayLike, faces: ArrayLike) -> Octree:
    """The octree of a mesh: vertices (v, 3) in m, faces (f, 3) indices of vertices. Raises ValueError unless they are a
    mesh with at least one face."""
    points, indices = _checked_mesh(vertices, faces)
    corners = points[indices]
    order = np.arange(len(indices))
    box, link = np.empty((2 * len(indices) - 1, 6)), np.empty((2 * len(indices) - 1, 4), np.int32)
    nodes = _split(corners, corners.mean(axis=1), order, np.empty_like(order), box, link)
    box, link, corners = box[:nodes].copy(), link[:nodes].copy(), corners[order]
    node_box, child_group = np.empty((nodes, ROWS), np.float32), np.empty(nodes, np.int32)
    fit_boxes(box, link, corners, node_box)
    child_boxes = np.empty((int((link[:, 1] > 0).sum()), ROWS, LANES), np.float32)
    group_children(link, node_box, child_group, child_boxes)
    return _read_only(Octree(box, link, corners, order, node_box, child_boxes, child_group))


_cache: dict[bytes, Octree] = {}  # by the digest of the mesh


def build_cached(vertices: ArrayLike, faces: ArrayLike) -> Octree:
    """As `build`, but the octree of each mesh is built once per process."""
    points, indices = _checked_mesh(vertices, faces)
    digest = hashlib.sha256(points.tobytes() + indices.tobytes()).digest()
    if digest not in _cache:
        _cache[digest] = build(points, indices)
    return _cache[digest]


def join(trees: Sequence[Octree]) -> tuple[Octree, Integers]:
    """The forest of several trees, and the root (n,) of each; `face` still counts within each mesh. Raises ValueError
    if there are too many triangles for int32."""
    nodes = np.cumsum([0, *(len(tree.box) for tree in trees)])
    triangles = np.cumsum([0, *(len(tree.corners) for tree in trees)])
    if triangles[-1] > np.iinfo(np.int32).max:
        raise ValueError(f"trees: expected at most 2^31 - 1 triangles, got {triangles[-1]}")
    link = [tree.link + np.array([node, 0, triangle, 0], np.int32)
            for tree, node, triangle in zip(trees, nodes, triangles, strict=False)]
    groups = np.cumsum([0, *(len(tree.child_boxes) for tree in trees)])
    child_group = [np.where(tree.child_group < 0, -1, tree.child_group + start).astype(np.int32)
                   for tree, start in zip(trees, groups, strict=False)]
    joined = (np.concatenate(arrays) for arrays in zip(*trees, strict=True))
    forest = Octree(*joined)._replace(link=np.concatenate(link), child_group=np.concatenate(child_group))
    return _read_only(forest), nodes[:-1]


def _read_only(tree: Octree) -> Octree:
    """Makes the arrays of a tree read-only: trees are shared, and kernels are compiled for one kind of array only."""
    for array in tree:
        array.flags.writeable = False
    return tree


# An octree without nodes, for kernels that need one where there is no mesh.
EMPTY = _read_only(Octree(np.empty((0, 6)), np.empty((0, 4), np.int32), np.empty((0, 3, 3)), np.empty(0, np.int64),
                          np.empty((0, ROWS), np.float32), np.empty((0, ROWS, LANES), np.float32),
                          np.empty(0, np.int32)))


def _checked_mesh(vertices: ArrayLike, faces: ArrayLike) -> tuple[Floats, Integers]:
    """Vertices and faces as contiguous arrays. Raises ValueError for wrong shapes, types, coordinates or indices."""
    points = np.ascontiguousarray(vertices, dtype=np.float64)
    indices = np.asarray(faces)
    if points.ndim != 2 or points.shape[1] != 3 or not (np.abs(points) <= MAX_COORDINATE).all():
        raise ValueError(f"vertices: expected finite numbers up to {MAX_COORDINATE:g} m of shape (v, 3), got shape "
                         f"{points.shape}")
    if indices.ndim != 2 or indices.shape[1] != 3 or not len(indices) or indices.dtype.kind not in "iu":
        raise ValueError(f"faces: expected integers of shape (f, 3), at least one face, got {indices.dtype} of shape "
                         f"{indices.shape}")
    if indices.min() < 0 or indices.max() >= len(points):
        raise ValueError(f"faces: expected indices from 0 to {len(points) - 1}, got {indices.min()} to {indices.max()}")
    return points, np.ascontiguousarray(indices, dtype=np.int64)


@kernel
def _half_extent(low, high, center):
    """The half extent that reaches both ends of an interval from its center, never less than in exact arithmetic, m."""
    half = 0.0
    for end, sign in ((high, 1.0), (low, -1.0)):
        difference = end - center
        # The rounding error of a difference, exactly (Knuth 1969, TwoSum).
        shifted = difference - end
        error = (end - (difference - shifted)) - (center + shifted)
        reach = sign * difference
        if sign * error > 0.0:
            reach = np.nextafter(reach, np.inf)
        half = max(half, reach)
    return half


@kernel
def _write_bounds(corners, order, first, count, box, node):
    """Writes center and half extents of the triangles order[first : first + count] to row `node` of box (k, 6)."""
    for axis in range(3):
        low, high = np.inf, -np.inf
        for i in range(first, first + count):
            for corner in range(3):
                x = corners[order[i], corner, axis]
                low, high = min(low, x), max(high, x)
        center = 0.5 * low + 0.5 * high
        box[node, axis], box[node, 3 + axis] = center, _half_extent(low, high, center)


@allocating
def _split_point(centroid, order, first, count):
    """The point (x, y, z) at which to split triangles order[first : first + count]: the center of their centroids'
    bounding box along its long axes, infinity along the others."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for i in range(first, first + count):
        for axis in range(3):
            low[axis] = min(low[axis], centroid[order[i], axis])
            high[axis] = max(high[axis], centroid[order[i], axis])
    longest = max(0.5 * high[0] - 0.5 * low[0], 0.5 * high[1] - 0.5 * low[1], 0.5 * high[2] - 0.5 * low[2])
    for axis in range(3):
        is_long = 0.5 * high[axis] - 0.5 * low[axis] >= SPLIT_RATIO * longest
        low[axis] = 0.5 * low[axis] + 0.5 * high[axis] if is_long else np.inf
    return low[0], low[1], low[2]


@kernel
def _octant(centroid, i, split_point):
    """The octant of triangle i's centroid, centroid (m, 3), around a point: bits 1, 2, 4 for above it along x, y, z."""
    return ((centroid[i, 0] > split_point[0]) + 2 * (centroid[i, 1] > split_point[1])
            + 4 * (centroid[i, 2] > split_point[2]))


@allocating
def _split(corners, centroid, order, spare, box, link):
    """Writes all nodes to box (k, 6) and link (k, 4), parents before children and siblings side by side, and sorts
    order (m,) by leaves; returns the number of nodes.

    corners: (m, 3, 3); centroid: (m, 3); spare: (m,) scratch. The nodes serve as the queue: those before `node` are
    done, those from `node` to `nodes` have their triangles set and wait.
    """
    link[0, 0], link[0, 1], link[0, 2], link[0, 3] = 0, 0, 0, order.shape[0]
    depth = np.zeros(box.shape[0], np.uint8)
    start = np.empty(9, np.int64)
    nodes, node = 1, 0
    while node < nodes:
        first, count = link[node, 2], link[node, 3]
        _write_bounds(corners, order, first, count, box, node)
        link[node, 0], link[node, 1] = nodes, 0
        if count > LEAF_SIZE and depth[node] < MAX_DEPTH:
            split_point = _split_point(centroid, order, first, count)
            start[:] = 0
            for i in range(first, first + count):
                start[_octant(centroid, order[i], split_point) + 1] += 1
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
                    octant = _octant(centroid, order[i], split_point)
                    spare[first + start[octant]] = order[i]
                    start[octant] += 1
                order[first:first + count] = spare[first:first + count]
        node += 1
    return nodes
