"""Contacts of two meshes for the solver, between their closest features.

Where two surfaces come close, the distance of their points has a local minimum: between a corner and a face, two edges,
or, as long as they are apart, a corner and an edge or two corners. A contact is such a minimum: its normal must lie in
the normal cone of both features, the directions in which nothing near the feature reaches farther. Points within flat
faces and straight edges between coplanar faces have no contacts of their own (`topology`), so that a flat surface is
one surface however it is triangulated. The outside of a triangle is the side from which its corners run
counter-clockwise; an open surface has two outsides.

A placed triangle is an array (10, 3) in the world: its corners, m, then its seven normals as in Topology. Sides are 0
for body a and 1 for body b. Kernels append contacts to a ContactBuffer `out` after the first `found` and return the
new number.
"""

import math
from typing import NamedTuple

from drone_engine.arrays import Floats, Int32s, Integers
from drone_engine.collision.box.sat import SPEED_TIE, STEP_HEIGHT
from drone_engine.collision.margin import MARGIN
from drone_engine.collision.mesh.topology import EDGE, OPEN, POINTED
from drone_engine.collision.mesh.transforms import transform_point
from drone_engine.kernel import kernel

MIN_EDGES_SIN2 = 1e-6  # squared sine between two edges below which their cross product is no contact normal
CONE_TOLERANCE = 0.2  # sine by which a normal may leave a corner's cone: bodies that land flat may rock by this
WEDGE_TOLERANCE = 0.1  # the same for the wedge of an edge's faces
SAME_FACE = 0.9  # cosine between two normals above which faces do not stand against each other
SAME_NORMAL = 0.999  # the same for a face and the vector between two points
MIN_DISTANCE = 1e-9  # m, below which the vector between two points has no direction
CORNER_OF_A, CORNER_OF_B, EDGES, CLOSEST = range(4)  # kind of a contact, in the last two bits of its identifier
ROTATION, POSITION, VELOCITY, ANGULAR_VELOCITY, MOTION_SIZE = 0, 9, 12, 15, 18  # offsets in a row of PairState.motion


class MeshFeatures(NamedTuple):
    """The topology of a forest of meshes; m triangles."""

    normals: Floats  # (m, 7, 3) as in Topology
    owned: Integers  # (m,) as in Topology
    ring_range: Int32s  # (m, 3, 2) as in Topology
    ring: Floats  # (k, 3) as in Topology


class PairState(NamedTuple):
    """Two bodies whose contacts are sought."""

    placed: Floats  # (2, 10, 3) a placed triangle of each
    motion: Floats  # (2, MOTION_SIZE) of each: rotation matrix row by row; position, velocity, m/s, and angular
    # velocity, rad/s, in the world
    limits: Floats  # (4,) m: contacts are at most so far apart and so deep; s: and may close within this time, 0: all
    # may; by how much, as a sine, bodies at their impact may swing round it: then faces count however far they are, 0
    # for others


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
def feature_contacts(id_a, id_b, features, pair, out, found):
    """Appends the contacts of triangles id_a and id_b, which are placed in `pair`, within the limits of `pair`.

    features: MeshFeatures; pair: PairState.
    """
    owned_a, owned_b = features.owned[id_a], features.owned[id_b]
    for i in range(3):
        if owned_a & (POINTED << i):
            found = _corner_face_contact(0, id_a, i, id_b, features, pair, out, found)
            for k in range(3):
                if owned_b & (EDGE << k):
                    found = _corner_edge_contact(0, id_a, i, id_b, k, features, pair, out, found)
                if owned_b & (POINTED << k):
                    found = _corner_corner_contact(id_a, i, id_b, k, features, pair, out, found)
        if owned_b & (POINTED << i):
            found = _corner_face_contact(1, id_b, i, id_a, features, pair, out, found)
            for k in range(3):
                if owned_a & (EDGE << k):
                    found = _corner_edge_contact(1, id_b, i, id_a, k, features, pair, out, found)
    for i in range(3):
        if owned_a & (EDGE << i):
            for j in range(3):
                if owned_b & (EDGE << j):
                    found = _edge_edge_contact(id_a, i, id_b, j, features, pair, out, found)
    return found


@kernel
def _dot(u, i, v, j):
    """The dot product of row i of u and row j of v."""
    return u[i, 0] * v[j, 0] + u[i, 1] * v[j, 1] + u[i, 2] * v[j, 2]


