"""Contacts of bodies with a height field: of corners or spheres with faces, and of ridges with boxes.

Kernels append to a ContactBuffer `out` after the first `found` contacts and return the new number; body a is the
ground, body b the other. field: HeightField. position (n, 3), axes (n, 3, 3), half (n, 3): centers, axes and half
extents of boxes, world. margin: m, the largest separation of a contact.
"""

import math

from drone_engine.collision.mesh.contact_buffer import append_contact
from drone_engine.collision.mesh.topology import CORNER
from drone_engine.collision.terrain.height_field import COLUMNS, ROWS, cell_of, distance_inside, face_below
from drone_engine.kernel import kernel

SAME_PLANE_COSINE = 1.0 - 1e-9  # of the angle between the normals of two faces of one plane
FACE_MARGIN = 1e-3  # m by which the projection of a corner may lie outside of a face
WEDGE_TOLERANCE = 1e-3  # sine of the angle by which a normal may lie outside of the wedge of an edge's faces


@kernel
def point_contacts(field, x, y, z, radius, feature, margin, out, found):
    """Appends the contacts of a sphere, or of a corner (radius 0), with the face below it and with other faces that it
    is in front of. x, y, z: center, m; feature: identifier."""
    grid, start, entry, face = field.grid, field.start, field.entry, field.face
    own, height = face_below(field, x, y)
    if own < 0:
        if z - radius - height <= margin:
            found = append_contact(0.0, 0.0, 1.0, x, y, z - radius, z - radius - height, feature, out, found)
        return found
    ox, oy, oz = face[own, 0], face[own, 1], face[own, 2]
    depth = (ox * x + oy * y + oz * z) - face[own, 3] - radius
    if depth <= margin:
        found = append_contact(ox, oy, oz, x - radius * ox, y - radius * oy, z - radius * oz, depth, feature, out,
                               found)
    column, row = cell_of(grid, x, y)
    cell = row * int(grid[COLUMNS]) + column
    for k in range(start[cell], start[cell + 1]):
        f = entry[k]
        nx, ny, nz = face[f, 0], face[f, 1], face[f, 2]
        gap = (nx * x + ny * y + nz * z) - face[f, 3] - radius
        # A corner is closer to the plane of the face below it than to that of a face in front of it. A closer plane
        # belongs to a face behind a ridge, which ends before it gets here. The center of a sphere is in front of all.
        away = gap + radius
        hidden = gap < depth if radius == 0.0 else away <= 0.0
        if f == own or gap > margin or hidden or nx * ox + ny * oy + nz * oz > SAME_PLANE_COSINE:
            continue
        if distance_inside(face, f, x - away * nx, y - away * ny) >= -FACE_MARGIN:
            found = append_contact(nx, ny, nz, x - radius * nx, y - radius * ny, z - radius * nz, gap,
                                   feature + 8 * (f + 1), out, found)
    return found


@kernel
def box_contacts(field, position, axes, half, i, low, high, margin, out, found):
    """Appends the contacts of box i; low, high: (n, 3) bounds of the boxes."""
    grid, ridge_start, ridge_entry, ridge_cell = field.grid, field.ridge_start, field.ridge_entry, field.ridge_cell
    for corner in range(8):
        su = half[i, 0] if corner & 1 else -half[i, 0]
        sv = half[i, 1] if corner & 2 else -half[i, 1]
        sw = half[i, 2] if corner & 4 else -half[i, 2]
        x = position[i, 0] + su * axes[i, 0, 0] + sv * axes[i, 1, 0] + sw * axes[i, 2, 0]
        y = position[i, 1] + su * axes[i, 0, 1] + sv * axes[i, 1, 1] + sw * axes[i, 2, 1]
        z = position[i, 2] + su * axes[i, 0, 2] + sv * axes[i, 1, 2] + sw * axes[i, 2, 2]
        found = point_contacts(field, x, y, z, 0.0, corner, margin, out, found)
    column, row = cell_of(grid, low[i, 0], low[i, 1])
    last_column, last_row = cell_of(grid, high[i, 0], high[i, 1])
    column, row = max(column, 0), max(row, 0)
    for v in range(row, min(last_row + 1, int(grid[ROWS]))):
        for u in range(column, min(last_column + 1, int(grid[COLUMNS]))):
            cell = v * int(grid[COLUMNS]) + u
            for k in range(ridge_start[cell], ridge_start[cell + 1]):
                r = ridge_entry[k]
                if u == max(column, ridge_cell[r, 0]) and v == max(row, ridge_cell[r, 1]):  # in the first common cell
                    found = _ridge_contacts(field.ridge, r, position, axes, half, i, margin, out, found)
    return found


