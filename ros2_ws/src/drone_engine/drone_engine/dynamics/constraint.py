"""One contact constraint, in one lane of its group: apply impulses, update the separation, solve.

A constraint is solved as its points would be one after the other (Gauss-Seidel): the normal velocities of all points
are computed at once, each impulse changes those of the points after it through their couplings, and the bodies get the
sum. No branches, so that loops over lanes are vectorized. Argument names and units as in contact_table.py.
"""

import math
from typing import NamedTuple

from drone_engine.dynamics.contact_table import (
    ANCHOR,
    BASE_SEPARATION,
    CENTER_A,
    CENTER_B,
    DISPLACEMENT_A,
    DISPLACEMENT_B,
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
    L2,
    L3,
    LANES,
    NORMAL,
    NORMAL_IMPULSE,
    NORMAL_MASS,
    RESIDUAL,
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
    TWIST_IMPULSE,
    TWIST_MASS,
    TWIST_RADIUS,
    UNIFORM_MASS,
    UNIFORM_RESPONSE,
    VELOCITY_A,
    VELOCITY_B,
    at_anchors,
    cross,
    inverse_inertia_times,
    per_point,
    point_velocity,
    set_per_point,
    set_vector,
    vector,
)
from drone_engine.kernel import inlined

MAX_PUSH_VELOCITY = 0.8  # m/s, the fastest at which penetrating bodies are pushed apart
TINY = 1e-300  # N s, so that no impulse is divided by 0
TOLERANCE = 1e-5  # m/s: a rigid constraint has converged when no impulse changes a velocity by more


class Softness(NamedTuple):
    """Coefficients of a soft constraint (Catto 2011, Soft Constraints; named as in Box2D)."""

    bias_rate: float  # 1/s, velocity per m of penetration; 0 after bodies have moved (relaxation)
    mass_scale: float  # of the effective mass
    impulse_scale: float  # of the accumulated impulse, which is reduced by it
    inv_h: float  # 1/s, sub-steps per second


@inlined
def apply_impulses(t, v, k, q0, q1, q2, q3, tangent_1, tangent_2, twist):
    """Applies to both bodies impulses q (N s) along the normal at the points, along the tangents at the center of
    pressure (N s), and about the normal (N m s)."""
    px, py, pz = at_anchors(t, ANCHOR, k, q0, q1, q2, q3)
    rx, ry, rz = at_anchors(t, ANCHOR + L3, k, q0, q1, q2, q3)
    _apply(t, v, k, q0 + q1 + q2 + q3, px, py, pz, rx, ry, rz, tangent_1, tangent_2, twist)


@inlined
def _apply(t, v, k, q, px, py, pz, rx, ry, rz, tangent_1, tangent_2, twist):
    """The same, with q the sum of the normal impulses and p, r their sums over anchors of a and b (at_anchors)."""
    x, y, z = vector(t, NORMAL, k)
    fx = tangent_1 * t[TANGENT_1 + k] + tangent_2 * t[TANGENT_2 + k]
    fy = tangent_1 * t[TANGENT_1 + LANES + k] + tangent_2 * t[TANGENT_2 + LANES + k]
    fz = tangent_1 * t[TANGENT_1 + L2 + k] + tangent_2 * t[TANGENT_2 + L2 + k]
    ax, ay, az = _angular_change(t, INV_INERTIA_A, CENTER_A, k, x, y, z, px, py, pz, fx, fy, fz, twist)
    bx, by, bz = _angular_change(t, INV_INERTIA_B, CENTER_B, k, x, y, z, rx, ry, rz, fx, fy, fz, twist)
    fx, fy, fz = fx + q * x, fy + q * y, fz + q * z
    m, n = t[INV_MASS_A + k], t[INV_MASS_B + k]
    ux, uy, uz = vector(v, VELOCITY_A, k)
    set_vector(v, VELOCITY_A, k, ux - m * fx, uy - m * fy, uz - m * fz)
    wx, wy, wz = vector(v, VELOCITY_A + L3, k)
    set_vector(v, VELOCITY_A + L3, k, wx - ax, wy - ay, wz - az)
    ux, uy, uz = vector(v, VELOCITY_B, k)
    set_vector(v, VELOCITY_B, k, ux + n * fx, uy + n * fy, uz + n * fz)
    wx, wy, wz = vector(v, VELOCITY_B + L3, k)
    set_vector(v, VELOCITY_B + L3, k, wx + bx, wy + by, wz + bz)


