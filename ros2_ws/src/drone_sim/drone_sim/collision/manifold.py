"""Contacts: for each pair that touches or nearly does, a normal and up to eight points, and how boxes come to them."""

import numpy as np

from drone_sim.arrays import Floats, Integers
from drone_sim.kernel import kernel

POINTS = 8  # of a manifold, at most
HAIR = 1e-9  # of a face's size
STEEP = 1e-100  # m, m2: what is shorter or smaller than this is cut nowhere
SAME_SIDE = 0.9  # cosine of the angle up to which a contact is still that of the step before


class Manifolds:
    """Contacts between bodies a < b: those of boxes, spheres and floors, then those of meshes, of which a pair may have
    several, then those of fast bodies; each part in the order of (a, b). Beyond `points[i]` points of manifold i hold
    nothing."""

    def __init__(self, capacity: int) -> None:
        self.count = 0
        self.mesh_start = 0  # the first manifold of meshes
        self.swept_start = 0  # the first one that was found ahead, where fast bodies will meet within the step
        self.pair: Integers = np.empty((capacity, 2), np.int64)  # a, b
        self.level: Integers = np.empty(capacity, np.int64)  # at which the two met
        self.points: Integers = np.empty(capacity, np.int64)  # how many
        self.normal_w: Floats = np.empty((capacity, 3))  # unit, from a to b
        self.point_w: Floats = np.empty((capacity, POINTS, 3))  # m, midway between the surfaces
        self.anchor_w: Floats = np.empty((capacity, POINTS, 2, 3))  # m, from the centres of a and b, as the step starts
        self.separation: Floats = np.empty((capacity, POINTS))  # m, negative where they overlap
        self.feature: Integers = np.empty((capacity, POINTS), np.int64)  # names a point from step to step
        self.impulse: Floats = np.empty((capacity, POINTS, 3))  # N s: along the normal and two tangents, per sub-step
        self.total: Floats = np.empty((capacity, POINTS))  # N s: along the normal, in the whole step

    @property
    def capacity(self) -> int:
        return len(self.points)

    def empty(self) -> None:
        """Forgets all contacts."""
        self.count = self.mesh_start = self.swept_start = 0

    def with_room(self, more: int) -> "Manifolds":
        """These, or a larger copy that holds so many more."""
        if self.count + more <= self.capacity:
            return self
        larger = Manifolds(2 * (self.count + more))
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                getattr(larger, name)[: self.count] = value[: self.count]
            else:
                setattr(larger, name, value)
        return larger

    def start_from(self, old: "Manifolds") -> None:
        """Takes over the impulses of the step before where a contact goes on."""
        self.impulse[self.swept_start : self.count] = 0.0
        for first, count, old_first, old_count in (
                (0, self.mesh_start, 0, old.mesh_start),
                (self.mesh_start, self.swept_start, old.mesh_start, old.swept_start)):
            if count > first:
                carry_over(first, count, self.pair, self.points, self.normal_w, self.feature, self.impulse,
                           old_first, old_count, old.pair, old.points, old.normal_w, old.feature, old.impulse)


@kernel
def anchor(count, pair, points, point, position, anchors):
    """Writes for the points of all manifolds where they are from the centres of the two bodies."""
    for i in range(count):
        for k in range(points[i]):
            for side in range(2):
                for c in range(3):
                    anchors[i, k, side, c] = point[i, k, c] - position[pair[i, side], c]


@kernel
def carry_over(first, count, pair, points, normal, feature, impulse, old_first, old_count, old_pair, old_points,
               old_normal, old_feature, old_impulse):
    """Starts each point of manifolds first to count with the impulses that the point of the same pair and feature, and
    of nearly the same normal, ended the last step with. Both stand in the order of their pairs."""
    old = old_first
    for i in range(first, count):
        a, b = pair[i, 0], pair[i, 1]
        while old < old_count and (old_pair[old, 0] < a or (old_pair[old, 0] == a and old_pair[old, 1] < b)):
            old += 1
        for k in range(points[i]):
            impulse[i, k, 0] = impulse[i, k, 1] = impulse[i, k, 2] = 0.0
        known = old
        while known < old_count and old_pair[known, 0] == a and old_pair[known, 1] == b:
            if (normal[i, 0] * old_normal[known, 0] + normal[i, 1] * old_normal[known, 1]
                    + normal[i, 2] * old_normal[known, 2]) > SAME_SIDE:
                for k in range(points[i]):
                    for m in range(old_points[known]):
                        if old_feature[known, m] == feature[i, k]:
                            for c in range(3):
                                impulse[i, k, c] = old_impulse[known, m, c]
                            break
            known += 1


