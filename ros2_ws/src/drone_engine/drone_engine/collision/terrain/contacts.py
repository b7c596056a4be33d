"""Contacts with uneven ground, each with a normal of its own: of corners with faces, and of ridges with boxes.

normal: (k, 3) unit, from the ground to the body; point: (k, 2, 3) m, on the ground and on the body; separation: (k,) m;
feature: (k,). All append after the first `found` contacts and return how many there are, more than k if there is no
room for them.
"""

import math

from drone_engine.collision.mesh.topology import CORNER
from drone_engine.collision.terrain.height_field import below, cell_of, within
from drone_engine.kernel import kernel

ALIKE = 1.0 - 1e-9  # cosine of the angle between normals of one plane
NEAR = 1e-3  # m that the foot of a corner may lie outside of a face
CONE = 1e-3  # sine of the angle by which a normal may lie outside of a ridge's or an edge's


@kernel
def put(nx, ny, nz, x, y, z, gap, name, normal, point, separation, feature, found):
    """Appends a contact; x, y, z: the point on the body."""
    if found < separation.shape[0]:
        normal[found, 0], normal[found, 1], normal[found, 2] = nx, ny, nz
        point[found, 0, 0], point[found, 0, 1], point[found, 0, 2] = x - gap * nx, y - gap * ny, z - gap * nz
        point[found, 1, 0], point[found, 1, 1], point[found, 1, 2] = x, y, z
        separation[found], feature[found] = gap, name
    return found + 1


@kernel
def meet_corner(frame, start, entry, face, x, y, z, radius, name, margin, normal, point, separation, feature, found):
    """Contacts of a corner, or of a ball, with the face below it, and with others that it stands in front of."""
    own, height = below(frame, start, entry, face, x, y)
    if own < 0:
        if z - radius - height <= margin:
            found = put(0.0, 0.0, 1.0, x, y, z - radius, z - radius - height, name, normal, point, separation, feature,
                        found)
        return found
    ox, oy, oz = face[own, 0], face[own, 1], face[own, 2]
    depth = (ox * x + oy * y + oz * z) - face[own, 3] - radius
    if depth <= margin:
        found = put(ox, oy, oz, x - radius * ox, y - radius * oy, z - radius * oz, depth, name, normal, point,
                    separation, feature, found)
    column, row = cell_of(frame, x, y)
    cell = row * int(frame[3]) + column
    for k in range(start[cell], start[cell + 1]):
        f = entry[k]
        nx, ny, nz = face[f, 0], face[f, 1], face[f, 2]
        gap = (nx * x + ny * y + nz * z) - face[f, 3] - radius
        # A corner is nearer to its own plane than to one that it stands in front of: a nearer one lies behind a ridge,
        # and ends before it gets here. A ball's centre does not get behind any.
        away = gap + radius
        hidden = gap < depth if radius == 0.0 else away <= 0.0
        if f == own or gap > margin or hidden or nx * ox + ny * oy + nz * oz > ALIKE:
            continue
        if within(face, f, x - away * nx, y - away * ny) >= -NEAR:
            found = put(nx, ny, nz, x - radius * nx, y - radius * ny, z - radius * nz, gap, name + 8 * (f + 1), normal,
                        point, separation, feature, found)
    return found


@kernel
def meet_box(frame, start, entry, face, ridge_start, ridge_entry, ridge, ridge_cell, position, axes, half, i, low, high,
             margin, normal, point, separation, feature, found):
    """Contacts of box i; low, high: (n, 3) its bounds."""
    for corner in range(8):
        su = half[i, 0] if corner & 1 else -half[i, 0]
        sv = half[i, 1] if corner & 2 else -half[i, 1]
        sw = half[i, 2] if corner & 4 else -half[i, 2]
        x = position[i, 0] + su * axes[i, 0, 0] + sv * axes[i, 1, 0] + sw * axes[i, 2, 0]
        y = position[i, 1] + su * axes[i, 0, 1] + sv * axes[i, 1, 1] + sw * axes[i, 2, 1]
        z = position[i, 2] + su * axes[i, 0, 2] + sv * axes[i, 1, 2] + sw * axes[i, 2, 2]
        found = meet_corner(frame, start, entry, face, x, y, z, 0.0, corner, margin, normal, point, separation, feature,
                            found)
    column, row = cell_of(frame, low[i, 0], low[i, 1])
    last_column, last_row = cell_of(frame, high[i, 0], high[i, 1])
    column, row = max(column, 0), max(row, 0)
    for v in range(row, min(last_row + 1, int(frame[4]))):
        for u in range(column, min(last_column + 1, int(frame[3]))):
            cell = v * int(frame[3]) + u
            for k in range(ridge_start[cell], ridge_start[cell + 1]):
                r = ridge_entry[k]
                if u == max(column, ridge_cell[r, 0]) and v == max(row, ridge_cell[r, 1]):  # once, of all its cells
                    found = _meet_ridge(ridge, r, position, axes, half, i, margin, normal, point, separation, feature,
                                        found)
    return found


