"""What the solver needs to know of each contact, worked out once a step.

A unit is up to POINTS points of a manifold, with friction at one point, the centre of their pressure, and a torque
about the normal beside it, instead of at every point (as Box3D does): a third of the work, and right where the pressure
is known from the step before. LANES units that share no moving body make a group, every number of all of them side by
side, so that the compiler takes them in one step: a table of FIELDS rows of LANES numbers.
"""

import math

import numpy as np

from drone_engine.kernel import inlined, kernel
from drone_engine.math.rotation import matrix

LANES = 8
POINTS = 4
# Rows of a group's table. First what is known of a unit: normal and tangents, inverse masses, friction, restitution,
# inverse inertia (xx xy xz yy yz zz) of a and b, anchors x y z from a and b of each point, gap as detected.
(NORMAL, ALONG, ACROSS, LIGHT_A, LIGHT_B, FRICTION, BOUNCE, INERTIA_A, INERTIA_B, ANCHOR, START) = (
    LANES * row for row in (0, 3, 6, 9, 10, 11, 12, 13, 19, 25, 49))
# Then what follows from it: the mass that each point feels, how an impulse at one point changes the speed at another;
# centre of pressure from a and b, how far the pressure is from it, inverse of the tangents' mass matrix, twist's mass.
MASS, K01, K02, K03, K12, K13, K23, CENTRE_A, CENTRE_B, RADIUS, MASS_11, MASS_12, MASS_22, TWIST_MASS = (
    LANES * row for row in (53, 57, 58, 59, 60, 61, 62, 63, 66, 69, 70, 71, 72, 73))
# Then what changes: gap now, impulse of the sub-step and of the step, the speed at which a bounce shall leave; impulses
# along the tangents and about the normal.
GAP, IMPULSE, TOTAL, THROWN, PUSHED_ALONG, PUSHED_ACROSS, TWISTED = (
    LANES * row for row in (74, 78, 82, 86, 90, 91, 92))
# Whether a unit is in a hurry, 1 or 0; and of those that are not, while their impulses are sought: the seven of a pass
# before, and the direction in which they go.
HURRY, BEFORE, DIRECTION = (LANES * row for row in (94, 95, 102))
# How one impulse at all points alike changes the speed at each, and what meets their speeds in sum.
ALIKE, COMMON = (LANES * row for row in (109, 113))
FIELDS = 114
COLOURS = 64  # as many as an integer has bits


@kernel
def inverse_inertia(i, orientation, inertia, out):
    """Writes the inverse inertia tensor of body i in the world, out: (n, 6): xx xy xz yy yz zz."""
    m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
    x, y, z = 1.0 / inertia[i, 0], 1.0 / inertia[i, 1], 1.0 / inertia[i, 2]
    out[i, 0] = m[0] * m[0] * x + m[1] * m[1] * y + m[2] * m[2] * z
    out[i, 1] = m[0] * m[3] * x + m[1] * m[4] * y + m[2] * m[5] * z
    out[i, 2] = m[0] * m[6] * x + m[1] * m[7] * y + m[2] * m[8] * z
    out[i, 3] = m[3] * m[3] * x + m[4] * m[4] * y + m[5] * m[5] * z
    out[i, 4] = m[3] * m[6] * x + m[4] * m[7] * y + m[5] * m[8] * z
    out[i, 5] = m[6] * m[6] * x + m[7] * m[7] * y + m[8] * m[8] * z


@kernel
def colour(count, pair, points, inverse_mass, used, size, colours):
    """Writes a colour for both units of each manifold, (m, 2), -1 where it has only one: units of one colour share no
    moving body, those of the last excepted. The first half of them are of two moving bodies, the second of one, which
    are met last: what stands on the ground is held by it. used: (n, 2) scratch, 0; size: (COLOURS,) units of each."""
    size[:] = 0
    for i in range(count):
        a, b = pair[i, 0], pair[i, 1]
        moves_a, moves_b = inverse_mass[a] > 0.0, inverse_mass[b] > 0.0
        half = 0 if moves_a and moves_b else 1
        first = half * COLOURS // 2
        for unit in range(2):
            colours[i, unit] = -1
            if unit == 0 or points[i] > POINTS:
                taken = (used[a, half] if moves_a else 0) | (used[b, half] if moves_b else 0)
                which = 0
                while which < COLOURS // 2 - 1 and taken >> which & 1:
                    which += 1
                if moves_a:
                    used[a, half] |= 1 << which
                if moves_b:
                    used[b, half] |= 1 << which
                colours[i, unit] = first + which
                size[first + which] += 1
    for i in range(count):
        for body in range(2):
            used[pair[i, body], 0] = used[pair[i, body], 1] = 0


