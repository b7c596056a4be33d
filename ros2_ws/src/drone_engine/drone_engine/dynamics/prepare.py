"""Preparation of the contact constraints, once a step: from manifolds and bodies to the solver's tables, and back."""

import math

from drone_engine.dynamics.contact_table import (
    ANCHOR,
    BASE_SEPARATION,
    CENTER_A,
    CENTER_B,
    FIELDS,
    FRICTION,
    INV_INERTIA_A,
    INV_INERTIA_B,
    INV_MASS_A,
    INV_MASS_B,
    K01,
    K02,
    K03,
    K12,
    K13,
    K23,
    L3,
    L6,
    LANES,
    NORMAL,
    NORMAL_IMPULSE,
    NORMAL_MASS,
    POINTS,
    RESTITUTION,
    RESTITUTION_VELOCITY,
    SEPARATION,
    SLIDING_MASS,
    SOFT,
    TANGENT_1,
    TANGENT_2,
    TANGENT_IMPULSE_1,
    TANGENT_IMPULSE_2,
    TANGENT_MASS_11,
    TANGENT_MASS_12,
    TANGENT_MASS_22,
    TOTAL_IMPULSE,
    TWIST_IMPULSE,
    TWIST_MASS,
    TWIST_RADIUS,
    UNIFORM_MASS,
    UNIFORM_RESPONSE,
    at_anchors,
    cross,
    inverse_inertia_times,
    lane_count,
    per_point,
    set_per_point,
    set_vector,
    vector,
)
from drone_engine.kernel import inlined, kernel
from drone_engine.math.rotation import matrix


@kernel
def write_inverse_inertia(i, orientation, inertia, out):
    """Writes the inverse inertia tensor of body i in the world frame, R diag(1 / I) R^T, 1 / (kg m^2).

    orientation: (n, 4) x y z w; inertia: (n, 3) principal moments, kg m^2. Out: out, (n, 6) xx xy xz yy yz zz.
    """
    m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
    x, y, z = 1.0 / inertia[i, 0], 1.0 / inertia[i, 1], 1.0 / inertia[i, 2]
    out[i, 0] = m[0] * m[0] * x + m[1] * m[1] * y + m[2] * m[2] * z
    out[i, 1] = m[0] * m[3] * x + m[1] * m[4] * y + m[2] * m[5] * z
    out[i, 2] = m[0] * m[6] * x + m[1] * m[7] * y + m[2] * m[8] * z
    out[i, 3] = m[3] * m[3] * x + m[4] * m[4] * y + m[5] * m[5] * z
    out[i, 4] = m[3] * m[6] * x + m[4] * m[7] * y + m[5] * m[8] * z
    out[i, 5] = m[6] * m[6] * x + m[7] * m[7] * y + m[8] * m[8] * z


@kernel
def prepare(groups, solver, contacts, inverse_mass, friction, restitution, fast, inverse_inertia):
    """Prepares the constraints of a step: copies manifolds and bodies into the groups' tables, and derives effective
    masses, couplings, tangents and the center of pressure from them.

    groups: how many there are; solver: SolverArrays, constraint in, body and table out; contacts: ContactArrays. Of the
    n bodies: inverse_mass (n,) 1/kg; friction, restitution (n,) coefficients, combined as the geometric mean and the
    greater one; fast (n,) whether their contacts are soft; inverse_inertia (n, 6) as write_inverse_inertia has it.
    """
    _copy(groups, solver, contacts, inverse_mass, friction, restitution, fast, inverse_inertia)
    lanes = lane_count(solver.table)
    for g in range(groups):
        t = solver.table[g]
        for k in range(lanes):
            _prepare_tangents(t, k)
        for k in range(lanes):
            _prepare_normals(t, k)
        for k in range(lanes):
            _prepare_center_of_pressure(t, k)
        for k in range(lanes):
            _prepare_friction(t, k)
        for k in range(POINTS * lanes):
            t[SEPARATION + k] = t[BASE_SEPARATION + k]
            t[TOTAL_IMPULSE + k] = t[RESTITUTION_VELOCITY + k] = 0.0