@kernel
def clip(box, r, o, face, side, margin, depth, of_b, point, separation, feature):
    """Clips the face of box o that looks most against a face of box r to the latter; returns the number of points.

    box: (2, 15), each centre, axes, half extents, seen from where the points are wanted. side: 1 or -1, of the face.
    depth: separation along the face's normal, m. of_b: whether r is b of the pair, for the features.
    """
    u, v = (face + 1) % 3, (face + 2) % 3
    incident, most, sign = 0, -1.0, 1.0
    for k in range(3):
        facing = side * _dot(box, r, face, box[o, 3 + 3 * k], box[o, 4 + 3 * k], box[o, 5 + 3 * k])
        if abs(facing) > most:
            incident, most, sign = k, abs(facing), -1.0 if facing > 0.0 else 1.0
    p, q = (incident + 1) % 3, (incident + 2) % 3
    # Of the incident face in the frame of the reference face (u, v along it, w above it): the middle, half its edges.
    mid = sign * box[o, 12 + incident]
    x, y, z = box[o, 0] - box[r, 0], box[o, 1] - box[r, 1], box[o, 2] - box[r, 2]
    x, y, z = (x + mid * box[o, 3 + 3 * incident], y + mid * box[o, 4 + 3 * incident],
               z + mid * box[o, 5 + 3 * incident])
    cu, cv, cw = _dot(box, r, u, x, y, z), _dot(box, r, v, x, y, z), side * _dot(box, r, face, x, y, z)
    x, y, z, h = box[o, 3 + 3 * p], box[o, 4 + 3 * p], box[o, 5 + 3 * p], box[o, 12 + p]
    pu, pv, pw = h * _dot(box, r, u, x, y, z), h * _dot(box, r, v, x, y, z), side * h * _dot(box, r, face, x, y, z)
    x, y, z, h = box[o, 3 + 3 * q], box[o, 4 + 3 * q], box[o, 5 + 3 * q], box[o, 12 + q]
    qu, qv, qw = h * _dot(box, r, u, x, y, z), h * _dot(box, r, v, x, y, z), side * h * _dot(box, r, face, x, y, z)
    cw -= box[r, 12 + face]
    # The reference face is a hair larger, so that equal faces on each other do not give every corner twice.
    hair = HAIR * (box[r, 12 + u] + box[r, 12 + v])
    limit_u, limit_v = box[r, 12 + u] + hair, box[r, 12 + v] + hair
    name = ((3 if of_b else 0) + face) * 3 + incident << 6
    found = 0
    inside = 0
    for corner in range(4):  # a bit each: which end of p, which end of q
        s, t = 1.0 if corner & 1 else -1.0, 1.0 if corner & 2 else -1.0
        a, b = cu + s * pu + t * qu, cv + s * pv + t * qv
        if abs(a) <= limit_u and abs(b) <= limit_v:
            inside |= 1 << corner
            found = _put(found, a, b, cw + s * pw + t * qw, margin, name + corner, point, separation, feature)
    if inside != 15:
        for edge in range(4):  # two along p, then two along q
            if edge < 2:
                t = 1.0 if edge == 1 else -1.0
                start, end = inside >> 2 * edge & 1, inside >> 2 * edge + 1 & 1
                a, b, c, eu, ev, ew = cu + t * qu, cv + t * qv, cw + t * qw, pu, pv, pw
            else:
                t = 1.0 if edge == 3 else -1.0
                start, end = inside >> edge - 2 & 1, inside >> edge & 1
                a, b, c, eu, ev, ew = cu + t * pu, cv + t * pv, cw + t * pw, qu, qv, qw
            if start and end:
                continue
            per_u = 1.0 / eu if abs(eu) > STEEP else 1.0 / STEEP
            per_v = 1.0 / ev if abs(ev) > STEEP else 1.0 / STEEP
            middle_u, middle_v, reach_u, reach_v = -a * per_u, -b * per_v, limit_u * abs(per_u), limit_v * abs(per_v)
            enter, leave = max(middle_u - reach_u, middle_v - reach_v), min(middle_u + reach_u, middle_v + reach_v)
            if not start and -1.0 < enter < 1.0 and enter < leave:
                plane = 0 if middle_u - reach_u >= middle_v - reach_v else 1
                found = _put(found, a + enter * eu, b + enter * ev, c + enter * ew, margin,
                             name + 8 + 4 * edge + 2 * plane, point, separation, feature)
            if not end and -1.0 < leave < 1.0 and enter < leave:
                plane = 0 if middle_u + reach_u <= middle_v + reach_v else 1
                found = _put(found, a + leave * eu, b + leave * ev, c + leave * ew, margin,
                             name + 9 + 4 * edge + 2 * plane, point, separation, feature)
        area = pu * qv - pv * qu
        if abs(area) > STEEP:
            per = 1.0 / area
            for corner in range(4):  # of the reference face, above or below the incident face
                a, b = limit_u if corner & 1 else -limit_u, limit_v if corner & 2 else -limit_v
                s, t = ((a - cu) * qv - (b - cv) * qu) * per, ((b - cv) * pu - (a - cu) * pv) * per
                if abs(s) < 1.0 and abs(t) < 1.0:
                    found = _put(found, a, b, cw + s * pw + t * qw, margin, name + 4 + corner, point, separation,
                                 feature)
    if found == 0 and depth <= hair:  # they overlap beside the incident face: its corner that is deepest
        s, t = 1.0 if pw < 0.0 else -1.0, 1.0 if qw < 0.0 else -1.0
        corner = (1 if s > 0.0 else 0) + (2 if t > 0.0 else 0)
        found = _put(0, cu + s * pu + t * qu, cv + s * pv + t * qv, depth, np.inf, name + corner, point, separation,
                     feature)
    for k in range(found):
        a, b, c = point[k, 0], point[k, 1], side * (box[r, 12 + face] + 0.5 * separation[k])
        for i in range(3):
            point[k, i] = (box[r, i] + a * box[r, 3 + 3 * u + i] + b * box[r, 3 + 3 * v + i]
                           + c * box[r, 3 + 3 * face + i])
    return found


