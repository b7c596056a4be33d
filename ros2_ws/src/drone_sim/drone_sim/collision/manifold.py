"""Contacts: for each pair that touches or nearly does, a normal and up to eight points, and how boxes come to them."""

import math
from typing import Any

import numpy as np

from drone_sim.arrays import Floats, Integers
from drone_sim.collision.sat import AXIS, BLOCK, GAP, MARGIN, PLACE, SWAPPED
from drone_sim.kernel import kernel

POINTS = 8  # of a manifold, at most
CUT = 68  # four numbers each of the 16 points that may be corners of what two faces cover, and one more
HAIR = 1e-9  # of a face's size
STEEP = 1e-100  # m, m2: what is shorter or smaller than this is cut nowhere
BOXES, OTHERS, MESHES, SWEPT = range(4)  # the parts that manifolds stand in
PARTS = 4
SAME_SIDE = 0.9  # cosine of the angle up to which a contact is still that of the step before


class Manifolds:
    """Contacts between bodies a < b, in parts: those of boxes, then of spheres and floors, of meshes, of which a pair
    may have several, and of fast bodies; each part in the order of (a, b). Beyond `points[i]` points of manifold i hold
    nothing."""

    def __init__(self, capacity: int) -> None:
        self.end: Integers = np.zeros(PARTS, np.int64)  # where each part ends
        self.pair: Integers = np.empty((capacity, 2), np.int64)  # a, b
        self.level: Integers = np.empty(capacity, np.int64)  # at which the two met
        self.points: Integers = np.empty(capacity, np.int64)  # how many
        self.normal_w: Floats = np.empty((capacity, 3))  # unit, from a to b
        self.point_w: Floats = np.empty((capacity, POINTS, 3))  # m, midway between the surfaces
        self.anchor_w: Floats = np.empty((capacity, POINTS, 2, 3))  # m, from the centres of a and b, as the step starts
        self.separation: Floats = np.empty((capacity, POINTS))  # m, negative where they overlap
        self.feature: Integers = np.empty((capacity, POINTS), np.int64)  # names a point from step to step
        self.impulse: Floats = np.empty((capacity, POINTS))  # N s, along the normal, of the last sub-step
        self.friction: Floats = np.empty((capacity, 2, 4))  # of the first four points, and of the others: N s in the
        # world, N m s about the normal; of the last sub-step
        self.total: Floats = np.empty((capacity, POINTS))  # N s, along the normal, in the whole step
        self.last = Last(capacity)  # what is kept of the step before

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.end[-1])

    @count.setter
    def count(self, count: int) -> None:
        self.end[-1] = count

    @property
    def capacity(self) -> int:
        return len(self.points)

    def forget(self) -> None:
        """There are no contacts, and there were none."""
        self.end[:] = self.last.end[:] = 0

    def with_room(self, more: int) -> "Manifolds":
        """These, or a larger copy that holds so many more."""
        if self.count + more <= self.capacity:
            return self
        larger = Manifolds(2 * (self.count + more))
        larger.last = self.last.with_room(larger.capacity)
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                count = PARTS if name == "end" else self.count
                getattr(larger, name)[:count] = value[:count]
        return larger


class Last:
    """What is kept of a step's manifolds: how those of the next start, and what touched."""

    def __init__(self, capacity: int) -> None:
        self.end: Integers = np.zeros(PARTS, np.int64)
        self.pair: Integers = np.empty((capacity, 2), np.int64)
        self.level: Integers = np.empty(capacity, np.int64)
        self.points: Integers = np.empty(capacity, np.int64)
        self.normal_w: Floats = np.empty((capacity, 3))
        self.point_w: Floats = np.empty((capacity, POINTS, 3))
        self.feature: Integers = np.empty((capacity, POINTS), np.int64)
        self.impulse: Floats = np.empty((capacity, POINTS))
        self.friction: Floats = np.empty((capacity, 2, 4))
        self.touch: Floats = np.empty((capacity, 5))  # as `touches` writes it

    def with_room(self, capacity: int) -> "Last":
        """These, or a larger copy that holds so many."""
        if capacity <= len(self.points):
            return self
        larger = Last(capacity)
        for name, value in vars(self).items():
            count = PARTS if name == "end" else self.end[-1]
            getattr(larger, name)[:count] = value[:count]
        return larger

    def arrays(self) -> tuple[Any, ...]:
        """As `keep` and `carry_over` take them."""
        return (self.end, self.pair, self.level, self.points, self.normal_w, self.point_w, self.feature, self.impulse,
                self.friction, self.touch)


