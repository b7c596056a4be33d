"""All contacts of two posed meshes: of their triangles that are near, of their leaves' boxes, or with a floor."""

from drone_engine.collision.box import box as obb
from drone_engine.collision.mesh import features
from drone_engine.collision.mesh.topology import CORNER
from drone_engine.kernel import kernel

INSIDE = 0.01  # m; contacts are looked for this far below a surface at least, or as far as the margin above it
DEEP = 0.1  # m; and this far if nothing is found although the surfaces cut each other
SHALLOW = 1e-3  # m; depths below it need no second look
FEW = 64  # pairs of leaves; a body stands on all points of so few, of more on the deepest of each
LEAST = 0.5  # of its depth: how far a contact's feature is from the other surface at least (0.7 at a cube's edge), else
# another way out is shorter


@kernel
def turned_rows(axes, i):
    """The rotation matrix of body i, nine numbers row by row, from its axes."""
    return (axes[i, 0, 0], axes[i, 1, 0], axes[i, 2, 0], axes[i, 0, 1], axes[i, 1, 1], axes[i, 2, 1],
            axes[i, 0, 2], axes[i, 1, 2], axes[i, 2, 2])


@kernel
def triangle_contacts(position, axes, a, b, near, near_count, corners, normals, owned, margin, inside, placed,
                      normal, point, separation, feature):
    """Writes all contacts of the pairs of triangles near (k, 2), up to `margin` m apart and `inside` m deep; returns
    how many there are."""
    ra, rb = turned_rows(axes, a), turned_rows(axes, b)
    found, last = 0, -1
    for k in range(near_count):
        i, j = near[k, 0], near[k, 1]
        if i != last:
            features.place(corners[i], normals[i], ra, position[a, 0], position[a, 1], position[a, 2], placed[0])
            last = i
        features.place(corners[j], normals[j], rb, position[b, 0], position[b, 1], position[b, 2], placed[1])
        found = features.meet(placed[0], owned[i], i, placed[1], owned[j], j, margin, inside, normal, point,
                              separation, feature, found)
    if found > separation.shape[0]:
        return found
    kept = 0
    for c in range(found):
        if separation[c] < -SHALLOW and _has_shorter_way(position, axes, a, b, near, near_count, corners, placed,
                                                         point[c], feature[c], LEAST * -separation[c]):
            continue
        normal[kept], point[kept] = normal[c], point[c]
        separation[kept], feature[kept] = separation[c], feature[c]
        kept += 1
    return kept


@kernel
def _has_shorter_way(position, axes, a, b, near, near_count, corners, placed, point, feature, depth):
    """Whether the other's surface is nearer than `depth` to the corner or one of the edges that a contact is of."""
    for side in range(2):
        if feature % 4 != features.EDGES and side != feature % 4:
            continue
        body = b if side == 0 else a
        r = turned_rows(axes, body)
        last = -1
        for k in range(near_count):
            i = near[k, 1 - side]
            if i == last:
                continue
            last = i
            features.place_corners(corners[i], r, position[body, 0], position[body, 1], position[body, 2], placed[0])
            if features.square_distance(point[side, 0], point[side, 1], point[side, 2], placed[0]) < depth * depth:
                return True
    return False


@kernel
def leaf_contacts(position, axes, a, b, near, near_count, box, margin, spot, turn, size, scratch, at, box_points,
                  box_normal, box_point, box_separation, box_feature, normal, point, separation, feature):
    """Writes the contacts of the pairs of leaves near (k, 2), as of boxes; returns how many there are. What starts with
    box_ is room for manifolds, number `at` of which is free."""
    found = 0
    turn[0], turn[1] = axes[a], axes[b]
    boxes = obb.Boxes(spot, turn, size)
    for k in range(near_count):
        for side in range(2):
            body, leaf = (a, near[k, 0]) if side == 0 else (b, near[k, 1])
            r = turned_rows(axes, body)
            x, y, z = box[leaf, 0], box[leaf, 1], box[leaf, 2]
            spot[side, 0] = (r[0] * x + r[1] * y + r[2] * z) + position[body, 0]
            spot[side, 1] = (r[3] * x + r[4] * y + r[5] * z) + position[body, 1]
            spot[side, 2] = (r[6] * x + r[7] * y + r[8] * z) + position[body, 2]
            size[side, 0], size[side, 1], size[side, 2] = box[leaf, 3], box[leaf, 4], box[leaf, 5]
        points = obb.contact(boxes, 0, boxes, 1, margin, at, box_points, box_normal, box_point, box_separation,
                             box_feature, scratch)
        deepest = 0
        for i in range(1, points):
            if box_separation[at, i] < box_separation[at, deepest]:
                deepest = i
        for i in range(points):
            if near_count > FEW and i != deepest:
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
    """Writes the contacts of body i's corners with everything below a height, m; returns how many there are."""
    r = turned_rows(axes, i)
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