@kernel
def _copy(groups, solver, contacts, inverse_mass, friction, restitution, fast, inverse_inertia):
    """Fills the rows up to BASE_SEPARATION, SOFT, and the impulses for the warm start. The friction impulse is left as
    a vector in the rows from TANGENT_IMPULSE_1 on until the tangents are known."""
    dummy = solver.motion.shape[0] - 1
    for g in range(groups):
        t = solver.table[g]
        for k in range(LANES):
            number = solver.constraint[g, k]
            if number < 0:
                solver.body[g, 0, k] = solver.body[g, 1, k] = dummy
                for row in range(FIELDS):
                    t[row * LANES + k] = 0.0
                t[SOFT + k] = 1.0
                continue
            i, half = number >> 1, number & 1
            a, b = contacts.pair[i, 0], contacts.pair[i, 1]
            solver.body[g, 0, k], solver.body[g, 1, k] = a, b
            t[INV_MASS_A + k], t[INV_MASS_B + k] = inverse_mass[a], inverse_mass[b]
            t[FRICTION + k] = math.sqrt(friction[a] * friction[b])
            t[RESTITUTION + k] = max(restitution[a], restitution[b])
            t[SOFT + k] = 1.0 if fast[a] or fast[b] else 0.0
            set_vector(t, NORMAL, k, contacts.normal[i, 0], contacts.normal[i, 1], contacts.normal[i, 2])
            for c in range(6):
                t[INV_INERTIA_A + c * LANES + k] = inverse_inertia[a, c]
                t[INV_INERTIA_B + c * LANES + k] = inverse_inertia[b, c]
            for p in range(POINTS):
                q = half * POINTS + p
                exists = q < contacts.points[i]
                for c in range(3):
                    t[ANCHOR + p * L6 + c * LANES + k] = contacts.anchor[i, q, 0, c] if exists else 0.0
                    t[ANCHOR + p * L6 + L3 + c * LANES + k] = contacts.anchor[i, q, 1, c] if exists else 0.0
                t[BASE_SEPARATION + p * LANES + k] = contacts.separation[i, q] if exists else 0.0
                t[NORMAL_MASS + p * LANES + k] = 1.0 if exists else 0.0
                t[NORMAL_IMPULSE + p * LANES + k] = contacts.impulse[i, q] if exists else 0.0
            for c in range(4):
                t[TANGENT_IMPULSE_1 + c * LANES + k] = contacts.friction_impulse[i, half, c]


@inlined
def _prepare_tangents(t, k):
    """Two tangents that form an orthonormal basis with the normal (Duff et al. 2017, Building an Orthonormal Basis,
    Revisited), and the friction impulse of the last sub-step along them."""
    x, y, z = vector(t, NORMAL, k)
    sign = 1.0 if z >= 0.0 else -1.0
    s = -1.0 / (sign + z)
    c = x * y * s
    ux, uy, uz, vx, vy, vz = 1.0 + sign * x * x * s, sign * c, -sign * x, c, sign + y * y * s, -y
    set_vector(t, TANGENT_1, k, ux, uy, uz)
    set_vector(t, TANGENT_2, k, vx, vy, vz)
    fx, fy, fz = vector(t, TANGENT_IMPULSE_1, k)
    twist = t[TANGENT_IMPULSE_1 + L3 + k]
    t[TANGENT_IMPULSE_1 + k] = fx * ux + fy * uy + fz * uz
    t[TANGENT_IMPULSE_2 + k] = fx * vx + fy * vy + fz * vz
    t[TWIST_IMPULSE + k] = twist


