"""Contacts of rigid bodies: sequential impulses with soft constraints in sub-steps, warm started.

Each sub-step solves the contacts as stiff springs before positions move, and once more without the springs after, so
that what they pushed apart keeps no speed (Catto 2023, Solver2D, 'Soft Step'; the springs are those of Catto 2011, Soft
Constraints). Detection runs once a step; the gaps follow the bodies.
"""

import math

from drone_sim.dynamics.constraints import (
    ACROSS_A, ACROSS_B, ACROSS_TURN_A, ACROSS_TURN_B, ALONG_A, ALONG_B, ALONG_TURN_A, ALONG_TURN_B, FRICTION, GAP,
    IMPULSE, LIGHT_A, LIGHT_B, MASS, MASS_11, MASS_12, MASS_22, PUSHED_ACROSS, PUSHED_ALONG, RADIUS, START, TOTAL,
    TWIST_A, TWIST_B, TWIST_MASS, TWISTED,
)
from drone_sim.kernel import inlined, kernel

CONTACT_FREQUENCY = 30.0  # Hz; at most a quarter of the sub-steps' rate, above which no spring is stable
DAMPING_RATIO = 10.0
PUSH_OUT_SPEED = 0.8  # m/s, the fastest that overlapping bodies are parted


@inlined
def _dot(x, y, z, out, at):
    return x * out[at] + y * out[at + 1] + z * out[at + 2]


@kernel
def warm_start(count, pair, points, head, row, velocity, angular):
    """Applies the impulses of the last sub-step again, which are nearly those of this one."""
    for i in range(count):
        a, b, h = pair[i, 0], pair[i, 1], head[i]
        p, u, v, w = 0.0, h[PUSHED_ALONG], h[PUSHED_ACROSS], h[TWISTED]
        ax = u * h[ALONG_TURN_A] + v * h[ACROSS_TURN_A] + w * h[TWIST_A]
        ay = u * h[ALONG_TURN_A + 1] + v * h[ACROSS_TURN_A + 1] + w * h[TWIST_A + 1]
        az = u * h[ALONG_TURN_A + 2] + v * h[ACROSS_TURN_A + 2] + w * h[TWIST_A + 2]
        bx = u * h[ALONG_TURN_B] + v * h[ACROSS_TURN_B] + w * h[TWIST_B]
        by = u * h[ALONG_TURN_B + 1] + v * h[ACROSS_TURN_B + 1] + w * h[TWIST_B + 1]
        bz = u * h[ALONG_TURN_B + 2] + v * h[ACROSS_TURN_B + 2] + w * h[TWIST_B + 2]
        for k in range(points[i]):
            r = row[i, k]
            q = r[IMPULSE]
            p += q
            ax, ay, az = ax + q * r[6], ay + q * r[7], az + q * r[8]
            bx, by, bz = bx + q * r[9], by + q * r[10], bz + q * r[11]
        x, y, z = p * h[0] + u * h[3] + v * h[6], p * h[1] + u * h[4] + v * h[7], p * h[2] + u * h[5] + v * h[8]
        m, n = h[LIGHT_A], h[LIGHT_B]
        velocity[a, 0] -= m * x
        velocity[a, 1] -= m * y
        velocity[a, 2] -= m * z
        velocity[b, 0] += n * x
        velocity[b, 1] += n * y
        velocity[b, 2] += n * z
        angular[a, 0] -= ax
        angular[a, 1] -= ay
        angular[a, 2] -= az
        angular[b, 0] += bx
        angular[b, 1] += by
        angular[b, 2] += bz