@kernel
def group(count, colours, size, place, unit):
    """Writes which unit stands where, (g, LANES): twice its manifold, and 1 if it is the second; -1 for none. Returns
    how many groups there are, or how many more than unit has room for. place: (COLOURS,) scratch."""
    groups = 0
    for which in range(COLOURS):
        place[which] = groups * LANES
        alone = which % (COLOURS // 2) == COLOURS // 2 - 1  # these may share bodies: a group for each
        groups += size[which] if alone else (size[which] + LANES - 1) // LANES
    if groups > unit.shape[0]:
        return groups
    unit[:groups] = -1
    for i in range(count):
        for half in range(2):
            which = colours[i, half]
            if which >= 0:
                at = place[which]
                unit[at // LANES, at % LANES] = 2 * i + half
                place[which] += LANES if which % (COLOURS // 2) == COLOURS // 2 - 1 else 1
    return groups


@kernel
def enter(groups, unit, nobody, pair, points, normal, anchor, separation, impulse, friction, inverse_mass, tensor,
          rough, springy, hurried, body, table):
    """Writes what is known of each unit into the groups' tables (g, FIELDS * LANES), and its bodies, (g, 2, LANES);
    those of an empty lane are `nobody`. anchor: from the centres of a and b to each point, world; friction: (m, 2, 4)
    the impulse of the last sub-step, world, and its twist; tensor: (n, 6), zero for what does not move; rough, springy:
    (n,) coefficients of friction (of a pair the geometric mean) and restitution (of a pair the greater); hurried: (n,)
    whether a body is."""
    for g in range(groups):
        t = table[g]
        for k in range(LANES):
            if unit[g, k] < 0:
                body[g, 0, k] = body[g, 1, k] = nobody
                for row in range(FIELDS):
                    t[row * LANES + k] = 0.0
                t[HURRY + k] = 1.0
                continue
            i, half = unit[g, k] >> 1, unit[g, k] & 1
            a, b = pair[i, 0], pair[i, 1]
            body[g, 0, k], body[g, 1, k] = a, b
            t[LIGHT_A + k], t[LIGHT_B + k] = inverse_mass[a], inverse_mass[b]
            t[FRICTION + k], t[BOUNCE + k] = math.sqrt(rough[a] * rough[b]), max(springy[a], springy[b])
            t[HURRY + k] = 1.0 if hurried[a] or hurried[b] else 0.0
            for c in range(3):
                t[NORMAL + c * LANES + k] = normal[i, c]
            for c in range(6):
                t[INERTIA_A + c * LANES + k], t[INERTIA_B + c * LANES + k] = tensor[a, c], tensor[b, c]
            for p in range(POINTS):
                q = half * POINTS + p
                here = q < points[i]
                for c in range(3):
                    t[ANCHOR + (6 * p + c) * LANES + k] = anchor[i, q, 0, c] if here else 0.0
                    t[ANCHOR + (6 * p + 3 + c) * LANES + k] = anchor[i, q, 1, c] if here else 0.0
                t[START + p * LANES + k] = separation[i, q] if here else 0.0
                t[MASS + p * LANES + k] = 1.0 if here else 0.0
                t[IMPULSE + p * LANES + k] = impulse[i, q] if here else 0.0
            for c in range(4):  # as a vector, until the tangents are known
                t[PUSHED_ALONG + c * LANES + k] = friction[i, half, c]


@inlined
def turn(t, at, k, x, y, z):
    """The change of angular velocity that a vector of angular momentum gives; at: INERTIA_A or INERTIA_B."""
    return (t[at + k] * x + t[at + LANES + k] * y + t[at + 2 * LANES + k] * z,
            t[at + LANES + k] * x + t[at + 3 * LANES + k] * y + t[at + 4 * LANES + k] * z,
            t[at + 2 * LANES + k] * x + t[at + 4 * LANES + k] * y + t[at + 5 * LANES + k] * z)


@inlined
def coupling(t, at, k, rx, ry, rz, x, y, z, sx, sy, sz, u, v, w):
    """How an impulse along (x, y, z) at r changes the speed along (u, v, w) at s of a body by turning it."""
    tx, ty, tz = turn(t, at, k, ry * z - rz * y, rz * x - rx * z, rx * y - ry * x)
    return tx * (sy * w - sz * v) + ty * (sz * u - sx * w) + tz * (sx * v - sy * u)


@inlined
def _feel(t, k, p, q, light, x, y, z):
    """How an impulse along the normal at point p changes the speed at point q."""
    a, b = ANCHOR + 6 * LANES * p + k, ANCHOR + 6 * LANES * q + k
    return (light
            + coupling(t, INERTIA_A, k, t[a], t[a + LANES], t[a + 2 * LANES], x, y, z,
                       t[b], t[b + LANES], t[b + 2 * LANES], x, y, z)
            + coupling(t, INERTIA_B, k, t[a + 3 * LANES], t[a + 4 * LANES], t[a + 5 * LANES], x, y, z,
                       t[b + 3 * LANES], t[b + 4 * LANES], t[b + 5 * LANES], x, y, z))


@kernel
def work_out(groups, table):
    """Writes what follows from what is known."""
    lanes = table.shape[1] // FIELDS  # not the constant: the compiler would write out each lane
    for g in range(groups):
        t = table[g]
        for k in range(lanes):
            x, y, z = t[k], t[LANES + k], t[2 * LANES + k]
            # Tangents: Duff et al. 2017, Building an Orthonormal Basis, Revisited
            sign = 1.0 if z >= 0.0 else -1.0
            s = -1.0 / (sign + z)
            c = x * y * s
            ux, uy, uz, vx, vy, vz = 1.0 + sign * x * x * s, sign * c, -sign * x, c, sign + y * y * s, -y
            t[ALONG + k], t[ALONG + LANES + k], t[ALONG + 2 * LANES + k] = ux, uy, uz
            t[ACROSS + k], t[ACROSS + LANES + k], t[ACROSS + 2 * LANES + k] = vx, vy, vz
            fx, fy, fz = t[PUSHED_ALONG + k], t[PUSHED_ACROSS + k], t[TWISTED + k]
            w = t[TWISTED + LANES + k]
            t[PUSHED_ALONG + k], t[PUSHED_ACROSS + k] = fx * ux + fy * uy + fz * uz, fx * vx + fy * vy + fz * vz
            t[TWISTED + k] = w
        for k in range(lanes):
            light = t[LIGHT_A + k] + t[LIGHT_B + k]
            x, y, z = t[k], t[LANES + k], t[2 * LANES + k]
            m0, m1 = t[MASS + k], t[MASS + LANES + k]
            m2, m3 = t[MASS + 2 * LANES + k], t[MASS + 3 * LANES + k]
            k0, k1 = _feel(t, k, 0, 0, light, x, y, z), _feel(t, k, 1, 1, light, x, y, z)
            k2, k3 = _feel(t, k, 2, 2, light, x, y, z), _feel(t, k, 3, 3, light, x, y, z)
            t[MASS + k] = m0 / k0 if k0 > 0.0 else 0.0
            t[MASS + LANES + k] = m1 / k1 if k1 > 0.0 else 0.0
            t[MASS + 2 * LANES + k] = m2 / k2 if k2 > 0.0 else 0.0
            t[MASS + 3 * LANES + k] = m3 / k3 if k3 > 0.0 else 0.0
            t[K01 + k], t[K02 + k], t[K03 + k] = (_feel(t, k, 0, 1, light, x, y, z), _feel(t, k, 0, 2, light, x, y, z),
                                                  _feel(t, k, 0, 3, light, x, y, z))
            t[K12 + k], t[K13 + k], t[K23 + k] = (_feel(t, k, 1, 2, light, x, y, z), _feel(t, k, 1, 3, light, x, y, z),
                                                  _feel(t, k, 2, 3, light, x, y, z))
            r0 = k0 * m0 + t[K01 + k] * m1 + t[K02 + k] * m2 + t[K03 + k] * m3
            r1 = t[K01 + k] * m0 + k1 * m1 + t[K12 + k] * m2 + t[K13 + k] * m3
            r2 = t[K02 + k] * m0 + t[K12 + k] * m1 + k2 * m2 + t[K23 + k] * m3
            r3 = t[K03 + k] * m0 + t[K13 + k] * m1 + t[K23 + k] * m2 + k3 * m3
            t[ALIKE + k], t[ALIKE + LANES + k], t[ALIKE + 2 * LANES + k], t[ALIKE + 3 * LANES + k] = r0, r1, r2, r3
            total = r0 * m0 + r1 * m1 + r2 * m2 + r3 * m3
            t[COMMON + k] = 1.0 / total if total > 0.0 else 0.0
        for k in range(lanes):
            p0, p1 = t[IMPULSE + k], t[IMPULSE + LANES + k]
            p2, p3 = t[IMPULSE + 2 * LANES + k], t[IMPULSE + 3 * LANES + k]
            m0, m1 = t[MASS + k], t[MASS + LANES + k]
            m2, m3 = t[MASS + 2 * LANES + k], t[MASS + 3 * LANES + k]
            pressed = p0 + p1 + p2 + p3
            known = pressed > 0.0  # else all points count alike
            p0, p1 = p0 if known else 1.0 if m0 > 0.0 else 0.0, p1 if known else 1.0 if m1 > 0.0 else 0.0
            p2, p3 = p2 if known else 1.0 if m2 > 0.0 else 0.0, p3 if known else 1.0 if m3 > 0.0 else 0.0
            total = p0 + p1 + p2 + p3
            per = 1.0 / total if total > 0.0 else 0.0
            p0, p1, p2, p3 = p0 * per, p1 * per, p2 * per, p3 * per
            a = ANCHOR + k
            for c in range(6):
                t[CENTRE_A + c * LANES + k] = (
                    p0 * t[a + c * LANES] + p1 * t[a + (6 + c) * LANES] + p2 * t[a + (12 + c) * LANES]
                    + p3 * t[a + (18 + c) * LANES])
            radius = 0.0
            cx, cy, cz = t[CENTRE_A + k], t[CENTRE_A + LANES + k], t[CENTRE_A + 2 * LANES + k]
            radius += p0 * _length(t[a] - cx, t[a + LANES] - cy, t[a + 2 * LANES] - cz)
            radius += p1 * _length(t[a + 6 * LANES] - cx, t[a + 7 * LANES] - cy, t[a + 8 * LANES] - cz)
            radius += p2 * _length(t[a + 12 * LANES] - cx, t[a + 13 * LANES] - cy, t[a + 14 * LANES] - cz)
            radius += p3 * _length(t[a + 18 * LANES] - cx, t[a + 19 * LANES] - cy, t[a + 20 * LANES] - cz)
            t[RADIUS + k] = radius
        for k in range(lanes):
            light = t[LIGHT_A + k] + t[LIGHT_B + k]
            x, y, z = t[k], t[LANES + k], t[2 * LANES + k]
            ux, uy, uz = t[ALONG + k], t[ALONG + LANES + k], t[ALONG + 2 * LANES + k]
            vx, vy, vz = t[ACROSS + k], t[ACROSS + LANES + k], t[ACROSS + 2 * LANES + k]
            ax, ay, az = t[CENTRE_A + k], t[CENTRE_A + LANES + k], t[CENTRE_A + 2 * LANES + k]
            bx, by, bz = t[CENTRE_B + k], t[CENTRE_B + LANES + k], t[CENTRE_B + 2 * LANES + k]
            k11 = (light + coupling(t, INERTIA_A, k, ax, ay, az, ux, uy, uz, ax, ay, az, ux, uy, uz)
                   + coupling(t, INERTIA_B, k, bx, by, bz, ux, uy, uz, bx, by, bz, ux, uy, uz))
            k12 = (coupling(t, INERTIA_A, k, ax, ay, az, ux, uy, uz, ax, ay, az, vx, vy, vz)
                   + coupling(t, INERTIA_B, k, bx, by, bz, ux, uy, uz, bx, by, bz, vx, vy, vz))
            k22 = (light + coupling(t, INERTIA_A, k, ax, ay, az, vx, vy, vz, ax, ay, az, vx, vy, vz)
                   + coupling(t, INERTIA_B, k, bx, by, bz, vx, vy, vz, bx, by, bz, vx, vy, vz))
            det = k11 * k22 - k12 * k12
            per = 1.0 / det if det > 0.0 else 0.0
            t[MASS_11 + k], t[MASS_12 + k], t[MASS_22 + k] = k22 * per, -k12 * per, k11 * per
            px, py, pz = turn(t, INERTIA_A, k, x, y, z)
            qx, qy, qz = turn(t, INERTIA_B, k, x, y, z)
            felt = x * (px + qx) + y * (py + qy) + z * (pz + qz)
            t[TWIST_MASS + k] = 1.0 / felt if felt > 0.0 else 0.0
        for k in range(POINTS * lanes):
            t[GAP + k] = t[START + k]
            t[TOTAL + k] = t[THROWN + k] = 0.0


@inlined
def _length(x, y, z):
    return math.sqrt(x * x + y * y + z * z)


@kernel
def take_back(groups, unit, points, table, impulse, friction, total):
    """Writes the impulses to the manifolds: those of the last sub-step, and the sums of the step along the normals."""
    for g in range(groups):
        t = table[g]
        for k in range(LANES):
            if unit[g, k] < 0:
                continue
            i, half = unit[g, k] >> 1, unit[g, k] & 1
            for c in range(3):
                friction[i, half, c] = (t[PUSHED_ALONG + k] * t[ALONG + c * LANES + k]
                                        + t[PUSHED_ACROSS + k] * t[ACROSS + c * LANES + k])
            friction[i, half, 3] = t[TWISTED + k]
            for p in range(min(points[i] - half * POINTS, POINTS)):
                q = half * POINTS + p
                impulse[i, q], total[i, q] = t[IMPULSE + p * LANES + k], t[TOTAL + p * LANES + k]


def tables(groups: int) -> tuple[np.ndarray, ...]:
    """Room for so many groups: unit, body, table."""
    return (np.empty((groups, LANES), np.int64), np.empty((groups, 2, LANES), np.int64),
            np.zeros((groups, FIELDS * LANES)))  # also where no contact is: what lies there is reckoned with
