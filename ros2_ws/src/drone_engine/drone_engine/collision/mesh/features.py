"""Contacts of two meshes for a solver: corners that meet faces, and edges that meet edges, near or a little inside.

Two surfaces come into contact at such pairs and at no others. A contact holds the plane between its two features: its
normal is the face's, or that of both edges, where that looks out of both meshes. The front of a triangle, from which
its corners turn counter-clockwise, is outside.
"""

import math

from drone_engine.collision.mesh.topology import CORNER, EDGE
from drone_engine.kernel import kernel

PARALLEL = 1e-6  # squared sine below which two edges have no normal of their own
TOLERANCE = 1e-3  # of a sine: how far the normal of two edges may leave the wedge of their faces; one may lie in it
CORNER_OF_A, CORNER_OF_B, EDGES = range(3)  # what a contact is made of


@kernel
def place(corners, normals, r, px, py, pz, world):
    """Writes a triangle in the world, (10, 3): its corners, then its seven normals; r: nine numbers, row by row."""
    place_corners(corners, r, px, py, pz, world)
    for i in range(7):
        x, y, z = normals[i, 0], normals[i, 1], normals[i, 2]
        world[3 + i, 0] = r[0] * x + r[1] * y + r[2] * z
        world[3 + i, 1] = r[3] * x + r[4] * y + r[5] * z
        world[3 + i, 2] = r[6] * x + r[7] * y + r[8] * z


@kernel
def place_corners(corners, r, px, py, pz, world):
    """Writes the corners of a triangle in the world, rounded as everywhere."""
    for i in range(3):
        x, y, z = corners[i, 0], corners[i, 1], corners[i, 2]
        world[i, 0] = (r[0] * x + r[1] * y + r[2] * z) + px
        world[i, 1] = (r[3] * x + r[4] * y + r[5] * z) + py
        world[i, 2] = (r[6] * x + r[7] * y + r[8] * z) + pz


@kernel
def meet(a, owned_a, id_a, b, owned_b, id_b, margin, inside, normal, point, separation, feature, found):
    """Appends the contacts of two placed triangles after the first `found`; returns how many there are then.

    Contacts lie at most `margin` apart and `inside` deep. normal: (k, 3) from a to b; point: (k, 2, 3) on a and on b;
    separation: (k,); feature: (k,) names the corner or the edges. What does not fit is counted and not written.
    """
    for i in range(3):
        if owned_a & (CORNER << i):
            found = _corner(a, i, b, -1.0, CORNER_OF_A + 4 * (3 * id_a + i), margin, inside, normal, point, separation,
                            feature, found)
        if owned_b & (CORNER << i):
            found = _corner(b, i, a, 1.0, CORNER_OF_B + 4 * (3 * id_b + i), margin, inside, normal, point, separation,
                            feature, found)
    for i in range(3):
        if owned_a & (EDGE << i):
            for j in range(3):
                if owned_b & (EDGE << j):
                    name = EDGES + 4 * ((3 * id_a + i) << 29 | (3 * id_b + j))
                    found = _edges(a, i, b, j, name, margin, inside, normal, point, separation, feature, found)
    return found


@kernel
def _dot(u, i, v, j):
    return u[i, 0] * v[j, 0] + u[i, 1] * v[j, 1] + u[i, 2] * v[j, 2]


@kernel
def _corner(p, i, face, sign, name, margin, inside, normal, point, separation, feature, found):
    """Appends the contact of corner i of p with a face, if it looks against it and lies above or under it."""
    if _dot(p, 7 + i, face, 3) >= 0.0:
        return found
    nx, ny, nz = face[3, 0], face[3, 1], face[3, 2]
    x, y, z = p[i, 0], p[i, 1], p[i, 2]
    s = (x - face[0, 0]) * nx + (y - face[0, 1]) * ny + (z - face[0, 2]) * nz
    if not -inside <= s <= margin:
        return found
    for k in range(3):
        m = k + 1 if k < 2 else 0
        ex, ey, ez = face[m, 0] - face[k, 0], face[m, 1] - face[k, 1], face[m, 2] - face[k, 2]
        dx, dy, dz = x - face[k, 0], y - face[k, 1], z - face[k, 2]
        if (ny * ez - nz * ey) * dx + (nz * ex - nx * ez) * dy + (nx * ey - ny * ex) * dz < 0.0:
            return found  # beyond that edge; on it is inside
    if found < feature.shape[0]:
        own, other = (0, 1) if sign < 0.0 else (1, 0)
        for k in range(3):
            normal[found, k] = sign * face[3, k]
            point[found, own, k] = p[i, k]
            point[found, other, k] = p[i, k] - s * face[3, k]
        separation[found], feature[found] = s, name
    return found + 1


