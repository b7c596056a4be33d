"""What the solver needs to know of each contact, worked out once a step.

For every point a row of ROW numbers, for every manifold a head of HEAD numbers: what does not change in the step, and
the impulses that do. Friction acts at one point of a manifold, the centre of its pressure, with a torque about the
normal beside it, instead of at every point (as box3d does): a third of the work, and right where the pressure is known
from the step before.
"""

import math

from drone_sim.kernel import kernel
from drone_sim.rotation import matrix

# Of a row: how an impulse along the normal turns a and b (lever arms and the turn they get), the mass it feels, the
# gap as detected and as it is now, the impulse of the sub-step and of the step, and its speed before the sub-step.
ARM_A, ARM_B, TURN_A, TURN_B, MASS, START, GAP, IMPULSE, TOTAL, SPEED = 0, 3, 6, 9, 12, 13, 14, 15, 16, 17
ROW = 18
# Of a head: normal and tangents, inverse masses, friction; then the same as in a row of both tangents and of the
# twist, which has arms of the normal itself; the inverse of the tangents' mass matrix, the twist's mass, impulses.
NORMAL, ALONG, ACROSS, LIGHT_A, LIGHT_B, FRICTION, BOUNCE = 0, 3, 6, 9, 10, 11, 12
ALONG_A, ALONG_B, ALONG_TURN_A, ALONG_TURN_B = 13, 16, 19, 22
ACROSS_A, ACROSS_B, ACROSS_TURN_A, ACROSS_TURN_B = 25, 28, 31, 34
TWIST_A, TWIST_B, MASS_11, MASS_12, MASS_22, TWIST_MASS, RADIUS = 37, 40, 43, 44, 45, 46, 47
PUSHED_ALONG, PUSHED_ACROSS, TWISTED = 48, 49, 50
HEAD = 52


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
def tangents(x, y, z):
    """Two unit vectors that make a right-handed frame with the unit vector (Duff et al. 2017, Building an
    Orthonormal Basis, Revisited)."""
    sign = 1.0 if z >= 0.0 else -1.0
    a = -1.0 / (sign + z)
    b = x * y * a
    return 1.0 + sign * x * x * a, sign * b, -sign * x, b, sign + y * y * a, -y


@kernel
def _arm(out, arm, turn, rx, ry, rz, x, y, z, tensor, i):
    """Writes r x (x, y, z) at out[arm] and what it turns body i by at out[turn]; returns their product."""
    ax, ay, az = ry * z - rz * y, rz * x - rx * z, rx * y - ry * x
    return _turn(out, arm, turn, ax, ay, az, tensor, i)


@kernel
def _turn(out, arm, turn, ax, ay, az, tensor, i):
    tx = tensor[i, 0] * ax + tensor[i, 1] * ay + tensor[i, 2] * az
    ty = tensor[i, 1] * ax + tensor[i, 3] * ay + tensor[i, 4] * az
    tz = tensor[i, 2] * ax + tensor[i, 4] * ay + tensor[i, 5] * az
    out[arm], out[arm + 1], out[arm + 2] = ax, ay, az
    out[turn], out[turn + 1], out[turn + 2] = tx, ty, tz
    return ax * tx + ay * ty + az * tz