@inlined
def _angular_change(t, inv_inertia, center, k, x, y, z, px, py, pz, fx, fy, fz, twist):
    """Change of angular velocity, rad/s, by normal impulses (their sum over anchors: p), a friction impulse f at the
    center of pressure, and a twist about the normal (x, y, z). Scalars only: a SIMD leaf."""
    nx, ny, nz = cross(px, py, pz, x, y, z)
    cx, cy, cz = vector(t, center, k)
    ux, uy, uz = cross(cx, cy, cz, fx, fy, fz)
    return inverse_inertia_times(t, inv_inertia, k, nx + ux + twist * x, ny + uy + twist * y, nz + uz + twist * z)


@inlined
def update_separation(t, v, k):
    """Updates the separation of each point from the displacement of the bodies since detection.

    An anchor r that rotates by R moves along the normal n by n . ((R - 1) r) = r . (n x v + f (v (n . v) - n v^2)),
    with v the rotation's axis times its sine and f = 1 / (1 + cosine).
    """
    x, y, z = vector(t, NORMAL, k)
    ax, ay, az = vector(v, DISPLACEMENT_A, k)
    bx, by, bz = vector(v, DISPLACEMENT_B, k)
    centers = x * (bx - ax) + y * (by - ay) + z * (bz - az)
    ax, ay, az = _rotated_normal(v, DISPLACEMENT_A + L3, k, x, y, z)
    bx, by, bz = _rotated_normal(v, DISPLACEMENT_B + L3, k, x, y, z)
    s0, s1, s2, s3 = per_point(t, BASE_SEPARATION, k)
    set_per_point(t, SEPARATION, k,
                  s0 + point_velocity(t, k, 0, centers, ax, ay, az, bx, by, bz),
                  s1 + point_velocity(t, k, 1, centers, ax, ay, az, bx, by, bz),
                  s2 + point_velocity(t, k, 2, centers, ax, ay, az, bx, by, bz),
                  s3 + point_velocity(t, k, 3, centers, ax, ay, az, bx, by, bz))


@inlined
def _rotated_normal(v, row, k, x, y, z):
    """n x v + f (v (n . v) - n v^2) of update_separation; row: of the rotation in v."""
    ux, uy, uz = vector(v, row, k)
    f = v[row + L3 + k]
    along, square = f * (x * ux + y * uy + z * uz), f * (ux * ux + uy * uy + uz * uz)
    cx, cy, cz = cross(x, y, z, ux, uy, uz)
    return cx + ux * along - x * square, cy + uy * along - y * square, cz + uz * along - z * square


