"""All contacts of two posed meshes, from pairs of near triangles or of leaf boxes, and of a mesh with a plane.

Contacts are written to `work.found`; each kernel returns their number, including those that do not fit, which are not
written. position: (n, 3) m; axes: (n, 3, 3), one a row; world frame. meshes: MeshArrays; work: PairScratch.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box import obb
from drone_engine.collision.mesh import traversal
from drone_engine.collision.mesh.contact_buffer import ContactBuffer, contact_buffer
from drone_engine.collision.mesh.features import (
    ANGULAR_VELOCITY,
    EDGES,
    MOTION_SIZE,
    POSITION,
    ROTATION,
    VELOCITY,
    MeshFeatures,
    PairState,
    feature_contacts,
    place,
    place_corners,
)
from drone_engine.collision.mesh.octree import Octree
from drone_engine.collision.mesh.overlap import OverlapScratch, overlap_scratch
from drone_engine.collision.mesh.topology import CORNER
from drone_engine.collision.mesh.transforms import axes_rotation, transform_point
from drone_engine.collision.triangle.point_distance import squared_distance
from drone_engine.kernel import kernel

SEARCH_DEPTH = 0.01  # m; contacts are searched this far below a surface
DEEP_SEARCH_DEPTH = 0.1  # m; the same if nothing was found although the surfaces intersect
SHALLOW_DEPTH = 1e-3  # m; contacts that are less deep are kept without a check for a shorter way out
OWN_FACE = 0.01  # of that distance: a point this close to a face lies on it
MAX_PAIRS_WITH_ALL_POINTS = 64  # pairs of leaves; with more, only the deepest point of each pair is kept
MIN_CLEARANCE = 0.5  # of a contact's depth: least distance of its feature from the other surface (0.7 at a cube's
# edge); if it is closer, there is a shorter way out


class MeshArrays(NamedTuple):
    """The meshes of n bodies."""

    tree: Octree  # the forest of all octrees
    features: MeshFeatures  # of its triangles
    roots: Integers  # (n,) root node of each body, -1 without a mesh


class Velocities(NamedTuple):
    """Velocities of n placed bodies, world frame."""

    linear: Floats  # (n, 3) m/s
    angular: Floats  # (n, 3) rad/s
    dt: float  # s: contacts that do not close within this time are left out; 0: none
    at_impact: bool = False  # whether the bodies have stopped at their impact and may swing round it


class PairScratch(NamedTuple):
    """Buffers for the contacts of one pair of meshes."""

    near: NDArray[np.int32]  # (m, 2) pairs of triangles or of leaves
    found: ContactBuffer
    unassigned: Booleans  # (k,) scratch of `reduce_contacts`
    spread: Floats  # (k,) scratch of `reduce_contacts`
    pair: PairState
    overlap: OverlapScratch
    leaves: obb.Boxes  # of 2 boxes: a leaf of each body
    box: obb.BoxScratch
    traversal: traversal.TraversalScratch


def pair_scratch(near: int, contacts: int) -> PairScratch:
    """Buffers for so many pairs of triangles or leaves, and so many contacts."""
    return PairScratch(np.empty((near, 2), np.int32), contact_buffer(contacts), np.empty(contacts, np.bool_),
                       np.empty(contacts), PairState(np.empty((2, 10, 3)), np.empty((2, MOTION_SIZE)), np.empty(4)),
                       overlap_scratch(), obb.Boxes(np.empty((2, 3)), np.empty((2, 3, 3)), np.empty((2, 3))),
                       obb.scratch(), traversal.scratch())


@kernel
def set_pair(placed, velocities, a, b, margin, inside, meshes, pair):
    """Writes the motion of bodies a and b, and the limits of their contacts, to a PairState.

    placed: PlacedBodies; velocities: Velocities. margin, inside: m, how far apart and how deep contacts may be. meshes:
    MeshArrays.
    """
    motion = pair.motion
    for side in range(2):
        i = a if side == 0 else b
        r = axes_rotation(placed.axes, i)
        for c in range(9):
            motion[side, ROTATION + c] = r[c]
        for c in range(3):
            motion[side, POSITION + c] = placed.position[i, c]
            motion[side, VELOCITY + c] = 0.0 if velocities.at_impact else velocities.linear[i, c]
            motion[side, ANGULAR_VELOCITY + c] = velocities.angular[i, c]
    pair.limits[0], pair.limits[1], pair.limits[2] = margin, inside, velocities.dt
    pair.limits[3] = 0.0
    if velocities.at_impact:
        pair.limits[3] = min(margin / min(mesh_radius(a, meshes), mesh_radius(b, meshes)), 1.0)


@kernel
def mesh_radius(body, meshes):
    """Upper bound of the distance of a mesh's points from its body's position, m; meshes: MeshArrays."""
    box = meshes.tree.box[meshes.roots[body]]
    return math.sqrt((abs(box[0]) + box[3]) ** 2 + (abs(box[1]) + box[4]) ** 2 + (abs(box[2]) + box[5]) ** 2)


@kernel
def triangle_contacts(position, axes, a, b, near_count, meshes, work):
    """Writes all contacts of the first near_count pairs of triangles of work.near, of bodies a and b, within the limits
    of work.pair. Contacts with a shorter way out elsewhere are left out."""
    near, placed, out = work.near, work.pair.placed, work.found
    corners, features = meshes.tree.corners, meshes.features
    normal, point, separation, feature = out.normal, out.point, out.separation, out.feature
    ra, rb = axes_rotation(axes, a), axes_rotation(axes, b)
    found, last = 0, np.int64(-1)
    for k in range(near_count):
        i, j = np.int64(near[k, 0]), np.int64(near[k, 1])  # for the 64 bits of a feature
        if i != last:
            place(corners[i], features.normals[i], ra, position[a, 0], position[a, 1], position[a, 2], placed[0])
            last = i
        place(corners[j], features.normals[j], rb, position[b, 0], position[b, 1], position[b, 2], placed[1])
        found = feature_contacts(i, j, features, work.pair, out, found)
    if found > separation.shape[0]:
        return found
    kept = 0
    for c in range(found):
        if separation[c] < -SHALLOW_DEPTH and _has_shorter_way_out(
                position, axes, a, b, near, near_count, corners, placed, point[c], feature[c],
                MIN_CLEARANCE * -separation[c]):
            continue
        for k in range(3):
            normal[kept, k] = normal[c, k]
            point[kept, 0, k], point[kept, 1, k] = point[c, 0, k], point[c, 1, k]
        separation[kept], feature[kept] = separation[c], feature[c]
        kept += 1
    return kept


@kernel
def _has_shorter_way_out(position, axes, a, b, near, near_count, corners, placed, point, feature, depth):
    """Whether the surface of the other body is closer than `depth` m to the corner or one of the edges of a contact;
    point: (2, 3), feature: its identifier. Of an edge's own faces one is closer than the edge, but no way out."""
    for side in range(2):
        if feature % 4 < EDGES and side != feature % 4:
            continue
        body = b if side == 0 else a
        r = axes_rotation(axes, body)
        last = -1
        for k in range(near_count):
            i = near[k, 1 - side]
            if i == last:
                continue
            last = i
            place_corners(corners[i], r, position[body, 0], position[body, 1], position[body, 2], placed[0])
            if squared_distance(point[side, 0], point[side, 1], point[side, 2], placed[0]) < depth * depth and (
                    feature % 4 != EDGES or squared_distance(point[1 - side, 0], point[1 - side, 1], point[1 - side, 2],
                                                             placed[0]) > (OWN_FACE * depth) ** 2):
                return True
    return False