@kernel
def _put(found, a, b, s, margin, name, point, separation, feature):
    if s > margin or found == POINTS:
        return found
    point[found, 0], point[found, 1], separation[found], feature[found] = a, b, s, name
    return found + 1


@kernel
def _dot(box, r, k, x, y, z):
    return box[r, 3 + 3 * k] * x + box[r, 4 + 3 * k] * y + box[r, 5 + 3 * k] * z


@kernel
def cross_edges(box, i, j, nx, ny, nz, point):
    """Writes the point midway between edge i of box 0 and edge j of box 1, those that face each other along n."""
    ends = (box[0, 0], box[0, 1], box[0, 2], box[1, 0], box[1, 1], box[1, 2])
    ax, ay, az, bx, by, bz = ends
    for k in range(3):
        if k != i:
            s = box[0, 12 + k] if _dot(box, 0, k, nx, ny, nz) >= 0.0 else -box[0, 12 + k]
            ax, ay, az = ax + s * box[0, 3 + 3 * k], ay + s * box[0, 4 + 3 * k], az + s * box[0, 5 + 3 * k]
        if k != j:
            s = -box[1, 12 + k] if _dot(box, 1, k, nx, ny, nz) >= 0.0 else box[1, 12 + k]
            bx, by, bz = bx + s * box[1, 3 + 3 * k], by + s * box[1, 4 + 3 * k], bz + s * box[1, 5 + 3 * k]
    # Closest points of two lines (Ericson 2005, Real-Time Collision Detection, 5.1.8); unit directions, not parallel.
    cosine = _dot(box, 0, i, box[1, 3 + 3 * j], box[1, 4 + 3 * j], box[1, 5 + 3 * j])
    wx, wy, wz = ax - bx, ay - by, az - bz
    c, f = _dot(box, 0, i, wx, wy, wz), _dot(box, 1, j, wx, wy, wz)
    divisor = 1.0 - cosine * cosine
    s = min(max((cosine * f - c) / divisor, -box[0, 12 + i]), box[0, 12 + i])
    t = min(max((f - cosine * c) / divisor, -box[1, 12 + j]), box[1, 12 + j])
    point[0, 0] = 0.5 * (ax + s * box[0, 3 + 3 * i] + bx + t * box[1, 3 + 3 * j])
    point[0, 1] = 0.5 * (ay + s * box[0, 4 + 3 * i] + by + t * box[1, 4 + 3 * j])
    point[0, 2] = 0.5 * (az + s * box[0, 5 + 3 * i] + bz + t * box[1, 5 + 3 * j])