@inlined
def _prepare_normals(t, k):
    """Effective masses of the points along the normal, their couplings, and the response to a uniform impulse."""
    inv_mass = t[INV_MASS_A + k] + t[INV_MASS_B + k]
    x, y, z = vector(t, NORMAL, k)
    m0, m1, m2, m3 = per_point(t, NORMAL_MASS, k)  # 1, or 0 for a point that does not exist
    k00, k11 = _normal_response(t, k, 0, 0, inv_mass, x, y, z), _normal_response(t, k, 1, 1, inv_mass, x, y, z)
    k22, k33 = _normal_response(t, k, 2, 2, inv_mass, x, y, z), _normal_response(t, k, 3, 3, inv_mass, x, y, z)
    set_per_point(t, NORMAL_MASS, k, m0 / k00 if k00 > 0.0 else 0.0, m1 / k11 if k11 > 0.0 else 0.0,
                  m2 / k22 if k22 > 0.0 else 0.0, m3 / k33 if k33 > 0.0 else 0.0)
    k01, k02 = _normal_response(t, k, 0, 1, inv_mass, x, y, z), _normal_response(t, k, 0, 2, inv_mass, x, y, z)
    k03, k12 = _normal_response(t, k, 0, 3, inv_mass, x, y, z), _normal_response(t, k, 1, 2, inv_mass, x, y, z)
    k13, k23 = _normal_response(t, k, 1, 3, inv_mass, x, y, z), _normal_response(t, k, 2, 3, inv_mass, x, y, z)
    t[K01 + k], t[K02 + k], t[K03 + k], t[K12 + k], t[K13 + k], t[K23 + k] = k01, k02, k03, k12, k13, k23
    r0 = k00 * m0 + k01 * m1 + k02 * m2 + k03 * m3
    r1 = k01 * m0 + k11 * m1 + k12 * m2 + k13 * m3
    r2 = k02 * m0 + k12 * m1 + k22 * m2 + k23 * m3
    r3 = k03 * m0 + k13 * m1 + k23 * m2 + k33 * m3
    set_per_point(t, UNIFORM_RESPONSE, k, r0, r1, r2, r3)
    total = r0 * m0 + r1 * m1 + r2 * m2 + r3 * m3
    t[UNIFORM_MASS + k] = 1.0 / total if total > 0.0 else 0.0


@inlined
def _normal_response(t, k, p, q, inv_mass, x, y, z):
    """Change of the normal velocity at point q per normal impulse at point p, 1/kg."""
    a, b = ANCHOR + p * L6, ANCHOR + q * L6
    ax, ay, az = vector(t, a, k)
    bx, by, bz = vector(t, b, k)
    cx, cy, cz = vector(t, a + L3, k)
    dx, dy, dz = vector(t, b + L3, k)
    return (inv_mass + _angular_response(t, INV_INERTIA_A, k, ax, ay, az, x, y, z, bx, by, bz, x, y, z)
            + _angular_response(t, INV_INERTIA_B, k, cx, cy, cz, x, y, z, dx, dy, dz, x, y, z))


@inlined
def _angular_response(t, row, k, rx, ry, rz, x, y, z, sx, sy, sz, u, v, w):
    """Change of the velocity along (u, v, w) at anchor s per impulse along (x, y, z) at anchor r, by the rotation of
    one body alone, 1/kg; row: INV_INERTIA_A or _B. As many parameters as there are vectors: a SIMD leaf of scalars."""
    lx, ly, lz = cross(rx, ry, rz, x, y, z)
    wx, wy, wz = inverse_inertia_times(t, row, k, lx, ly, lz)
    mx, my, mz = cross(sx, sy, sz, u, v, w)
    return wx * mx + wy * my + wz * mz


@inlined
def _prepare_center_of_pressure(t, k):
    """Mean of the anchors, weighted by the normal impulses of the last sub-step (equally if there are none), and the
    mean distance of the points from it."""
    m0, m1, m2, m3 = per_point(t, NORMAL_MASS, k)
    p0, p1, p2, p3 = per_point(t, NORMAL_IMPULSE, k)
    known = p0 + p1 + p2 + p3 > 0.0
    p0, p1 = p0 if known else 1.0 if m0 > 0.0 else 0.0, p1 if known else 1.0 if m1 > 0.0 else 0.0
    p2, p3 = p2 if known else 1.0 if m2 > 0.0 else 0.0, p3 if known else 1.0 if m3 > 0.0 else 0.0
    total = p0 + p1 + p2 + p3
    scale = 1.0 / total if total > 0.0 else 0.0
    p0, p1, p2, p3 = p0 * scale, p1 * scale, p2 * scale, p3 * scale
    cx, cy, cz = at_anchors(t, ANCHOR, k, p0, p1, p2, p3)
    set_vector(t, CENTER_A, k, cx, cy, cz)
    bx, by, bz = at_anchors(t, ANCHOR + L3, k, p0, p1, p2, p3)
    set_vector(t, CENTER_B, k, bx, by, bz)
    radius = 0.0
    radius += p0 * _anchor_distance(t, k, 0, cx, cy, cz)
    radius += p1 * _anchor_distance(t, k, 1, cx, cy, cz)
    radius += p2 * _anchor_distance(t, k, 2, cx, cy, cz)
    radius += p3 * _anchor_distance(t, k, 3, cx, cy, cz)
    t[TWIST_RADIUS + k] = radius