@kernel
def approach_speed(motion, nx, ny, nz, x, y, z):
    """Speed, m/s, at which both bodies approach along the unit normal n from a to b at the point (x, y, z) in the
    world; motion: of PairState."""
    speed = 0.0
    for side in range(2):
        m = motion[side]
        rx, ry, rz = x - m[POSITION], y - m[POSITION + 1], z - m[POSITION + 2]
        wx, wy, wz = m[ANGULAR_VELOCITY], m[ANGULAR_VELOCITY + 1], m[ANGULAR_VELOCITY + 2]
        along = (nx * (m[VELOCITY] + wy * rz - wz * ry) + ny * (m[VELOCITY + 1] + wz * rx - wx * rz)
                 + nz * (m[VELOCITY + 2] + wx * ry - wy * rx))
        speed += along if side == 0 else -along
    return speed


@kernel
def _turning(motion, x, y, z):
    """The acceleration, m/s^2, at which rotation carries the point (x, y, z) off the tangents of its ways on a and b:
    an upper bound."""
    total = 0.0
    for side in range(2):
        m = motion[side]
        rx, ry, rz = x - m[POSITION], y - m[POSITION + 1], z - m[POSITION + 2]
        square = m[ANGULAR_VELOCITY] ** 2 + m[ANGULAR_VELOCITY + 1] ** 2 + m[ANGULAR_VELOCITY + 2] ** 2
        total += square * math.sqrt(rx * rx + ry * ry + rz * rz)
    return total


@kernel
def _closes(pair, gap, nx, ny, nz, x, y, z):
    """Whether a gap, m, may close within the time of `pair`, at the point (x, y, z) along the normal n from a to b."""
    dt = pair.limits[2]
    if gap <= MARGIN or dt == 0.0:
        return True
    speed = max(approach_speed(pair.motion, nx, ny, nz, x, y, z), 0.0)
    return gap <= MARGIN + dt * (speed + 0.5 * dt * _turning(pair.motion, x, y, z))


@kernel
def _in_cone(side, triangle, i, nx, ny, nz, features, pair, tolerance):
    """Whether the unit vector n, which points away from corner i of a triangle of body `side`, lies in the normal cone
    of the corner: whether no edge there reaches farther along n than the sine `tolerance`."""
    r = pair.motion[side]
    x = r[0] * nx + r[3] * ny + r[6] * nz
    y = r[1] * nx + r[4] * ny + r[7] * nz
    z = r[2] * nx + r[5] * ny + r[8] * nz
    ring = features.ring
    for k in range(features.ring_range[triangle, i, 0], features.ring_range[triangle, i, 1]):
        if x * ring[k, 0] + y * ring[k, 1] + z * ring[k, 2] > tolerance:
            return False
    return True


@kernel
def _is_flush(side, triangle, i, other, nx, ny, nz, gap, features, pair, same):
    """Whether a contact of corner i of a triangle of body `side` is that with the side of a step of less than
    STEP_HEIGHT: whether the corner lies in the plane of another face at the same place, row 3 to 6 of the placed
    triangle `other`, that may carry it. The contact's normal n points from `other` to the corner; gap: m; same:
    SAME_FACE or SAME_NORMAL.

    Of two faces of which both are as close, the one that approaches faster is the side of the step.
    """
    p = pair.placed[side]
    x, y, z = p[i, 0], p[i, 1], p[i, 2]
    for row in range(3, 7):
        ux, uy, uz = other[row, 0], other[row, 1], other[row, 2]
        if abs(ux * nx + uy * ny + uz * nz) > same or ux == uy == uz == 0.0:
            continue
        corner = 0 if row == 3 else row - 4
        height = (x - other[corner, 0]) * ux + (y - other[corner, 1]) * uy + (z - other[corner, 2]) * uz
        if abs(height) > STEP_HEIGHT or not _in_cone(side, triangle, i, -ux, -uy, -uz, features, pair, CONE_TOLERANCE):
            continue
        if abs(gap) > STEP_HEIGHT:
            return True
        sign = -1.0 if side == 0 else 1.0  # normals are to point from a to b
        across = approach_speed(pair.motion, sign * nx, sign * ny, sign * nz, x, y, z)
        if across > approach_speed(pair.motion, sign * ux, sign * uy, sign * uz, x, y, z) + SPEED_TIE:
            return True
    return False


@kernel
def _append(nx, ny, nz, side, x, y, z, gap, identifier, out, found):
    """Appends a contact. n: normal from the other body to body `side`, on which (x, y, z) is the point; gap: m."""
    if found < out.feature.shape[0]:
        normal, point = out.normal, out.point
        sign = -1.0 if side == 0 else 1.0
        normal[found, 0], normal[found, 1], normal[found, 2] = sign * nx, sign * ny, sign * nz
        point[found, side, 0], point[found, side, 1], point[found, side, 2] = x, y, z
        point[found, 1 - side, 0] = x - gap * nx
        point[found, 1 - side, 1] = y - gap * ny
        point[found, 1 - side, 2] = z - gap * nz
        out.separation[found], out.feature[found] = gap, identifier
    return found + 1