@kernel
def solve(count, pair, points, head, row, velocity, angular, pressed_on, h, soft):
    """One pass over all contacts: impulses that meet the normal and friction conditions. `soft`: with springs, and
    marking who is pressed on (n,); else the last of the sub-step, of h s, whose impulses are added up."""
    frequency = min(CONTACT_FREQUENCY, 0.25 / h)
    omega = 2.0 * math.pi * frequency
    a1 = 2.0 * DAMPING_RATIO + h * omega
    a2 = h * omega * a1
    spring_rate, spring_mass, spring_loss = omega / a1, a2 / (1.0 + a2), 1.0 / (1.0 + a2)
    if not soft:
        spring_rate, spring_mass, spring_loss = 0.0, 1.0, 0.0
    per = 1.0 / h
    for i in range(count):
        a, b, t = pair[i, 0], pair[i, 1], head[i]
        x, y, z, m, n = t[0], t[1], t[2], t[LIGHT_A], t[LIGHT_B]
        vax, vay, vaz, wax, way, waz = (velocity[a, 0], velocity[a, 1], velocity[a, 2],
                                        angular[a, 0], angular[a, 1], angular[a, 2])
        vbx, vby, vbz, wbx, wby, wbz = (velocity[b, 0], velocity[b, 1], velocity[b, 2],
                                        angular[b, 0], angular[b, 1], angular[b, 2])
        pressed = 0.0
        for k in range(points[i]):
            r = row[i, k]
            gap, p = r[GAP], r[IMPULSE]
            # A gap may close within this sub-step, and no faster; an overlap is pushed apart.
            apart = gap > 0.0
            bias = gap * per if apart else max(spring_rate * gap, -PUSH_OUT_SPEED)
            scale = 1.0 if apart else spring_mass
            loss = 0.0 if apart else spring_loss
            speed = ((x * (vbx - vax) + y * (vby - vay) + z * (vbz - vaz))
                     + (r[3] * wbx + r[4] * wby + r[5] * wbz) - (r[0] * wax + r[1] * way + r[2] * waz))
            wanted = max(p - (r[MASS] * scale * (speed + bias) + loss * p), 0.0)
            q = wanted - p
            r[IMPULSE] = wanted
            if not soft:
                r[TOTAL] += wanted
            pressed += wanted
            f, g = m * q, n * q
            vax, vay, vaz = vax - f * x, vay - f * y, vaz - f * z
            vbx, vby, vbz = vbx + g * x, vby + g * y, vbz + g * z
            wax, way, waz = wax - q * r[6], way - q * r[7], waz - q * r[8]
            wbx, wby, wbz = wbx + q * r[9], wby + q * r[10], wbz + q * r[11]
        if soft and pressed > 0.0:
            pressed_on[a] = pressed_on[b] = True
        limit = t[FRICTION] * pressed
        dx, dy, dz = vbx - vax, vby - vay, vbz - vaz
        u = (_dot(dx, dy, dz, t, 3) + _dot(wbx, wby, wbz, t, ALONG_B) - _dot(wax, way, waz, t, ALONG_A))
        v = (_dot(dx, dy, dz, t, 6) + _dot(wbx, wby, wbz, t, ACROSS_B) - _dot(wax, way, waz, t, ACROSS_A))
        old_u, old_v, old_w = t[PUSHED_ALONG], t[PUSHED_ACROSS], t[TWISTED]
        p = old_u - (t[MASS_11] * u + t[MASS_12] * v)
        q = old_v - (t[MASS_12] * u + t[MASS_22] * v)
        square = p * p + q * q
        if square > limit * limit:  # Coulomb's cone
            scale = limit / math.sqrt(square)
            p, q = p * scale, q * scale
        t[PUSHED_ALONG], t[PUSHED_ACROSS] = p, q
        u, v = p - old_u, q - old_v
        fx, fy, fz = u * t[3] + v * t[6], u * t[4] + v * t[7], u * t[5] + v * t[8]
        wax, way, waz = (wax - u * t[ALONG_TURN_A] - v * t[ACROSS_TURN_A],
                         way - u * t[ALONG_TURN_A + 1] - v * t[ACROSS_TURN_A + 1],
                         waz - u * t[ALONG_TURN_A + 2] - v * t[ACROSS_TURN_A + 2])
        wbx, wby, wbz = (wbx + u * t[ALONG_TURN_B] + v * t[ACROSS_TURN_B],
                         wby + u * t[ALONG_TURN_B + 1] + v * t[ACROSS_TURN_B + 1],
                         wbz + u * t[ALONG_TURN_B + 2] + v * t[ACROSS_TURN_B + 2])
        limit *= t[RADIUS]
        w = old_w - t[TWIST_MASS] * (x * (wbx - wax) + y * (wby - way) + z * (wbz - waz))
        w = min(max(w, -limit), limit)
        t[TWISTED] = w
        w -= old_w
        velocity[a, 0], velocity[a, 1], velocity[a, 2] = vax - m * fx, vay - m * fy, vaz - m * fz
        velocity[b, 0], velocity[b, 1], velocity[b, 2] = vbx + n * fx, vby + n * fy, vbz + n * fz
        angular[a, 0], angular[a, 1], angular[a, 2] = (
            wax - w * t[TWIST_A], way - w * t[TWIST_A + 1], waz - w * t[TWIST_A + 2])
        angular[b, 0], angular[b, 1], angular[b, 2] = (
            wbx + w * t[TWIST_B], wby + w * t[TWIST_B + 1], wbz + w * t[TWIST_B + 2])


@kernel
def follow(count, pair, points, normal, anchor, shift, row):
    """Brings the gaps to where the bodies are now. shift: (n, 12) since detection, how far a body has moved, and the
    rows of its rotation matrix less the identity."""
    for i in range(count):
        s, t = shift[pair[i, 0]], shift[pair[i, 1]]
        x, y, z = normal[i, 0], normal[i, 1], normal[i, 2]
        way = x * (t[0] - s[0]) + y * (t[1] - s[1]) + z * (t[2] - s[2])
        ax, ay, az = (x * s[3] + y * s[6] + z * s[9], x * s[4] + y * s[7] + z * s[10], x * s[5] + y * s[8] + z * s[11])
        bx, by, bz = (x * t[3] + y * t[6] + z * t[9], x * t[4] + y * t[7] + z * t[10], x * t[5] + y * t[8] + z * t[11])
        for k in range(points[i]):
            r, at = row[i, k], anchor[i, k]
            r[GAP] = r[START] + (way + (bx * at[1, 0] + by * at[1, 1] + bz * at[1, 2])
                                 - (ax * at[0, 0] + ay * at[0, 1] + az * at[0, 2]))