@kernel
def touches(i, points, point, separation, total, out):
    """Writes how manifold i touches: its deepest point, the depth there, the impulse of the step; depth and impulse are
    not both 0 or less where it does."""
    best, impulse = 0, 0.0
    for k in range(points[i]):
        impulse += total[i, k]
        if separation[i, k] < separation[i, best]:
            best = k
    out[0], out[1], out[2], out[3], out[4] = (point[i, best, 0], point[i, best, 1], point[i, best, 2],
                                              -separation[i, best], impulse)


@kernel
def keep(end, pair, level, points, normal, point, separation, feature, impulse, friction, total, last_end, last_pair,
         last_level, last_points, last_normal, last_point, last_feature, last_impulse, last_friction,
         last_touch):
    """Copies what is kept of the manifolds, before those of another step are found."""
    for part in range(PARTS):
        last_end[part] = end[part]
    for i in range(end[PARTS - 1]):
        last_pair[i, 0], last_pair[i, 1] = pair[i, 0], pair[i, 1]
        last_points[i], last_level[i] = points[i], level[i]
        for c in range(3):
            last_normal[i, c] = normal[i, c]
        for c in range(4):
            last_friction[i, 0, c], last_friction[i, 1, c] = friction[i, 0, c], friction[i, 1, c]
        for k in range(points[i]):
            last_feature[i, k], last_impulse[i, k] = feature[i, k], impulse[i, k]
            for c in range(3):
                last_point[i, k, c] = point[i, k, c]
        touches(i, points, point, separation, total, last_touch[i])


@kernel
def anchor(first, count, pair, points, point, position, anchors):
    """Writes for the points of manifolds first to count where they are from the centres of the two bodies."""
    for i in range(first, count):
        for k in range(points[i]):
            for side in range(2):
                for c in range(3):
                    anchors[i, k, side, c] = point[i, k, c] - position[pair[i, side], c]


@kernel
def carry_over(end, pair, points, normal, point, feature, impulse, friction, last_end, last_pair, last_level,
               last_points, last_normal, last_point, last_feature, last_impulse, last_friction,
         last_touch):
    """Starts each manifold with the impulses and the friction that the one of the same pair, and of nearly the same
    normal, ended the last step with. Both stand in the order of their pairs."""
    for part in range(PARTS):
        first, last = (end[part - 1], last_end[part - 1]) if part else (0, 0)
        for i in range(first, end[part]):
            a, b = pair[i, 0], pair[i, 1]
            while last < last_end[part] and (last_pair[last, 0] < a
                                             or (last_pair[last, 0] == a and last_pair[last, 1] < b)):
                last += 1
            for k in range(points[i]):
                impulse[i, k] = 0.0
            for c in range(4):
                friction[i, 0, c] = friction[i, 1, c] = 0.0
            known = last if part != SWEPT else last_end[part]
            while known < last_end[part] and last_pair[known, 0] == a and last_pair[known, 1] == b:
                if (normal[i, 0] * last_normal[known, 0] + normal[i, 1] * last_normal[known, 1]
                        + normal[i, 2] * last_normal[known, 2]) > SAME_SIDE:
                    for m in range(last_points[known]):
                        k = _heir(i, known, m, points, point, feature, last_point, last_feature)
                        impulse[i, k] += last_impulse[known, m]
                    for c in range(4):
                        friction[i, 0, c], friction[i, 1, c] = last_friction[known, 0, c], last_friction[known, 1, c]
                known += 1