@kernel
def _meet_ridge(ridge, r, position, axes, half, i, margin, normal, point, separation, feature, found):
    """Contacts of ridge r: the ends of its part that the face of the box covers that looks at it most; where that face
    is not in its way out, those with the box's edges."""
    ax, ay, az = ridge[r, 0] - position[i, 0], ridge[r, 1] - position[i, 1], ridge[r, 2] - position[i, 2]
    bx, by, bz = ridge[r, 3] - position[i, 0], ridge[r, 4] - position[i, 1], ridge[r, 5] - position[i, 2]
    reach = math.sqrt(half[i, 0] ** 2 + half[i, 1] ** 2 + half[i, 2] ** 2) + margin
    if (min(ax, bx) > reach or max(ax, bx) < -reach or min(ay, by) > reach or max(ay, by) < -reach
            or min(az, bz) > reach or max(az, bz) < -reach):
        return found
    looks, most = 0, -1.0
    for k in range(3):
        cosine = axes[i, k, 0] * ridge[r, 12] + axes[i, k, 1] * ridge[r, 13] + axes[i, k, 2] * ridge[r, 14]
        if abs(cosine) > most:
            looks, most, sign = k, abs(cosine), 1.0 if cosine > 0.0 else -1.0
    nx, ny, nz = sign * axes[i, looks, 0], sign * axes[i, looks, 1], sign * axes[i, looks, 2]
    if not _leads_out(ridge, r, nx, ny, nz):
        return _meet_edges(ridge, r, position, axes, half, i, margin, normal, point, separation, feature, found)
    first, last = 0.0, 1.0  # of the ridge
    for k in range(3):
        if k != looks:
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
        gap = -(nx * x + ny * y + nz * z) - half[i, looks]  # the box's face is on the side that the normal leaves
        if -2.0 * half[i, looks] <= gap <= margin:  # as deep as the box is thick
            found = put(nx, ny, nz, position[i, 0] + x + gap * nx, position[i, 1] + y + gap * ny,
                        position[i, 2] + z + gap * nz, gap, (1 << 40) + 2 * r + end, normal, point, separation, feature,
                        found)
    return found


@kernel
def _leads_out(ridge, r, nx, ny, nz):
    """Whether nothing of the two faces at a ridge is farther along a direction than the ridge."""
    return (nx * ridge[r, 6] + ny * ridge[r, 7] + nz * ridge[r, 8] <= CONE
            and nx * ridge[r, 9] + ny * ridge[r, 10] + nz * ridge[r, 11] <= CONE)


@kernel
def _meet_edges(ridge, r, position, axes, half, i, margin, normal, point, separation, feature, found):
    """Contacts of ridge r with the edges of box i that cross it."""
    px, py, pz = ridge[r, 0] - position[i, 0], ridge[r, 1] - position[i, 1], ridge[r, 2] - position[i, 2]
    dx, dy, dz = ridge[r, 3] - ridge[r, 0], ridge[r, 4] - ridge[r, 1], ridge[r, 5] - ridge[r, 2]
    for k in range(3):
        ex, ey, ez = axes[i, k, 0], axes[i, k, 1], axes[i, k, 2]
        nx, ny, nz = dy * ez - dz * ey, dz * ex - dx * ez, dx * ey - dy * ex
        square = nx * nx + ny * ny + nz * nz
        if square <= CONE * CONE * (dx * dx + dy * dy + dz * dz):
            continue  # along each other
        up = nx * ridge[r, 12] + ny * ridge[r, 13] + nz * ridge[r, 14]
        length = math.sqrt(square) if up > 0.0 else -math.sqrt(square)
        nx, ny, nz = nx / length, ny / length, nz / length
        if not _leads_out(ridge, r, nx, ny, nz):
            continue
        u, v = (k + 1) % 3, (k + 2) % 3
        # The edge that is farthest against the normal: the only one whose faces both look at the ridge.
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
        along = (de * ew - dw) / (dd - de * de)  # of the ridge
        s = ew + along * de  # m along the box's edge
        if 0.0 <= along <= 1.0 and abs(s) <= half[i, k]:
            found = put(nx, ny, nz, position[i, 0] + cx + s * ex, position[i, 1] + cy + s * ey,
                        position[i, 2] + cz + s * ez, gap, (1 << 41) + 4 * r + k, normal, point, separation, feature,
                        found)
    return found


@kernel
def meet_mesh(frame, start, entry, face, position, axes, i, corners, owned, first, count, margin, normal, point,
              separation, feature, found):
    """Contacts of the corners of body i's mesh, triangles `first` on of corners (t, 3, 3)."""
    for t in range(first, first + count):
        for c in range(3):
            if owned[t] & (CORNER << c):
                u, v, w = corners[t, c, 0], corners[t, c, 1], corners[t, c, 2]
                x = position[i, 0] + u * axes[i, 0, 0] + v * axes[i, 1, 0] + w * axes[i, 2, 0]
                y = position[i, 1] + u * axes[i, 0, 1] + v * axes[i, 1, 1] + w * axes[i, 2, 1]
                z = position[i, 2] + u * axes[i, 0, 2] + v * axes[i, 1, 2] + w * axes[i, 2, 2]
                found = meet_corner(frame, start, entry, face, x, y, z, 0.0, (3 * t + c) << 20, margin, normal, point,
                                    separation, feature, found)
    return found
