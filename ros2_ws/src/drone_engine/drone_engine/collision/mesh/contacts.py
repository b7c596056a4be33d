"""All contacts of two posed meshes, from pairs of near triangles or of leaf boxes, and of a mesh with a plane.

Contacts are written to: normal (k, 3) unit, from a to b; point (k, 2, 3) m, on a and on b; separation (k,) m, negative
in penetration; feature (k,), an identifier that is stable from step to step. Each kernel returns their number; those
that do not fit are counted, not written. position: (n, 3) m; axes: (n, 3, 3), one a row; world frame.
"""

from drone_engine.collision.box import obb
from drone_engine.collision.mesh import features
from drone_engine.collision.mesh.topology import CORNER
from drone_engine.collision.mesh.transforms import axes_rotation, transform_point
from drone_engine.kernel import kernel

SEARCH_DEPTH = 0.01  # m; contacts are searched this far below a surface, or as far as the margin if that is larger
DEEP_SEARCH_DEPTH = 0.1  # m; the same if nothing was found although the surfaces intersect
SHALLOW_DEPTH = 1e-3  # m; contacts that are less deep are kept without a check for a shorter way out
MAX_PAIRS_WITH_ALL_POINTS = 64  # pairs of leaves; with more, only the deepest point of each pair is kept
MIN_CLEARANCE = 0.5  # of a contact's depth: least distance of its feature from the other surface (0.7 at a cube's
# edge); if it is closer, there is a shorter way out


@kernel
def triangle_contacts(position, axes, a, b, near, near_count, corners, normals, owned, margin, inside, placed,
                      normal, point, separation, feature):
    """Writes all contacts of the first near_count pairs of triangles near (m, 2) of bodies a and b, at most `margin` m
    apart and `inside` m deep.

    corners (t, 3, 3), normals (t, 7, 3), owned (t,): as in Octree and Topology. placed: (2, 10, 3) scratch.
    """
    ra, rb = axes_rotation(axes, a), axes_rotation(axes, b)
    found, last = 0, -1
    for k in range(near_count):
        i, j = near[k, 0], near[k, 1]
        if i != last:
            features.place(corners[i], normals[i], ra, position[a, 0], position[a, 1], position[a, 2], placed[0])
            last = i
        features.place(corners[j], normals[j], rb, position[b, 0], position[b, 1], position[b, 2], placed[1])
        found = features.feature_contacts(placed[0], owned[i], i, placed[1], owned[j], j, margin, inside, normal,
                                          point, separation, feature, found)
    if found > separation.shape[0]:
        return found
    kept = 0
    for c in range(found):
        if separation[c] < -SHALLOW_DEPTH and _has_shorter_way_out(
                position, axes, a, b, near, near_count, corners, placed, point[c], feature[c],
                MIN_CLEARANCE * -separation[c]):
            continue
        normal[kept], point[kept] = normal[c], point[c]
        separation[kept], feature[kept] = separation[c], feature[c]
        kept += 1
    return kept


@kernel
def _has_shorter_way_out(position, axes, a, b, near, near_count, corners, placed, point, feature, depth):
    """Whether the surface of the other body is closer than `depth` m to the corner or one of the edges of a contact;
    point: (2, 3), feature: its identifier."""
    for side in range(2):
        if feature % 4 != features.EDGES and side != feature % 4:
            continue
        body = b if side == 0 else a
        r = axes_rotation(axes, body)
        last = -1
        for k in range(near_count):
            i = near[k, 1 - side]
            if i == last:
                continue
            last = i
            features.place_corners(corners[i], r, position[body, 0], position[body, 1], position[body, 2], placed[0])
            if features.squared_distance(point[side, 0], point[side, 1], point[side, 2], placed[0]) < depth * depth:
                return True
    return False


@kernel
def leaf_contacts(position, axes, a, b, near, near_count, box, margin, spot, turn, size, scratch, at, box_points,
                  box_normal, box_point, box_separation, box_feature, normal, point, separation, feature):
    """Writes the contacts of the boxes of the first near_count pairs of leaves near (m, 2) of bodies a and b, at most
    `margin` m apart.

    box: (k, 6) as in Octree. spot (2, 3), turn (2, 3, 3), size (2, 3) and `scratch` (of box.contact) are scratch; so is
    manifold `at` of the rows box_points .. box_feature.
    """
    found = 0
    turn[0], turn[1] = axes[a], axes[b]
    boxes = obb.Boxes(spot, turn, size)
    for k in range(near_count):
        for side in range(2):
            body, leaf = (a, near[k, 0]) if side == 0 else (b, near[k, 1])
            r = axes_rotation(axes, body)
            spot[side, 0], spot[side, 1], spot[side, 2] = transform_point(
                r, position[body, 0], position[body, 1], position[body, 2], box[leaf, 0], box[leaf, 1], box[leaf, 2])
            size[side, 0], size[side, 1], size[side, 2] = box[leaf, 3], box[leaf, 4], box[leaf, 5]
        points = obb.contact(boxes, 0, boxes, 1, margin, at, box_points, box_normal, box_point, box_separation,
                             box_feature, scratch)
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
                feature[found] = (near[k, 0] << 36) ^ (near[k, 1] << 12) ^ box_feature[at, i]
            found += 1
    return found


@kernel
def floor_contacts(position, axes, i, height, first, count, corners, owned, margin, normal, point, separation, feature):
    """Writes the contacts of the corners of body i with the half-space below a height, m, at most `margin` m above it.
    Triangles `first` to first + count of corners (t, 3, 3) are those of the body; normals point up."""
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