@inlined
def _anchor_distance(t, k, p, x, y, z):
    """Distance of point p from (x, y, z), both from the center of body a."""
    ax, ay, az = vector(t, ANCHOR + p * L6, k)
    x, y, z = ax - x, ay - y, az - z
    return math.sqrt(x * x + y * y + z * z)


@inlined
def _prepare_friction(t, k):
    """Inverse mass matrix of the tangents at the center of pressure, inverse of the mass matrix's greatest eigenvalue,
    and effective mass of the twist."""
    inv_mass = t[INV_MASS_A + k] + t[INV_MASS_B + k]
    x, y, z = vector(t, NORMAL, k)
    ux, uy, uz = vector(t, TANGENT_1, k)
    vx, vy, vz = vector(t, TANGENT_2, k)
    ax, ay, az = vector(t, CENTER_A, k)
    bx, by, bz = vector(t, CENTER_B, k)
    k11 = (inv_mass + _angular_response(t, INV_INERTIA_A, k, ax, ay, az, ux, uy, uz, ax, ay, az, ux, uy, uz)
           + _angular_response(t, INV_INERTIA_B, k, bx, by, bz, ux, uy, uz, bx, by, bz, ux, uy, uz))
    k12 = (_angular_response(t, INV_INERTIA_A, k, ax, ay, az, ux, uy, uz, ax, ay, az, vx, vy, vz)
           + _angular_response(t, INV_INERTIA_B, k, bx, by, bz, ux, uy, uz, bx, by, bz, vx, vy, vz))
    k22 = (inv_mass + _angular_response(t, INV_INERTIA_A, k, ax, ay, az, vx, vy, vz, ax, ay, az, vx, vy, vz)
           + _angular_response(t, INV_INERTIA_B, k, bx, by, bz, vx, vy, vz, bx, by, bz, vx, vy, vz))
    det = k11 * k22 - k12 * k12
    scale = 1.0 / det if det > 0.0 else 0.0
    t[TANGENT_MASS_11 + k], t[TANGENT_MASS_12 + k], t[TANGENT_MASS_22 + k] = k22 * scale, -k12 * scale, k11 * scale
    greatest = 0.5 * (k11 + k22) + math.sqrt(0.25 * (k11 - k22) * (k11 - k22) + k12 * k12)
    t[SLIDING_MASS + k] = 1.0 / greatest if greatest > 0.0 else 0.0
    ax, ay, az = inverse_inertia_times(t, INV_INERTIA_A, k, x, y, z)
    bx, by, bz = inverse_inertia_times(t, INV_INERTIA_B, k, x, y, z)
    response = x * (ax + bx) + y * (ay + by) + z * (az + bz)
    t[TWIST_MASS + k] = 1.0 / response if response > 0.0 else 0.0


@kernel
def store_impulses(groups, solver, contacts):
    """Writes the impulses of the last sub-step, for the next step's warm start, and the normal impulses of the whole
    step: contacts.impulse, friction_impulse and total."""
    for g in range(groups):
        t = solver.table[g]
        for k in range(LANES):
            number = solver.constraint[g, k]
            if number < 0:
                continue
            i, half = number >> 1, number & 1
            for c in range(3):
                contacts.friction_impulse[i, half, c] = (t[TANGENT_IMPULSE_1 + k] * t[TANGENT_1 + c * LANES + k]
                                                 + t[TANGENT_IMPULSE_2 + k] * t[TANGENT_2 + c * LANES + k])
            contacts.friction_impulse[i, half, 3] = t[TWIST_IMPULSE + k]
            for p in range(min(contacts.points[i] - half * POINTS, POINTS)):
                q = half * POINTS + p
                contacts.impulse[i, q] = t[NORMAL_IMPULSE + p * LANES + k]
                contacts.total[i, q] = t[TOTAL_IMPULSE + p * LANES + k]