@kernel
def _inside_wedge(t, i, dx, dy, dz, x, y, z):
    """Whether the unit vector (x, y, z), square to edge i along (dx, dy, dz), looks out between its faces."""
    for side in range(2):
        row, turn = (3, 1.0) if side == 0 else (4 + i, -1.0)
        nx, ny, nz = t[row, 0], t[row, 1], t[row, 2]
        if turn * ((ny * dz - nz * dy) * x + (nz * dx - nx * dz) * y + (nx * dy - ny * dx) * z) > TOLERANCE:
            return False
    return True


@kernel
def _edges(a, i, b, j, name, margin, inside, normal, point, separation, feature, found):
    """Appends the contact of edge i of a with edge j of b, if their closest points lie within both."""
    i1, j1 = i + 1 if i < 2 else 0, j + 1 if j < 2 else 0
    ux, uy, uz = a[i1, 0] - a[i, 0], a[i1, 1] - a[i, 1], a[i1, 2] - a[i, 2]
    vx, vy, vz = b[j1, 0] - b[j, 0], b[j1, 1] - b[j, 1], b[j1, 2] - b[j, 2]
    uu, vv, uv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, ux * vx + uy * vy + uz * vz
    square = uu * vv - uv * uv  # of the length of u x v
    if square <= PARALLEL * uu * vv:
        return found
    wx, wy, wz = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
    wu, wv = wx * ux + wy * uy + wz * uz, wx * vx + wy * vy + wz * vz
    s, t = (uv * wv - vv * wu) / square, (uu * wv - uv * wu) / square
    if not (0.0 <= s <= 1.0 and 0.0 <= t <= 1.0):
        return found
    scale = 1.0 / math.sqrt(square)
    x, y, z = scale * (uy * vz - uz * vy), scale * (uz * vx - ux * vz), scale * (ux * vy - uy * vx)
    if x * (a[3, 0] + a[4 + i, 0]) + y * (a[3, 1] + a[4 + i, 1]) + z * (a[3, 2] + a[4 + i, 2]) < 0.0:
        x, y, z = -x, -y, -z
    gap = -(wx * x + wy * y + wz * z)
    if not -inside <= gap <= margin:
        return found
    ru, rv = 1.0 / math.sqrt(uu), 1.0 / math.sqrt(vv)
    if not (_inside_wedge(a, i, ux * ru, uy * ru, uz * ru, x, y, z)
            and _inside_wedge(b, j, vx * rv, vy * rv, vz * rv, -x, -y, -z)):
        return found
    if found < feature.shape[0]:
        normal[found, 0], normal[found, 1], normal[found, 2] = x, y, z
        for k in range(3):
            point[found, 0, k] = a[i, k] + s * (a[i1, k] - a[i, k])
            point[found, 1, k] = b[j, k] + t * (b[j1, k] - b[j, k])
        separation[found], feature[found] = gap, name
    return found + 1


@kernel
def square_distance(x, y, z, t):
    """Squared distance of a point from a triangle t, a corner a row (Ericson 2005, Real-Time Collision Detection,
    5.1.5); inf for a triangle without area."""
    ux, uy, uz = t[1, 0] - t[0, 0], t[1, 1] - t[0, 1], t[1, 2] - t[0, 2]
    vx, vy, vz = t[2, 0] - t[0, 0], t[2, 1] - t[0, 1], t[2, 2] - t[0, 2]
    px, py, pz = x - t[0, 0], y - t[0, 1], z - t[0, 2]
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    pu, pv = px * ux + py * uy + pz * uz, px * vx + py * vy + pz * vz
    area = uu * vv - uv * uv
    if area <= 0.0:
        return math.inf
    s, w = vv * pu - uv * pv, uu * pv - uv * pu
    if s >= 0.0 and w >= 0.0 and s + w <= area:  # over the inside
        s, w = s / area, w / area
        return (px - s * ux - w * vx) ** 2 + (py - s * uy - w * vy) ** 2 + (pz - s * uz - w * vz) ** 2
    first = _from_segment(px, py, pz, ux, uy, uz, pu, uu)
    second = _from_segment(px, py, pz, vx, vy, vz, pv, vv)
    ex, ey, ez = vx - ux, vy - uy, vz - uz
    qx, qy, qz = px - ux, py - uy, pz - uz
    third = _from_segment(qx, qy, qz, ex, ey, ez, qx * ex + qy * ey + qz * ez, ex * ex + ey * ey + ez * ez)
    return min(first, second, third)


@kernel
def _from_segment(px, py, pz, ux, uy, uz, pu, uu):
    """Squared distance of p from the segment of u, from the origin; pu, uu: their products."""
    s = min(max(pu / uu, 0.0), 1.0)
    return (px - s * ux) ** 2 + (py - s * uy) ** 2 + (pz - s * uz) ** 2