@kernel
def _corner_face_contact(side, id_corner, i, id_face, features, pair, out, found):
    """Appends the contact of corner i of a triangle of body `side` with the face of a triangle of the other body, if
    the corner projects into the face and the face opposes the corner's cone."""
    p, face, motion = pair.placed[side], pair.placed[1 - side], pair.motion
    nx, ny, nz = face[3, 0], face[3, 1], face[3, 2]
    x, y, z = p[i, 0], p[i, 1], p[i, 2]
    gap = (x - face[0, 0]) * nx + (y - face[0, 1]) * ny + (z - face[0, 2]) * nz
    if not abs(gap) <= max(pair.limits[0], pair.limits[1]):
        return found
    for k in range(3):
        m = k + 1 if k < 2 else 0
        ex, ey, ez = face[m, 0] - face[k, 0], face[m, 1] - face[k, 1], face[m, 2] - face[k, 2]
        dx, dy, dz = x - face[k, 0], y - face[k, 1], z - face[k, 2]
        if (ny * ez - nz * ey) * dx + (nz * ex - nx * ez) * dy + (nx * ey - ny * ex) * dz < 0.0:
            return found  # outside of that edge; a corner on it counts as inside
    if features.owned[id_face] & OPEN:  # of its two sides the one that the corner comes from
        if features.owned[id_corner] & OPEN:
            cx, cy, cz = motion[side, POSITION], motion[side, POSITION + 1], motion[side, POSITION + 2]
            outward = (cx - x + gap * nx) * nx + (cy - y + gap * ny) * ny + (cz - z + gap * nz) * nz
        else:
            outward = -_dot(p, 7 + i, face, 3)
        if outward < 0.0:
            nx, ny, nz, gap = -nx, -ny, -nz, -gap
    if not -pair.limits[1] <= gap <= pair.limits[0]:
        return found
    if not _in_cone(side, id_corner, i, -nx, -ny, -nz, features, pair, max(CONE_TOLERANCE, pair.limits[3])):
        return found
    sign = -1.0 if side == 0 else 1.0
    if pair.limits[3] == 0.0 and not _closes(pair, gap, sign * nx, sign * ny, sign * nz, x, y, z):
        return found
    if _is_flush(side, id_corner, i, face, nx, ny, nz, gap, features, pair, SAME_FACE):
        return found
    identifier = (CORNER_OF_A if side == 0 else CORNER_OF_B) + 4 * (3 * id_corner + i)
    return _append(nx, ny, nz, side, x, y, z, gap, identifier, out, found)


@kernel
def _corner_edge_contact(side, id_corner, i, id_edge, k, features, pair, out, found):
    """Appends the contact of corner i of a triangle of body `side` with edge k of a triangle of the other body, if they
    are apart and the corner projects between the ends of the edge."""
    p, t = pair.placed[side], pair.placed[1 - side]
    m = k + 1 if k < 2 else 0
    ex, ey, ez = t[m, 0] - t[k, 0], t[m, 1] - t[k, 1], t[m, 2] - t[k, 2]
    x, y, z = p[i, 0], p[i, 1], p[i, 2]
    dx, dy, dz = x - t[k, 0], y - t[k, 1], z - t[k, 2]
    square = ex * ex + ey * ey + ez * ez
    along = dx * ex + dy * ey + dz * ez
    if not 0.0 < along < square:
        return found
    along /= square
    dx, dy, dz = dx - along * ex, dy - along * ey, dz - along * ez
    gap = math.sqrt(dx * dx + dy * dy + dz * dz)
    if not MIN_DISTANCE < gap <= pair.limits[0]:
        return found
    nx, ny, nz = dx / gap, dy / gap, dz / gap
    length = math.sqrt(square)
    if not _inside_wedge(t, k, ex / length, ey / length, ez / length, nx, ny, nz, 0.0):
        return found
    return _append_gap(side, id_corner, i, nx, ny, nz, gap, 3 * id_edge + k, features, pair, out, found)


@kernel
def _append_gap(side, id_corner, i, nx, ny, nz, gap, id_other, features, pair, out, found):
    """Appends the contact of corner i of a triangle of body `side` with an edge or a corner of the other body, unless
    the corner's cone or its speed excludes it. n: from the other body to the corner; id_other: of the other feature."""
    p = pair.placed[side]
    x, y, z = p[i, 0], p[i, 1], p[i, 2]
    sign = -1.0 if side == 0 else 1.0
    if not (_in_cone(side, id_corner, i, -nx, -ny, -nz, features, pair, 0.0)
            and _closes(pair, gap, sign * nx, sign * ny, sign * nz, x, y, z)):
        return found
    if _is_flush(side, id_corner, i, pair.placed[1 - side], nx, ny, nz, gap, features, pair, SAME_NORMAL):
        return found
    identifier = CLOSEST + 4 * ((3 * id_corner + i) << 30 | id_other << 1 | side)
    return _append(nx, ny, nz, side, x, y, z, gap, identifier, out, found)