@kernel
def prepare(first, count, pair, points, normal, anchor, separation, impulse, friction, inverse_mass, tensor, rough,
            springy, head, row):
    """Writes heads (m, HEAD) and rows (m, 8, ROW) of manifolds first to count. anchor: from the centres of a and b to
    each point, world; friction: (m, 4) the impulse of the last sub-step, world, and its twist; tensor: (n, 6), zero for
    what does not move; rough, springy: (n,) coefficients of friction (of a pair the geometric mean) and restitution
    (of a pair the greater)."""
    for i in range(first, count):
        a, b = pair[i, 0], pair[i, 1]
        h = head[i]
        x, y, z = normal[i, 0], normal[i, 1], normal[i, 2]
        ux, uy, uz, vx, vy, vz = tangents(x, y, z)
        h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8] = x, y, z, ux, uy, uz, vx, vy, vz
        light = inverse_mass[a] + inverse_mass[b]
        h[LIGHT_A], h[LIGHT_B], h[FRICTION] = inverse_mass[a], inverse_mass[b], math.sqrt(rough[a] * rough[b])
        h[BOUNCE] = max(springy[a], springy[b])
        pressed = cax = cay = caz = cbx = cby = cbz = 0.0
        for k in range(points[i]):
            r, at = row[i, k], anchor[i, k]
            felt = (light + _arm(r, ARM_A, TURN_A, at[0, 0], at[0, 1], at[0, 2], x, y, z, tensor, a)
                    + _arm(r, ARM_B, TURN_B, at[1, 0], at[1, 1], at[1, 2], x, y, z, tensor, b))
            r[MASS] = 1.0 / felt if felt > 0.0 else 0.0
            r[START] = r[GAP] = separation[i, k]
            r[IMPULSE], r[TOTAL] = impulse[i, k], 0.0
            pressed += impulse[i, k]
        for k in range(points[i]):
            share = impulse[i, k] / pressed if pressed > 0.0 else 1.0 / points[i]
            at = anchor[i, k]
            cax, cay, caz = cax + share * at[0, 0], cay + share * at[0, 1], caz + share * at[0, 2]
            cbx, cby, cbz = cbx + share * at[1, 0], cby + share * at[1, 1], cbz + share * at[1, 2]
        k11 = light + _arm(h, ALONG_A, ALONG_TURN_A, cax, cay, caz, ux, uy, uz, tensor, a) + _arm(
            h, ALONG_B, ALONG_TURN_B, cbx, cby, cbz, ux, uy, uz, tensor, b)
        k22 = light + _arm(h, ACROSS_A, ACROSS_TURN_A, cax, cay, caz, vx, vy, vz, tensor, a) + _arm(
            h, ACROSS_B, ACROSS_TURN_B, cbx, cby, cbz, vx, vy, vz, tensor, b)
        k12 = 0.0
        for c in range(3):
            k12 += h[ALONG_A + c] * h[ACROSS_TURN_A + c] + h[ALONG_B + c] * h[ACROSS_TURN_B + c]
        det = k11 * k22 - k12 * k12
        per = 1.0 / det if det > 0.0 else 0.0
        h[MASS_11], h[MASS_12], h[MASS_22] = k22 * per, -k12 * per, k11 * per
        radius = 0.0  # of the pressure about its centre
        for k in range(points[i]):
            share = impulse[i, k] / pressed if pressed > 0.0 else 1.0 / points[i]
            at = anchor[i, k]
            radius += share * math.sqrt((at[0, 0] - cax) ** 2 + (at[0, 1] - cay) ** 2 + (at[0, 2] - caz) ** 2)
        h[RADIUS] = radius
        felt = _spin(h, TWIST_A, x, y, z, tensor, a) + _spin(h, TWIST_B, x, y, z, tensor, b)
        h[TWIST_MASS] = 1.0 / felt if felt > 0.0 else 0.0
        fx, fy, fz = friction[i, 0], friction[i, 1], friction[i, 2]
        h[PUSHED_ALONG], h[PUSHED_ACROSS] = fx * ux + fy * uy + fz * uz, fx * vx + fy * vy + fz * vz
        h[TWISTED] = friction[i, 3]


@kernel
def _spin(out, at, x, y, z, tensor, i):
    """Writes what a torque about (x, y, z) turns body i by; returns their product."""
    tx = tensor[i, 0] * x + tensor[i, 1] * y + tensor[i, 2] * z
    ty = tensor[i, 1] * x + tensor[i, 3] * y + tensor[i, 4] * z
    tz = tensor[i, 2] * x + tensor[i, 4] * y + tensor[i, 5] * z
    out[at], out[at + 1], out[at + 2] = tx, ty, tz
    return tx * x + ty * y + tz * z


@kernel
def take_back(count, points, head, row, impulse, friction, total):
    """Writes the impulses to the manifolds: those of the last sub-step, and the sums of the step along the normals."""
    for i in range(count):
        h = head[i]
        for c in range(3):
            friction[i, c] = h[PUSHED_ALONG] * h[ALONG + c] + h[PUSHED_ACROSS] * h[ACROSS + c]
        friction[i, 3] = h[TWISTED]
        for k in range(points[i]):
            impulse[i, k], total[i, k] = row[i, k, IMPULSE], row[i, k, TOTAL]
