"""Contacts of two meshes for the solver, between features: corner against face and edge against edge.

Two surfaces come into contact at such pairs of features only. The contact plane lies between the two: its normal is
that of the face, or the cross product of the edges if that points out of both meshes. The outside of a triangle is the
side from which its corners run counter-clockwise.

A placed triangle is an array (10, 3) in the world: its corners, m, then its seven normals as in Topology. Kernels
append contacts to a ContactBuffer `out` after the first `found` and return the new number.
"""

import math

from drone_engine.collision.mesh.topology import CORNER, EDGE
from drone_engine.collision.mesh.transforms import transform_point
from drone_engine.kernel import kernel

MIN_EDGES_SIN2 = 1e-6  # squared sine between two edges below which their cross product is no contact normal
WEDGE_TOLERANCE = 1e-3  # sine by which the normal of two edges may leave the wedge of an edge's faces
CORNER_OF_A, CORNER_OF_B, EDGES = range(3)  # kind of a contact, in the last two bits of its identifier


@kernel
def place(corners, normals, r, px, py, pz, world):
    """Writes a triangle, corners (3, 3) and normals (7, 3), in the world to world (10, 3); r: rotation, nine numbers
    row by row; p: position, m."""
    place_corners(corners, r, px, py, pz, world)
    for i in range(7):
        x, y, z = normals[i, 0], normals[i, 1], normals[i, 2]
        world[3 + i, 0] = r[0] * x + r[1] * y + r[2] * z
        world[3 + i, 1] = r[3] * x + r[4] * y + r[5] * z
        world[3 + i, 2] = r[6] * x + r[7] * y + r[8] * z


@kernel
def place_corners(corners, r, px, py, pz, world):
    """Writes corners (3, 3) of a body in the world to world (.., 3), with the body's rotation r and position p."""
    for i in range(3):
        world[i, 0], world[i, 1], world[i, 2] = transform_point(
            r, px, py, pz, corners[i, 0], corners[i, 1], corners[i, 2])


@kernel
def feature_contacts(a, owned_a, id_a, b, owned_b, id_b, margin, inside, out, found):
    """Appends the contacts of two placed triangles that are at most `margin` m apart and at most `inside` m deep.

    owned_a, owned_b: bits of the features that the triangles own, as in Topology; id_a, id_b: indices of the triangles.
    """
    for i in range(3):
        if owned_a & (CORNER << i):
            found = _corner_face_contact(a, i, b, -1.0, CORNER_OF_A + 4 * (3 * id_a + i), margin, inside, out, found)
        if owned_b & (CORNER << i):
            found = _corner_face_contact(b, i, a, 1.0, CORNER_OF_B + 4 * (3 * id_b + i), margin, inside, out, found)
    for i in range(3):
        if owned_a & (EDGE << i):
            for j in range(3):
                if owned_b & (EDGE << j):
                    identifier = EDGES + 4 * ((3 * id_a + i) << 29 | (3 * id_b + j))
                    found = _edge_edge_contact(a, i, b, j, identifier, margin, inside, out, found)
    return found


@kernel
def _dot(u, i, v, j):
    """The dot product of row i of u and row j of v."""
    return u[i, 0] * v[j, 0] + u[i, 1] * v[j, 1] + u[i, 2] * v[j, 2]


@kernel
def _corner_face_contact(p, i, face, sign, identifier, margin, inside, out, found):
    """Appends the contact of corner i of triangle p with the face of triangle `face`, if their normals oppose each
    other and the corner projects into the face. sign: -1 for a corner of a, 1 for a corner of b."""
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
            return found  # outside of that edge; a corner on it counts as inside
    if found < out.feature.shape[0]:
        normal, point = out.normal, out.point
        own, other = (0, 1) if sign < 0.0 else (1, 0)
        for k in range(3):
            normal[found, k] = sign * face[3, k]
            point[found, own, k] = p[i, k]
            point[found, other, k] = p[i, k] - s * face[3, k]
        out.separation[found], out.feature[found] = s, identifier
    return found + 1