@kernel
def _corner_corner_contact(id_a, i, id_b, j, features, pair, out, found):
    """Appends the contact of corner i of a with corner j of b, if they are apart."""
    a, b = pair.placed[0], pair.placed[1]
    nx, ny, nz = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
    gap = math.sqrt(nx * nx + ny * ny + nz * nz)
    if not MIN_DISTANCE < gap <= pair.limits[0]:
        return found
    nx, ny, nz = nx / gap, ny / gap, nz / gap
    if not _in_cone(1, id_b, j, nx, ny, nz, features, pair, 0.0):
        return found
    if _is_flush(1, id_b, j, a, -nx, -ny, -nz, gap, features, pair, SAME_NORMAL):
        return found
    return _append_gap(0, id_a, i, nx, ny, nz, gap, 3 * id_b + j, features, pair, out, found)


@kernel
def _inside_wedge(t, i, dx, dy, dz, x, y, z, tolerance):
    """Whether the unit vector (x, y, z), perpendicular to edge i of placed triangle t, lies between the normals of the
    two faces at that edge, up to the sine `tolerance`. (dx, dy, dz): unit vector along the edge."""
    for side in range(2):
        row, sign = (3, 1.0) if side == 0 else (4 + i, -1.0)
        nx, ny, nz = t[row, 0], t[row, 1], t[row, 2]
        if sign * ((ny * dz - nz * dy) * x + (nz * dx - nx * dz) * y + (nx * dy - ny * dx) * z) > tolerance:
            return False
    return True


@kernel
def _ends_flush(side, triangle, i, fraction, length, t, nx, ny, nz, gap, features, pair):
    """Whether a contact at a fraction of edge i of a triangle of body `side`, m long, is near one of the edge's ends
    and that corner lies flush with a face at edge t of the other body; t: placed triangle, n: towards `side`."""
    if fraction * length < STEP_HEIGHT:
        return _is_flush(side, triangle, i, t, nx, ny, nz, gap, features, pair, SAME_FACE)
    if (1.0 - fraction) * length < STEP_HEIGHT:
        return _is_flush(side, triangle, i + 1 if i < 2 else 0, t, nx, ny, nz, gap, features, pair, SAME_FACE)
    return False


@kernel
def _edge_edge_contact(id_a, i, id_b, j, features, pair, out, found):
    """Appends the contact of edge i of a with edge j of b, if the closest points of their lines lie on both edges.

    The formula is that of Ericson 2005, Real-Time Collision Detection, 5.1.8; cf. `triangle.closest`, where points are
    clamped to the edges and roundings differ.
    """
    a, b, motion = pair.placed[0], pair.placed[1], pair.motion
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
    # Out of the surface of a, or into that of b, or (two borders of open surfaces) from one body to the other.
    side = 0.0
    if not features.owned[id_a] & OPEN:
        side = x * (a[3, 0] + a[4 + i, 0]) + y * (a[3, 1] + a[4 + i, 1]) + z * (a[3, 2] + a[4 + i, 2])
    elif not features.owned[id_b] & OPEN:
        side = -(x * (b[3, 0] + b[4 + j, 0]) + y * (b[3, 1] + b[4 + j, 1]) + z * (b[3, 2] + b[4 + j, 2]))
    if side == 0.0:
        for c, along in enumerate((x, y, z)):
            side += along * (motion[1, POSITION + c] - motion[0, POSITION + c])
    if side < 0.0:
        x, y, z = -x, -y, -z
    gap = -(wx * x + wy * y + wz * z)
    if not -pair.limits[1] <= gap <= pair.limits[0]:
        return found
    length_a, length_b = math.sqrt(uu), math.sqrt(vv)
    if not (_inside_wedge(a, i, ux / length_a, uy / length_a, uz / length_a, x, y, z, WEDGE_TOLERANCE)
            and _inside_wedge(b, j, vx / length_b, vy / length_b, vz / length_b, -x, -y, -z, WEDGE_TOLERANCE)):
        return found
    px, py, pz = a[i, 0] + s * ux, a[i, 1] + s * uy, a[i, 2] + s * uz
    if not _closes(pair, gap, x, y, z, px, py, pz):
        return found
    if (_ends_flush(0, id_a, i, s, length_a, b, -x, -y, -z, gap, features, pair)
            or _ends_flush(1, id_b, j, t, length_b, a, x, y, z, gap, features, pair)):
        return found
    identifier = EDGES + 4 * ((3 * id_a + i) << 29 | (3 * id_b + j))
    return _append(-x, -y, -z, 0, px, py, pz, gap, identifier, out, found)