@kernel
def leaf_contacts(position, axes, a, b, near_count, meshes, margin, work, manifolds, at):
    """Writes the contacts of the boxes of the first near_count pairs of leaves of work.near, of bodies a and b, at most
    `margin` m apart. manifolds: ContactArrays, row `at` of which is used as scratch."""
    near, boxes, box, out = work.near, work.leaves, meshes.tree.box, work.found
    center, half = boxes.center, boxes.half
    normal, point, separation, feature = out.normal, out.point, out.separation, out.feature
    box_normal, box_point = manifolds.normal, manifolds.point
    box_separation, box_feature = manifolds.separation, manifolds.feature
    found = 0
    for row in range(3):
        for c in range(3):
            boxes.axes[0, row, c], boxes.axes[1, row, c] = axes[a, row, c], axes[b, row, c]
    for k in range(near_count):
        for side in range(2):
            body, leaf = (a, near[k, 0]) if side == 0 else (b, near[k, 1])
            r = axes_rotation(axes, body)
            center[side, 0], center[side, 1], center[side, 2] = transform_point(
                r, position[body, 0], position[body, 1], position[body, 2], box[leaf, 0], box[leaf, 1], box[leaf, 2])
            half[side, 0], half[side, 1], half[side, 2] = box[leaf, 3], box[leaf, 4], box[leaf, 5]
        points = obb.contact(boxes, 0, boxes, 1, margin, at, manifolds.points, box_normal, box_point, box_separation,
                             box_feature, work.box)
        deepest = 0
        for i in range(1, points):
            if box_separation[at, i] < box_separation[at, deepest]:
                deepest = i
        for i in range(points):
            if near_count > MAX_PAIRS_WITH_ALL_POINTS and i != deepest:
                continue
            if found < separation.shape[0]:
                gap = box_separation[at, i]
                for c in range(3):
                    normal[found, c] = box_normal[at, c]
                    point[found, 0, c] = box_point[at, i, c] - 0.5 * gap * box_normal[at, c]
                    point[found, 1, c] = box_point[at, i, c] + 0.5 * gap * box_normal[at, c]
                separation[found] = gap
                feature[found] = (np.int64(near[k, 0]) << 36) ^ (np.int64(near[k, 1]) << 12) ^ box_feature[at, i]
            found += 1
    return found


@kernel
def plane_contacts(position, axes, i, height, meshes, margin, work):
    """Writes the contacts of the corners of body i with the half-space below a height, m, at most `margin` m above it;
    normals point up."""
    corners, owned, root = meshes.tree.corners, meshes.features.owned, meshes.roots[i]
    first, count = meshes.tree.link[root, 2], meshes.tree.link[root, 3]
    normal, point = work.found.normal, work.found.point
    separation, feature = work.found.separation, work.found.feature
    r = axes_rotation(axes, i)
    found = 0
    for t in range(first, first + count):
        for c in range(3):
            if not owned[t] & (CORNER << c):
                continue
            x, y, z = corners[t, c, 0], corners[t, c, 1], corners[t, c, 2]
            gap = (r[6] * x + r[7] * y + r[8] * z) + position[i, 2] - height
            if gap > margin:
                continue
            if found < separation.shape[0]:
                normal[found, 0], normal[found, 1], normal[found, 2] = 0.0, 0.0, 1.0
                for side in range(2):
                    point[found, side, 0] = (r[0] * x + r[1] * y + r[2] * z) + position[i, 0]
                    point[found, side, 1] = (r[3] * x + r[4] * y + r[5] * z) + position[i, 1]
                    point[found, side, 2] = height + gap * (1 - side)
                separation[found], feature[found] = gap, 3 * t + c
            found += 1
    return found