@inlined
def solve_constraint(t, v, k, softness):
    """Solves the normal impulses, then friction with the limits that follow from them: one Gauss-Seidel iteration.

    Changes the impulses in t and the velocities in v, and writes the residual (0 or less: converged, or soft).
    """
    soft = t[SOFT + k]
    impulse_scale = softness.impulse_scale * soft
    mass_scale = 1.0 - (1.0 - softness.mass_scale) * soft
    bias_rate, inv_h = softness.bias_rate, softness.inv_h

    # Separation velocities of the points
    x, y, z = vector(t, NORMAL, k)
    ux, uy, uz = vector(v, VELOCITY_A, k)
    wax, way, waz = vector(v, VELOCITY_A + L3, k)
    dx, dy, dz = vector(v, VELOCITY_B, k)
    wbx, wby, wbz = vector(v, VELOCITY_B + L3, k)
    dx, dy, dz = dx - ux, dy - uy, dz - uz
    centers = x * dx + y * dy + z * dz
    ax, ay, az = cross(x, y, z, wax, way, waz)
    bx, by, bz = cross(x, y, z, wbx, wby, wbz)
    s0 = point_velocity(t, k, 0, centers, ax, ay, az, bx, by, bz)
    s1 = point_velocity(t, k, 1, centers, ax, ay, az, bx, by, bz)
    s2 = point_velocity(t, k, 2, centers, ax, ay, az, bx, by, bz)
    s3 = point_velocity(t, k, 3, centers, ax, ay, az, bx, by, bz)

    # A uniform impulse, if all points need one
    p0, p1, p2, p3 = per_point(t, NORMAL_IMPULSE, k)
    b0, b1 = _bias(t, k, 0, bias_rate, inv_h), _bias(t, k, 1, bias_rate, inv_h)
    b2, b3 = _bias(t, k, 2, bias_rate, inv_h), _bias(t, k, 3, bias_rate, inv_h)
    uniform = _uniform_impulse(t, k, _error(t, k, 0, p0, s0 + b0, bias_rate), _error(t, k, 1, p1, s1 + b1, bias_rate),
                               _error(t, k, 2, p2, s2 + b2, bias_rate), _error(t, k, 3, p3, s3 + b3, bias_rate))
    r0, r1, r2, r3 = per_point(t, UNIFORM_RESPONSE, k)
    s0, s1, s2, s3 = s0 + uniform * r0, s1 + uniform * r1, s2 + uniform * r2, s3 + uniform * r3
    m0, m1, m2, m3 = per_point(t, NORMAL_MASS, k)
    u0, u1 = uniform if m0 > 0.0 else 0.0, uniform if m1 > 0.0 else 0.0
    u2, u3 = uniform if m2 > 0.0 else 0.0, uniform if m3 > 0.0 else 0.0

    # Normal impulses, point by point
    n0 = _normal_impulse(t, k, 0, p0, u0, s0, b0, bias_rate, mass_scale, impulse_scale)
    q0 = n0 - p0
    d = q0 - u0
    s1, s2, s3 = s1 + t[K01 + k] * d, s2 + t[K02 + k] * d, s3 + t[K03 + k] * d
    n1 = _normal_impulse(t, k, 1, p1, u1, s1, b1, bias_rate, mass_scale, impulse_scale)
    q1 = n1 - p1
    d = q1 - u1
    s2, s3 = s2 + t[K12 + k] * d, s3 + t[K13 + k] * d
    n2 = _normal_impulse(t, k, 2, p2, u2, s2, b2, bias_rate, mass_scale, impulse_scale)
    q2 = n2 - p2
    s3 = s3 + t[K23 + k] * (q2 - u2)
    n3 = _normal_impulse(t, k, 3, p3, u3, s3, b3, bias_rate, mass_scale, impulse_scale)
    q3 = n3 - p3
    set_per_point(t, NORMAL_IMPULSE, k, n0, n1, n2, n3)
    v[RESIDUAL + k] = (1.0 - soft) * max(max(abs(q0) - TOLERANCE * m0, abs(q1) - TOLERANCE * m1),
                                         max(abs(q2) - TOLERANCE * m2, abs(q3) - TOLERANCE * m3))

    # Relative velocity at the center of pressure after the normal impulses
    q = q0 + q1 + q2 + q3
    px, py, pz = at_anchors(t, ANCHOR, k, q0, q1, q2, q3)
    rx, ry, rz = at_anchors(t, ANCHOR + L3, k, q0, q1, q2, q3)
    ax, ay, az = cross(px, py, pz, x, y, z)
    ax, ay, az = inverse_inertia_times(t, INV_INERTIA_A, k, ax, ay, az)
    bx, by, bz = cross(rx, ry, rz, x, y, z)
    bx, by, bz = inverse_inertia_times(t, INV_INERTIA_B, k, bx, by, bz)
    wax, way, waz, wbx, wby, wbz = wax - ax, way - ay, waz - az, wbx + bx, wby + by, wbz + bz
    f = (t[INV_MASS_A + k] + t[INV_MASS_B + k]) * q
    dx, dy, dz = dx + f * x, dy + f * y, dz + f * z
    cx, cy, cz = vector(t, CENTER_A, k)
    ax, ay, az = cross(wax, way, waz, cx, cy, cz)
    cx, cy, cz = vector(t, CENTER_B, k)
    bx, by, bz = cross(wbx, wby, wbz, cx, cy, cz)
    dx, dy, dz = dx - ax + bx, dy - ay + by, dz - az + bz

    # Friction that stops the sliding; where that exceeds Coulomb's limit, one of that size. A step along the sliding
    # velocity, by a mass that is a number, ends where friction opposes it; one by the mass matrix does not.
    limit = t[FRICTION + k] * (n0 + n1 + n2 + n3)
    tx, ty, tz = vector(t, TANGENT_1, k)
    u1 = dx * tx + dy * ty + dz * tz
    tx, ty, tz = vector(t, TANGENT_2, k)
    u2 = dx * tx + dy * ty + dz * tz
    f1, f2, twist = t[TANGENT_IMPULSE_1 + k], t[TANGENT_IMPULSE_2 + k], t[TWIST_IMPULSE + k]
    new_1 = f1 - (t[TANGENT_MASS_11 + k] * u1 + t[TANGENT_MASS_12 + k] * u2)
    new_2 = f2 - (t[TANGENT_MASS_12 + k] * u1 + t[TANGENT_MASS_22 + k] * u2)
    slides = new_1 * new_1 + new_2 * new_2 > limit * limit
    mass = t[SLIDING_MASS + k]
    slide_1, slide_2 = f1 - mass * u1, f2 - mass * u2
    scale = min(limit / (math.sqrt(slide_1 * slide_1 + slide_2 * slide_2) + TINY), 1.0)
    new_1, new_2 = scale * slide_1 if slides else new_1, scale * slide_2 if slides else new_2
    limit = limit * t[TWIST_RADIUS + k]
    new_twist = twist - t[TWIST_MASS + k] * (x * (wbx - wax) + y * (wby - way) + z * (wbz - waz))
    new_twist = min(max(new_twist, -limit), limit)
    t[TANGENT_IMPULSE_1 + k], t[TANGENT_IMPULSE_2 + k], t[TWIST_IMPULSE + k] = new_1, new_2, new_twist
    _apply(t, v, k, q, px, py, pz, rx, ry, rz, new_1 - f1, new_2 - f2, new_twist - twist)