@kernel
def _ridge_contacts(ridge, r, position, axes, half, i, margin, out, found):
    """Appends the contacts of ridge r with box i: the ends of the part of the ridge that is below the box's face which
    faces the ridge most. If that face's normal leaves the wedge of the ridge, contacts with the box's edges instead."""
    ax, ay, az = ridge[r, 0] - position[i, 0], ridge[r, 1] - position[i, 1], ridge[r, 2] - position[i, 2]
    bx, by, bz = ridge[r, 3] - position[i, 0], ridge[r, 4] - position[i, 1], ridge[r, 5] - position[i, 2]
    reach = math.sqrt(half[i, 0] ** 2 + half[i, 1] ** 2 + half[i, 2] ** 2) + margin
    if (min(ax, bx) > reach or max(ax, bx) < -reach or min(ay, by) > reach or max(ay, by) < -reach
            or min(az, bz) > reach or max(az, bz) < -reach):
        return found
    axis, most = 0, -1.0
    for k in range(3):
        cosine = axes[i, k, 0] * ridge[r, 12] + axes[i, k, 1] * ridge[r, 13] + axes[i, k, 2] * ridge[r, 14]
        if abs(cosine) > most:
            axis, most, sign = k, abs(cosine), 1.0 if cosine > 0.0 else -1.0
    nx, ny, nz = sign * axes[i, axis, 0], sign * axes[i, axis, 1], sign * axes[i, axis, 2]
    if not _is_in_wedge(ridge, r, nx, ny, nz):
        return _ridge_edge_contacts(ridge, r, position, axes, half, i, margin, out, found)
    first, last = 0.0, 1.0  # fractions of the ridge
    for k in range(3):
        if k != axis:
            a = axes[i, k, 0] * ax + axes[i, k, 1] * ay + axes[i, k, 2] * az
            b = axes[i, k, 0] * bx + axes[i, k, 1] * by + axes[i, k, 2] * bz
            if a == b:
                if abs(a) > half[i, k]:
                    return found
                continue
            one, other = (-half[i, k] - a) / (b - a), (half[i, k] - a) / (b - a)
            first, last = max(first, min(one, other)), min(last, max(one, other))
    if first > last:
        return found
    for end in range(2):
        t = last if end else first
        x, y, z = ax + t * (bx - ax), ay + t * (by - ay), az + t * (bz - az)
        gap = -(nx * x + ny * y + nz * z) - half[i, axis]  # to the face on the opposite side of the normal
        if -2.0 * half[i, axis] <= gap <= margin:  # at most as deep as the box is thick
            found = append_contact(nx, ny, nz, position[i, 0] + x + gap * nx, position[i, 1] + y + gap * ny,
                                   position[i, 2] + z + gap * nz, gap, (1 << 40) + 2 * r + end, out, found)
    return found


@kernel
def _is_in_wedge(ridge, r, nx, ny, nz):
    """Whether a unit vector lies in the wedge between the normals of the two faces at ridge r: whether no point of the
    faces is farther along it than the ridge."""
    return (nx * ridge[r, 6] + ny * ridge[r, 7] + nz * ridge[r, 8] <= WEDGE_TOLERANCE
            and nx * ridge[r, 9] + ny * ridge[r, 10] + nz * ridge[r, 11] <= WEDGE_TOLERANCE)