@kernel
def _inside_wedge(t, i, dx, dy, dz, x, y, z):
    """Whether the unit vector (x, y, z), perpendicular to edge i of placed triangle t, lies between the normals of the
    two faces at that edge. (dx, dy, dz): unit vector along the edge."""
    for side in range(2):
        row, sign = (3, 1.0) if side == 0 else (4 + i, -1.0)
        nx, ny, nz = t[row, 0], t[row, 1], t[row, 2]
        if sign * ((ny * dz - nz * dy) * x + (nz * dx - nx * dz) * y + (nx * dy - ny * dx) * z) > WEDGE_TOLERANCE:
            return False
    return True


@kernel
def _edge_edge_contact(a, i, b, j, identifier, margin, inside, out, found):
    """Appends the contact of edge i of a with edge j of b, if the closest points of their lines lie on both edges.

    The formula is that of Ericson 2005, Real-Time Collision Detection, 5.1.8; cf. `triangle.closest`, where points are
    clamped to the edges and roundings differ.
    """
    i1, j1 = i + 1 if i < 2 else 0, j + 1 if j < 2 else 0
    ux, uy, uz = a[i1, 0] - a[i, 0], a[i1, 1] - a[i, 1], a[i1, 2] - a[i, 2]
    vx, vy, vz = b[j1, 0] - b[j, 0], b[j1, 1] - b[j, 1], b[j1, 2] - b[j, 2]
    uu, vv, uv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, ux * vx + uy * vy + uz * vz
    square = uu * vv - uv * uv  # squared length of u x v
    if square <= MIN_EDGES_SIN2 * uu * vv:
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
    if found < out.feature.shape[0]:
        normal, point = out.normal, out.point
        normal[found, 0], normal[found, 1], normal[found, 2] = x, y, z
        for k in range(3):
            point[found, 0, k] = a[i, k] + s * (a[i1, k] - a[i, k])
            point[found, 1, k] = b[j, k] + t * (b[j1, k] - b[j, k])
        out.separation[found], out.feature[found] = gap, identifier
    return found + 1


@kernel
def squared_distance(x, y, z, t):
    """The squared distance of a point from triangle t, a corner per row, m^2; inf for a triangle without area (Ericson
    2005, Real-Time Collision Detection, 5.1.5)."""
    ux, uy, uz = t[1, 0] - t[0, 0], t[1, 1] - t[0, 1], t[1, 2] - t[0, 2]
    vx, vy, vz = t[2, 0] - t[0, 0], t[2, 1] - t[0, 1], t[2, 2] - t[0, 2]
    px, py, pz = x - t[0, 0], y - t[0, 1], z - t[0, 2]
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    pu, pv = px * ux + py * uy + pz * uz, px * vx + py * vy + pz * vz
    area = uu * vv - uv * uv
    if area <= 0.0:
        return math.inf
    s, w = vv * pu - uv * pv, uu * pv - uv * pu
    if s >= 0.0 and w >= 0.0 and s + w <= area:  # the point projects into the triangle
        s, w = s / area, w / area
        return (px - s * ux - w * vx) ** 2 + (py - s * uy - w * vy) ** 2 + (pz - s * uz - w * vz) ** 2
    first = _squared_segment_distance(px, py, pz, ux, uy, uz, pu, uu)
    second = _squared_segment_distance(px, py, pz, vx, vy, vz, pv, vv)
    ex, ey, ez = vx - ux, vy - uy, vz - uz
    qx, qy, qz = px - ux, py - uy, pz - uz
    third = _squared_segment_distance(qx, qy, qz, ex, ey, ez, qx * ex + qy * ey + qz * ez, ex * ex + ey * ey + ez * ez)
    return min(first, second, third)


@kernel
def _squared_segment_distance(px, py, pz, ux, uy, uz, pu, uu):
    """The squared distance of point p from the segment from the origin to u; pu, uu: their dot products."""
    s = min(max(pu / uu, 0.0), 1.0)
    return (px - s * ux) ** 2 + (py - s * uy) ** 2 + (pz - s * uz) ** 2