@inlined
def _bias(t, k, p, bias_rate, inv_h):
    """The velocity that is added to that of point p, m/s: a positive separation may close within the sub-step, and no
    faster (speculative contact); a penetration is pushed apart."""
    separation = t[SEPARATION + p * LANES + k]
    push = max(bias_rate * separation, -MAX_PUSH_VELOCITY)
    return separation * inv_h if separation > 0.0 else push


@inlined
def _waits(t, k, p, impulse, bias_rate):
    """Whether point p takes no part: in relaxation, a point that is apart and has had no impulse. It will meet in the
    next sub-step, if at all."""
    return (t[SEPARATION + p * LANES + k] > 0.0) & (impulse == 0.0) & (bias_rate == 0.0)


@inlined
def _error(t, k, p, impulse, error, bias_rate):
    """The error of the velocity of point p, m/s: negative, if it needs an impulse."""
    return 1.0 if _waits(t, k, p, impulse, bias_rate) else error


@inlined
def _uniform_impulse(t, k, e0, e1, e2, e3):
    """The impulse that all points get first if all of them need one, N s at each, so that the order of the corners does
    not rotate a body that lands flat. e: velocity errors, negative where an impulse is needed."""
    m0, m1, m2, m3 = per_point(t, NORMAL_MASS, k)
    m0, m1, m2, m3 = m0 > 0.0, m1 > 0.0, m2 > 0.0, m3 > 0.0
    all_need = ((e0 < 0.0) | (not m0)) & ((e1 < 0.0) | (not m1)) & ((e2 < 0.0) | (not m2)) & ((e3 < 0.0) | (not m3))
    total = (e0 if m0 else 0.0) + (e1 if m1 else 0.0) + (e2 if m2 else 0.0) + (e3 if m3 else 0.0)
    return -total * t[UNIFORM_MASS + k] if all_need else 0.0


@inlined
def _normal_impulse(t, k, p, impulse, uniform, velocity, bias, bias_rate, mass_scale, impulse_scale):
    """The accumulated normal impulse of point p, N s, 0 or more. impulse: that before; uniform: what it has had since,
    with all others; velocity: separation velocity, m/s. Points that are apart are not soft."""
    mass = t[NORMAL_MASS + p * LANES + k]
    apart = t[SEPARATION + p * LANES + k] > 0.0
    soft = mass * mass_scale
    mass = mass if apart else soft
    mass = 0.0 if _waits(t, k, p, impulse, bias_rate) else mass
    kept = impulse - impulse_scale * impulse
    kept = (impulse if apart else kept) + uniform
    return max(kept - mass * (velocity + bias), 0.0)