@kernel
def _heir(i, known, m, points, point, feature, last_point, last_feature):
    """The point of manifold i that goes on from point m of the one before: of the same name, else the nearest, so that
    nothing that carried is lost when faces turn a hair and their corners are others."""
    best, least = 0, 1e300
    for k in range(points[i]):
        if feature[i, k] == last_feature[known, m]:
            return k
        square = 0.0
        for c in range(3):
            square += (point[i, k, c] - last_point[known, m, c]) ** 2
        if square < least:
            best, least = k, square
    return best


@kernel
def cut_faces(table, count, which, points, normal, point, separation, feature, cut):
    """The manifolds of the columns that `rank` gave a face as axis: the face of the other box that looks most against
    it, clipped to it. Column k writes what is number which[k] of the arrays, nothing if -1. cut: (CUT,) scratch.

    Corners of what both faces cover are corners of the one, corners of the other and crossings of edges: all are
    tried without branches, which would be guessed wrong, and written one over the other until one counts.
    """
    for k in range(count):
        axis = int(table[AXIS + k])
        if axis >= 6 or which[k] < 0:
            continue
        r = 0 if axis < 3 else 1
        face = axis - 3 * r
        own, other, own_half, other_half = 9 + 9 * r, 18 - 9 * r, 3 + 3 * r, 6 - 3 * r
        toward = 1.0 if r == 0 else -1.0  # from box r to the other
        dx, dy, dz = toward * table[k], toward * table[BLOCK + k], toward * table[2 * BLOCK + k]
        nx, ny, nz = _column(table, k, own + 3 * face)
        side = 1.0 if nx * dx + ny * dy + nz * dz >= 0.0 else -1.0
        nx, ny, nz = side * nx, side * ny, side * nz
        ux, uy, uz = _column(table, k, own + 3 * ((face + 1) % 3))
        vx, vy, vz = _column(table, k, own + 3 * ((face + 2) % 3))
        x, y, z = _column(table, k, other)
        f0 = x * nx + y * ny + z * nz
        x, y, z = _column(table, k, other + 3)
        f1 = x * nx + y * ny + z * nz
        x, y, z = _column(table, k, other + 6)
        f2 = x * nx + y * ny + z * nz
        most = max(abs(f0), abs(f1), abs(f2))
        incident = 0 if abs(f0) == most else 1 if abs(f1) == most else 2
        facing = f0 if incident == 0 else f1 if incident == 1 else f2
        # Of the incident face in the frame of the reference face (u, v along it, w above): the middle, half its edges.
        h = table[(other_half + incident) * BLOCK + k]
        h = -h if facing > 0.0 else h
        x, y, z = _column(table, k, other + 3 * incident)
        x, y, z = dx + h * x, dy + h * y, dz + h * z
        height = table[(own_half + face) * BLOCK + k]
        cu, cv, cw = x * ux + y * uy + z * uz, x * vx + y * vy + z * vz, x * nx + y * ny + z * nz - height
        p, q = (incident + 1) % 3, (incident + 2) % 3
        h = table[(other_half + p) * BLOCK + k]
        x, y, z = _column(table, k, other + 3 * p)
        pu, pv, pw = h * (x * ux + y * uy + z * uz), h * (x * vx + y * vy + z * vz), h * (x * nx + y * ny + z * nz)
        h = table[(other_half + q) * BLOCK + k]
        x, y, z = _column(table, k, other + 3 * q)
        qu, qv, qw = h * (x * ux + y * uy + z * uz), h * (x * vx + y * vy + z * vz), h * (x * nx + y * ny + z * nz)
        # The reference face is a hair larger, so that equal faces on each other do not give every corner twice.
        lu, lv = table[(own_half + (face + 1) % 3) * BLOCK + k], table[(own_half + (face + 2) % 3) * BLOCK + k]
        hair = HAIR * (lu + lv)
        lu, lv, margin = lu + hair, lv + hair, table[MARGIN + k]

        end, inside = 0, 0  # end: of what is in cut, four numbers a point
        for corner in range(4):  # of the incident face: a bit each, which end of p, which end of q
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
            per_u = 1.0 / eu if abs(eu) > STEEP else 1.0 / STEEP
            per_v = 1.0 / ev if abs(ev) > STEEP else 1.0 / STEEP
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
        per = 1.0 / area if abs(area) > STEEP else 0.0
        for corner in range(4):  # of the reference face, above or below the incident face
            a, b = lu if corner & 1 else -lu, lv if corner & 2 else -lv
            s, t = ((a - cu) * qv - (b - cv) * qu) * per, ((b - cv) * pu - (a - cu) * pv) * per
            c = cw + s * pw + t * qw
            cut[end], cut[end + 1], cut[end + 2], cut[end + 3] = a, b, c, 4 + corner
            end += 4 * ((abs(s) < 1.0) & (abs(t) < 1.0) & (per != 0.0) & (c <= margin))
        if end == 0 and table[GAP + k] <= hair:  # they overlap beside the incident face: its corner that is deepest
            s, t = 1.0 if pw < 0.0 else -1.0, 1.0 if qw < 0.0 else -1.0
            cut[0], cut[1], cut[2] = cu + s * pu + t * qu, cv + s * pv + t * qv, table[GAP + k]
            cut[3] = (s > 0.0) + 2 * (t > 0.0)
            end = 4

        at = which[k]
        swapped = table[SWAPPED + k] > 0.0
        s = toward if not swapped else -toward
        normal[at, 0], normal[at, 1], normal[at, 2] = s * nx, s * ny, s * nz
        x, y, z = _column(table, k, PLACE // BLOCK)
        if r == 1:
            x, y, z = x - dx, y - dy, z - dz
        name = ((3 if (r == 1) != swapped else 0) + face) * 3 + incident << 6  # whether a face of b, and which
        found = min(end // 4, POINTS)
        points[at] = found
        for n in range(found):
            a, b, s = cut[4 * n], cut[4 * n + 1], cut[4 * n + 2]
            c = height + 0.5 * s
            point[at, n, 0] = x + (a * ux + b * vx + c * nx)
            point[at, n, 1] = y + (a * uy + b * vy + c * ny)
            point[at, n, 2] = z + (a * uz + b * vz + c * nz)
            separation[at, n] = s
            feature[at, n] = name + int(cut[4 * n + 3])


@kernel
def cross_edges(table, count, which, points, normal, point, separation, feature):
    """The manifolds of the columns that `rank` gave a crossing of two edges as axis: one point, midway between those
    two edges that face each other. Column k writes what is number which[k] of the arrays."""
    for k in range(count):
        axis = int(table[AXIS + k]) - 6
        if axis < 0 or which[k] < 0:
            continue
        i = axis // 3
        j = axis - 3 * i
        e, f, g = _column(table, k, 9 + 3 * i)
        u, v, w = _column(table, k, 18 + 3 * j)
        dx, dy, dz = _column(table, k, 0)
        nx, ny, nz = f * w - g * v, g * u - e * w, e * v - f * u
        s = 1.0 if nx * dx + ny * dy + nz * dz >= 0.0 else -1.0
        s /= math.sqrt(nx * nx + ny * ny + nz * nz)
        nx, ny, nz = s * nx, s * ny, s * nz
        ax, ay, az = _column(table, k, PLACE // BLOCK)
        bx, by, bz = ax + dx, ay + dy, az + dz
        for n in range(1, 3):
            row = (i + n) % 3
            x, y, z = _column(table, k, 9 + 3 * row)
            s = table[(3 + row) * BLOCK + k]
            s = s if x * nx + y * ny + z * nz >= 0.0 else -s
            ax, ay, az = ax + s * x, ay + s * y, az + s * z
            row = (j + n) % 3
            x, y, z = _column(table, k, 18 + 3 * row)
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
        feature[at, 0] = (1 << 20) + (3 * j + i if swapped else 3 * i + j)  # 3 times the edge of a, and the edge of b
        points[at] = 1


@kernel
def _column(table, k, row):
    return table[row * BLOCK + k], table[(row + 1) * BLOCK + k], table[(row + 2) * BLOCK + k]
