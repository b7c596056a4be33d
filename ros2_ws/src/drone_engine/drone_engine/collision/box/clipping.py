"""Contact normals and points of boxes: one face clipped to another, or two edges that cross.

The kernels take a table of pairs as in sat.py, after `find_contact_axes`, and write manifolds as in ContactArrays.
"""

import math

from drone_engine.collision.box.sat import AXIS, BLOCK, CENTER_A, GAP, MARGIN, SWAPPED
from drone_engine.collision.manifold import POINTS
from drone_engine.kernel import kernel

CUT = 68  # four numbers for each of the 16 points that may be corners of the overlap of two faces, and one more
ENLARGEMENT = 1e-9  # of the size of the reference face
SMALL = 1e-100  # m, m2: projected edges and areas below this are not cut


@kernel
def write_face_manifolds(table, count, which, points, normal, point, separation, feature, cut):
    """Writes the manifolds of those of the first `count` columns whose contact axis is a face normal.

    The incident face, the one of the other box that faces the reference face most, is clipped to the reference face.
    Column k writes row which[k] of the arrays (m, ...), or none if that is -1. cut: (CUT,) scratch: u, v, w and an
    identifier of each point, in the frame of the reference face.

    Corners of the overlap are corners of either face and crossings of their edges. All candidates are computed without
    branches, which would be predicted wrongly, and each is overwritten by the next unless it counts.
    """
    for k in range(count):
        axis = int(table[AXIS + k])
        if axis >= 6 or which[k] < 0:
            continue
        r = 0 if axis < 3 else 1
        face = axis - 3 * r
        own, other, own_half, other_half = 9 + 9 * r, 18 - 9 * r, 3 + 3 * r, 6 - 3 * r  # rows of the table
        toward = 1.0 if r == 0 else -1.0  # from box r to the other
        dx, dy, dz = toward * table[k], toward * table[BLOCK + k], toward * table[2 * BLOCK + k]
        nx, ny, nz = _vector(table, k, own + 3 * face)
        side = 1.0 if nx * dx + ny * dy + nz * dz >= 0.0 else -1.0
        nx, ny, nz = side * nx, side * ny, side * nz
        ux, uy, uz = _vector(table, k, own + 3 * ((face + 1) % 3))
        vx, vy, vz = _vector(table, k, own + 3 * ((face + 2) % 3))
        x, y, z = _vector(table, k, other)
        f0 = x * nx + y * ny + z * nz
        x, y, z = _vector(table, k, other + 3)
        f1 = x * nx + y * ny + z * nz
        x, y, z = _vector(table, k, other + 6)
        f2 = x * nx + y * ny + z * nz
        most = max(abs(f0), abs(f1), abs(f2))
        incident = 0 if abs(f0) == most else 1 if abs(f1) == most else 2
        facing = f0 if incident == 0 else f1 if incident == 1 else f2
        # Center c and half edges p, q of the incident face in the frame of the reference face: u, v in it, w above.
        h = table[(other_half + incident) * BLOCK + k]
        h = -h if facing > 0.0 else h
        x, y, z = _vector(table, k, other + 3 * incident)
        x, y, z = dx + h * x, dy + h * y, dz + h * z
        height = table[(own_half + face) * BLOCK + k]
        cu, cv, cw = x * ux + y * uy + z * uz, x * vx + y * vy + z * vz, x * nx + y * ny + z * nz - height
        p, q = (incident + 1) % 3, (incident + 2) % 3
        h = table[(other_half + p) * BLOCK + k]
        x, y, z = _vector(table, k, other + 3 * p)
        pu, pv, pw = h * (x * ux + y * uy + z * uz), h * (x * vx + y * vy + z * vz), h * (x * nx + y * ny + z * nz)
        h = table[(other_half + q) * BLOCK + k]
        x, y, z = _vector(table, k, other + 3 * q)
        qu, qv, qw = h * (x * ux + y * uy + z * uz), h * (x * vx + y * vy + z * vz), h * (x * nx + y * ny + z * nz)
        # The reference face is enlarged slightly, so that congruent faces do not give every corner twice.
        lu, lv = table[(own_half + (face + 1) % 3) * BLOCK + k], table[(own_half + (face + 2) % 3) * BLOCK + k]
        enlargement = ENLARGEMENT * (lu + lv)
        lu, lv, margin = lu + enlargement, lv + enlargement, table[MARGIN + k]

        end, inside = 0, 0  # length of `cut` in use; a bit for each corner of the incident face
        for corner in range(4):  # of the incident face: one bit for the end of p, one for the end of q
            s, t = 1.0 if corner & 1 else -1.0, 1.0 if corner & 2 else -1.0
            a, b, c = cu + s * pu + t * qu, cv + s * pv + t * qv, cw + s * pw + t * qw
            within = (abs(a) <= lu) & (abs(b) <= lv)
            cut[end], cut[end + 1], cut[end + 2], cut[end + 3] = a, b, c, corner
            inside |= within << corner
            end += 4 * (within & (c <= margin))
        for edge in range(4):  # of the incident face: two along p, two along q, each |t| < 1
            if edge < 2:
                s, eu, ev, ew = 2.0 * edge - 1.0, pu, pv, pw
                a, b, c = cu + s * qu, cv + s * qv, cw + s * qw
                start, stop = inside >> 2 * edge & 1, inside >> 2 * edge + 1 & 1
            else:
                s, eu, ev, ew = 2.0 * edge - 5.0, qu, qv, qw
                a, b, c = cu + s * pu, cv + s * pv, cw + s * pw
                start, stop = inside >> edge - 2 & 1, inside >> edge & 1
            per_u = 1.0 / eu if abs(eu) > SMALL else 1.0 / SMALL
            per_v = 1.0 / ev if abs(ev) > SMALL else 1.0 / SMALL
            enter_u, enter_v = -a * per_u - lu * abs(per_u), -b * per_v - lv * abs(per_v)
            leave_u, leave_v = -a * per_u + lu * abs(per_u), -b * per_v + lv * abs(per_v)
            enter, leave = max(enter_u, enter_v), min(leave_u, leave_v)
            t = c + enter * ew
            cut[end], cut[end + 1], cut[end + 2] = a + enter * eu, b + enter * ev, t
            cut[end + 3] = 8 + 4 * edge + (enter != enter_u)
            end += 4 * ((start == 0) & (enter < leave) & (enter > -1.0) & (enter < 1.0) & (t <= margin))
            t = c + leave * ew
            cut[end], cut[end + 1], cut[end + 2] = a + leave * eu, b + leave * ev, t
            cut[end + 3] = 10 + 4 * edge + (leave != leave_u)
            end += 4 * ((stop == 0) & (enter < leave) & (leave > -1.0) & (leave < 1.0) & (t <= margin))
        area = pu * qv - pv * qu
        per = 1.0 / area if abs(area) > SMALL else 0.0
        for corner in range(4):  # of the reference face, above or below the incident face
            a, b = lu if corner & 1 else -lu, lv if corner & 2 else -lv
            s, t = ((a - cu) * qv - (b - cv) * qu) * per, ((b - cv) * pu - (a - cu) * pv) * per
            c = cw + s * pw + t * qw
            cut[end], cut[end + 1], cut[end + 2], cut[end + 3] = a, b, c, 4 + corner
            end += 4 * ((abs(s) < 1.0) & (abs(t) < 1.0) & (per != 0.0) & (c <= margin))
        if end == 0 and table[GAP + k] <= enlargement:  # they overlap beside the incident face: its deepest corner
            s, t = 1.0 if pw < 0.0 else -1.0, 1.0 if qw < 0.0 else -1.0
            cut[0], cut[1], cut[2] = cu + s * pu + t * qu, cv + s * pv + t * qv, table[GAP + k]
            cut[3] = (s > 0.0) + 2 * (t > 0.0)
            end = 4

        at = which[k]
        swapped = table[SWAPPED + k] > 0.0
        s = toward if not swapped else -toward
        normal[at, 0], normal[at, 1], normal[at, 2] = s * nx, s * ny, s * nz
        x, y, z = _vector(table, k, CENTER_A // BLOCK)
        if r == 1:
            x, y, z = x - dx, y - dy, z - dz
        reference = (3 if (r == 1) != swapped else 0) + face  # 0 to 2: of a, 3 to 5: of b, as before `load_ordered`
        faces = reference * 3 + incident << 6
        found = min(end // 4, POINTS)
        points[at] = found
        for n in range(found):
            a, b, s = cut[4 * n], cut[4 * n + 1], cut[4 * n + 2]
            c = height + 0.5 * s
            point[at, n, 0] = x + (a * ux + b * vx + c * nx)
            point[at, n, 1] = y + (a * uy + b * vy + c * ny)
            point[at, n, 2] = z + (a * uz + b * vz + c * nz)
            separation[at, n] = s
            feature[at, n] = faces + int(cut[4 * n + 3])


@kernel
def write_edge_manifolds(table, count, which, points, normal, point, separation, feature):
    """Writes the manifolds of those of the first `count` columns whose contact axis is a cross product of two edges.

    Such a manifold has one point, midway between the two edges that face each other. Parameters as in
    `write_face_manifolds`.
    """
    for k in range(count):
        axis = int(table[AXIS + k]) - 6
        if axis < 0 or which[k] < 0:
            continue
        i = axis // 3
        j = axis - 3 * i
        e, f, g = _vector(table, k, 9 + 3 * i)
        u, v, w = _vector(table, k, 18 + 3 * j)
        dx, dy, dz = _vector(table, k, 0)
        nx, ny, nz = f * w - g * v, g * u - e * w, e * v - f * u
        s = 1.0 if nx * dx + ny * dy + nz * dz >= 0.0 else -1.0
        s /= math.sqrt(nx * nx + ny * ny + nz * nz)
        nx, ny, nz = s * nx, s * ny, s * nz
        ax, ay, az = _vector(table, k, CENTER_A // BLOCK)
        bx, by, bz = ax + dx, ay + dy, az + dz
        for n in range(1, 3):
            row = (i + n) % 3
            x, y, z = _vector(table, k, 9 + 3 * row)
            s = table[(3 + row) * BLOCK + k]
            s = s if x * nx + y * ny + z * nz >= 0.0 else -s
            ax, ay, az = ax + s * x, ay + s * y, az + s * z
            row = (j + n) % 3
            x, y, z = _vector(table, k, 18 + 3 * row)
            s = table[(6 + row) * BLOCK + k]
            s = -s if x * nx + y * ny + z * nz >= 0.0 else s
            bx, by, bz = bx + s * x, by + s * y, bz + s * z
        # Closest points of two lines (Ericson 2005, Real-Time Collision Detection, 5.1.8); not parallel.
        cosine = e * u + f * v + g * w
        x, y, z = ax - bx, ay - by, az - bz
        on_a, on_b = e * x + f * y + g * z, u * x + v * y + w * z
        per = 1.0 / (1.0 - cosine * cosine)
        s, t = table[(3 + i) * BLOCK + k], table[(6 + j) * BLOCK + k]
        s = min(max((cosine * on_b - on_a) * per, -s), s)
        t = min(max((on_b - cosine * on_a) * per, -t), t)
        at = which[k]
        point[at, 0, 0] = 0.5 * (ax + s * e + bx + t * u)
        point[at, 0, 1] = 0.5 * (ay + s * f + by + t * v)
        point[at, 0, 2] = 0.5 * (az + s * g + bz + t * w)
        swapped = table[SWAPPED + k] > 0.0
        s = -1.0 if swapped else 1.0
        normal[at, 0], normal[at, 1], normal[at, 2] = s * nx, s * ny, s * nz
        separation[at, 0] = table[GAP + k]
        feature[at, 0] = (1 << 20) + (3 * j + i if swapped else 3 * i + j)  # 3 * axis of the edge of a + that of b
        points[at] = 1


@kernel
def _vector(table, k, row):
    """Three numbers of column k, from this row on."""
    return table[row * BLOCK + k], table[(row + 1) * BLOCK + k], table[(row + 2) * BLOCK + k]