@kernel
def _ridge_edge_contacts(ridge, r, position, axes, half, i, margin, out, found):
    """Appends the contacts of ridge r with the edges of box i that cross it, one for each axis of the box at most."""
    px, py, pz = ridge[r, 0] - position[i, 0], ridge[r, 1] - position[i, 1], ridge[r, 2] - position[i, 2]
    dx, dy, dz = ridge[r, 3] - ridge[r, 0], ridge[r, 4] - ridge[r, 1], ridge[r, 5] - ridge[r, 2]
    for k in range(3):
        ex, ey, ez = axes[i, k, 0], axes[i, k, 1], axes[i, k, 2]
        nx, ny, nz = dy * ez - dz * ey, dz * ex - dx * ez, dx * ey - dy * ex
        square = nx * nx + ny * ny + nz * nz
        if square <= WEDGE_TOLERANCE * WEDGE_TOLERANCE * (dx * dx + dy * dy + dz * dz):
            continue  # parallel
        up = nx * ridge[r, 12] + ny * ridge[r, 13] + nz * ridge[r, 14]
        length = math.sqrt(square) if up > 0.0 else -math.sqrt(square)
        nx, ny, nz = nx / length, ny / length, nz / length
        if not _is_in_wedge(ridge, r, nx, ny, nz):
            continue
        u, v = (k + 1) % 3, (k + 2) % 3
        # The edge that is farthest against the normal: the only one whose two faces both face the ridge.
        su = -half[i, u] if nx * axes[i, u, 0] + ny * axes[i, u, 1] + nz * axes[i, u, 2] > 0.0 else half[i, u]
        sv = -half[i, v] if nx * axes[i, v, 0] + ny * axes[i, v, 1] + nz * axes[i, v, 2] > 0.0 else half[i, v]
        cx = su * axes[i, u, 0] + sv * axes[i, v, 0]
        cy = su * axes[i, u, 1] + sv * axes[i, v, 1]
        cz = su * axes[i, u, 2] + sv * axes[i, v, 2]
        wx, wy, wz = px - cx, py - cy, pz - cz
        gap = -(wx * nx + wy * ny + wz * nz)
        if not -min(half[i, 0], min(half[i, 1], half[i, 2])) <= gap <= margin:
            continue
        dd, de, dw, ew = (dx * dx + dy * dy + dz * dz, dx * ex + dy * ey + dz * ez, dx * wx + dy * wy + dz * wz,
                          ex * wx + ey * wy + ez * wz)
        along = (de * ew - dw) / (dd - de * de)  # fraction of the ridge
        s = ew + along * de  # m along the box's edge
        if 0.0 <= along <= 1.0 and abs(s) <= half[i, k]:
            found = append_contact(nx, ny, nz, position[i, 0] + cx + s * ex, position[i, 1] + cy + s * ey,
                                   position[i, 2] + cz + s * ez, gap, (1 << 41) + 4 * r + k, out, found)
    return found


@kernel
def mesh_contacts(field, position, axes, i, meshes, margin, out, found):
    """Appends the contacts of the corners of body i's mesh; meshes: MeshCorners."""
    link, corners, owned, root = meshes.link, meshes.corners, meshes.owned, meshes.roots[i]
    first, count = link[root, 2], link[root, 3]
    for t in range(first, first + count):
        for c in range(3):
            if owned[t] & (CORNER << c):
                u, v, w = corners[t, c, 0], corners[t, c, 1], corners[t, c, 2]
                x = position[i, 0] + u * axes[i, 0, 0] + v * axes[i, 1, 0] + w * axes[i, 2, 0]
                y = position[i, 1] + u * axes[i, 0, 1] + v * axes[i, 1, 1] + w * axes[i, 2, 1]
                z = position[i, 2] + u * axes[i, 0, 2] + v * axes[i, 1, 2] + w * axes[i, 2, 2]
                found = point_contacts(field, x, y, z, 0.0, (3 * t + c) << 20, margin, out, found)
    return found
