"""Rigid bodies under forces and contacts: sub-steps with soft contacts, warm started.

Each sub-step integrates velocities, solves the contacts as stiff springs, integrates positions, and solves once
more without the springs, so that what they pushed apart keeps no speed (Catto 2023, Solver2D, 'Soft Step'; the
springs are those of Catto 2011, Soft Constraints). Detection runs once a step; the separations follow the bodies.
"""

import math

import numpy as np

from drone_sim.collision.detection import Detection
from drone_sim.dynamics.integrators import move, push
from drone_sim.effects import Forces
from drone_sim.kernel import kernel
from drone_sim.model import Model
from drone_sim.program import Program
from drone_sim.rotation import matrix, rotate
from drone_sim.state import State

CONTACT_FREQUENCY = 30.0  # Hz; at most a quarter of the sub-steps' rate, above which no spring is stable
DAMPING_RATIO = 10.0
PUSH_OUT_SPEED = 0.8  # m/s, the fastest that overlapping bodies are parted
BOUNCE_SPEED = 0.3  # m/s, below which nothing bounces
BOUNCE_PASSES = 40  # at most; four corners need about ten


@kernel
def inverse_inertia(orientation, inertia, inverse_mass, out):
    """Writes the inverse inertia tensors in the world, (n, 3, 3); zero for what does not move."""
    for i in range(orientation.shape[0]):
        if inverse_mass[i] == 0.0:
            out[i] = 0.0
            continue
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        for r in range(3):
            for c in range(3):
                out[i, r, c] = (m[3 * r] * m[3 * c] / inertia[i, 0] + m[3 * r + 1] * m[3 * c + 1] / inertia[i, 1]
                                + m[3 * r + 2] * m[3 * c + 2] / inertia[i, 2])


@kernel
def tangents(x, y, z):
    """Two unit vectors that make a right-handed frame with the unit vector (Duff et al. 2017, Building an
    Orthonormal Basis, Revisited)."""
    sign = 1.0 if z >= 0.0 else -1.0
    a = -1.0 / (sign + z)
    b = x * y * a
    return 1.0 + sign * x * x * a, sign * b, -sign * x, b, sign + y * y * a, -y


@kernel
def _effective_mass(inverse_mass, tensor, a, b, ra, rb, x, y, z):
    """Mass that an impulse along (x, y, z) at the anchors feels."""
    total = inverse_mass[a] + inverse_mass[b]
    for i, r in ((a, ra), (b, rb)):
        if inverse_mass[i] > 0.0:
            cx, cy, cz = r[1] * z - r[2] * y, r[2] * x - r[0] * z, r[0] * y - r[1] * x
            t = tensor[i]
            total += (cx * (t[0, 0] * cx + t[0, 1] * cy + t[0, 2] * cz)
                      + cy * (t[1, 0] * cx + t[1, 1] * cy + t[1, 2] * cz)
                      + cz * (t[2, 0] * cx + t[2, 1] * cy + t[2, 2] * cz))
    return 1.0 / total if total > 0.0 else 0.0


@kernel
def prepare(count, pair, points, normal, anchor, velocity, angular, inverse_mass, tensor, frame, mass, speed):
    """For every contact point, from its anchors on a and b (2 vectors, world), writes the effective masses along the
    normal and two tangents, and the speed at which they part. For every manifold: frame, rows normal and tangents."""
    for i in range(count):
        a, b = pair[i, 0], pair[i, 1]
        for c in range(3):
            frame[i, 0, c] = normal[i, c]
        basis = tangents(normal[i, 0], normal[i, 1], normal[i, 2])
        for c in range(3):
            frame[i, 1, c], frame[i, 2, c] = basis[c], basis[3 + c]
        for k in range(points[i]):
            for axis in range(3):
                mass[i, k, axis] = _effective_mass(inverse_mass, tensor, a, b, anchor[i, k, 0], anchor[i, k, 1],
                                                   frame[i, axis, 0], frame[i, axis, 1], frame[i, axis, 2])
            speed[i, k] = _parting_speed(velocity, angular, a, b, anchor[i, k], frame[i, 0])


@kernel
def _parting_speed(velocity, angular, a, b, anchor, axis):
    """Speed of b's anchor relative to a's along an axis."""
    ra, rb = anchor[0], anchor[1]
    x = (velocity[b, 0] + angular[b, 1] * rb[2] - angular[b, 2] * rb[1]
         - velocity[a, 0] - angular[a, 1] * ra[2] + angular[a, 2] * ra[1])
    y = (velocity[b, 1] + angular[b, 2] * rb[0] - angular[b, 0] * rb[2]
         - velocity[a, 1] - angular[a, 2] * ra[0] + angular[a, 0] * ra[2])
    z = (velocity[b, 2] + angular[b, 0] * rb[1] - angular[b, 1] * rb[0]
         - velocity[a, 2] - angular[a, 0] * ra[1] + angular[a, 1] * ra[0])
    return x * axis[0] + y * axis[1] + z * axis[2]


@kernel
def _apply(velocity, angular, inverse_mass, tensor, a, b, anchor, x, y, z):
    """Gives the impulse (x, y, z) to b at its anchor and its opposite to a."""
    for side in range(2):
        i = b if side == 1 else a
        if inverse_mass[i] == 0.0:
            continue
        sign = 1.0 if side == 1 else -1.0
        r, t = anchor[side], tensor[i]
        lx, ly, lz = sign * (r[1] * z - r[2] * y), sign * (r[2] * x - r[0] * z), sign * (r[0] * y - r[1] * x)
        velocity[i, 0] += sign * x * inverse_mass[i]
        velocity[i, 1] += sign * y * inverse_mass[i]
        velocity[i, 2] += sign * z * inverse_mass[i]
        for c in range(3):
            angular[i, c] += t[c, 0] * lx + t[c, 1] * ly + t[c, 2] * lz


@kernel
def _parted(start, position, turn, a, b, anchor, separation, axis):
    """Separation of a contact now: what it was, and how far the anchors have moved apart since, turning with the
    bodies. start: (n, 3) positions at detection, turn: (n, 4) rotations since."""
    now = separation
    for side in range(2):
        i = b if side == 1 else a
        sign = 1.0 if side == 1 else -1.0
        r = anchor[side]
        q = rotate(turn[i, 0], turn[i, 1], turn[i, 2], turn[i, 3], r[0], r[1], r[2])
        for c in range(3):
            now += sign * axis[c] * (position[i, c] - start[i, c] + q[c] - r[c])
    return now


@kernel
def solve(count, pair, points, frame, anchor, mass, separation, impulse, friction, start, position, turn, velocity,
          angular, inverse_mass, tensor, h, soft):
    """One pass over all contacts: impulses that meet the normal and friction conditions, with springs if `soft`."""
    frequency = min(CONTACT_FREQUENCY, 0.25 / h)
    omega = 2.0 * math.pi * frequency
    a1 = 2.0 * DAMPING_RATIO + h * omega
    a2 = h * omega * a1
    spring_rate, spring_mass, spring_loss = omega / a1, a2 / (1.0 + a2), 1.0 / (1.0 + a2)
    for i in range(count):
        a, b = pair[i, 0], pair[i, 1]
        mu = math.sqrt(friction[a] * friction[b])
        for k in range(points[i]):
            r, p = anchor[i, k], impulse[i, k]
            s = _parted(start, position, turn, a, b, r, separation[i, k], frame[i, 0])
            bias, scale, loss = 0.0, 1.0, 0.0
            if s > 0.0:
                bias = s / h  # may close the gap within this sub-step, and no faster
            elif soft:
                bias, scale, loss = max(spring_rate * s, -PUSH_OUT_SPEED), spring_mass, spring_loss
            speed = _parting_speed(velocity, angular, a, b, r, frame[i, 0])
            wanted = max(p[0] - mass[i, k, 0] * scale * (speed + bias) - loss * p[0], 0.0)
            change = wanted - p[0]
            p[0] = wanted
            _apply(velocity, angular, inverse_mass, tensor, a, b, r,
                   change * frame[i, 0, 0], change * frame[i, 0, 1], change * frame[i, 0, 2])
        for k in range(points[i]):
            r, p = anchor[i, k], impulse[i, k]
            u = p[1] - mass[i, k, 1] * _parting_speed(velocity, angular, a, b, r, frame[i, 1])
            v = p[2] - mass[i, k, 2] * _parting_speed(velocity, angular, a, b, r, frame[i, 2])
            length, limit = math.sqrt(u * u + v * v), mu * p[0]
            if length > limit:  # Coulomb's cone
                u, v = u * limit / length, v * limit / length
            du, dv = u - p[1], v - p[2]
            p[1], p[2] = u, v
            _apply(velocity, angular, inverse_mass, tensor, a, b, r,
                   du * frame[i, 1, 0] + dv * frame[i, 2, 0], du * frame[i, 1, 1] + dv * frame[i, 2, 1],
                   du * frame[i, 1, 2] + dv * frame[i, 2, 2])


@kernel
def warm_start(count, pair, points, frame, anchor, impulse, velocity, angular, inverse_mass, tensor):
    """Applies the impulses of the last sub-step again, which are nearly those of this one."""
    for i in range(count):
        for k in range(points[i]):
            p, f = impulse[i, k], frame[i]
            _apply(velocity, angular, inverse_mass, tensor, pair[i, 0], pair[i, 1], anchor[i, k],
                   p[0] * f[0, 0] + p[1] * f[1, 0] + p[2] * f[2, 0],
                   p[0] * f[0, 1] + p[1] * f[1, 1] + p[2] * f[2, 1],
                   p[0] * f[0, 2] + p[1] * f[1, 2] + p[2] * f[2, 2])


@kernel
def bounce(count, pair, points, frame, anchor, mass, impulse, total, speed, restitution, velocity, angular,
           inverse_mass, tensor):
    """Gives back speed to contacts that met at more than BOUNCE_SPEED (the greater restitution of the two).

    The points of a contact share one body, so several passes are needed until each has its own speed.
    """
    for i in range(count):
        a, b = pair[i, 0], pair[i, 1]
        e = max(restitution[a], restitution[b])
        for _ in range(BOUNCE_PASSES if e > 0.0 else 0):
            unmet = 0.0
            for k in range(points[i]):
                if speed[i, k] > -BOUNCE_SPEED or total[i, k] == 0.0:
                    continue
                missing = -e * speed[i, k] - _parting_speed(velocity, angular, a, b, anchor[i, k], frame[i, 0])
                wanted = max(impulse[i, k, 0] + mass[i, k, 0] * missing, 0.0)
                change = wanted - impulse[i, k, 0]
                impulse[i, k, 0] = wanted
                total[i, k] += change
                unmet = max(unmet, abs(missing))
                _apply(velocity, angular, inverse_mass, tensor, a, b, anchor[i, k],
                       change * frame[i, 0, 0], change * frame[i, 0, 1], change * frame[i, 0, 2])
            if unmet < 0.01 * BOUNCE_SPEED:
                break


@kernel
def sum_impulses(count, points, impulse, total):
    """Adds the normal impulses of a sub-step to those of the step."""
    for i in range(count):
        for k in range(points[i]):
            total[i, k] += impulse[i, k, 0]


class Motion:
    """The stage that moves all bodies by one step under `force_w`, `torque_w` and the contacts found."""

    def __init__(self, model: Model, state: State, detection: Detection, acting: Program, forces: Forces,
                 dt: float, substeps: int) -> None:
        self._bodies, self._state, self._detection = model.bodies, state, detection
        self._acting, self._forces = acting, forces
        self._h, self._substeps = dt / substeps, substeps
        n = model.bodies.count
        self._tensor = np.empty((n, 3, 3))
        self._start, self._turn = np.empty((n, 3)), np.empty((n, 4))
        self._grow(64)

    def _grow(self, capacity: int) -> None:
        self._frame = np.empty((capacity, 3, 3))
        self._mass = np.empty((capacity, 8, 3))
        self._speed = np.empty((capacity, 8))

    def __call__(self) -> None:
        bodies, s, m, h = self._bodies, self._state, self._detection.manifolds, self._h
        if m.capacity > len(self._frame):
            self._grow(m.capacity)
        inverse_inertia(s.orientation_w, bodies.inertia_b, bodies.inverse_mass, self._tensor)
        moving = (s.velocity_w, s.angular_velocity_w, bodies.inverse_mass, self._tensor)
        prepare(m.count, m.pair, m.points, m.normal_w, m.anchor_w, *moving, self._frame, self._mass, self._speed)
        m.total[: m.count] = 0.0
        self._start[:] = s.position_w
        self._turn[:] = (0.0, 0.0, 0.0, 1.0)
        contacts = (m.count, m.pair, m.points, self._frame, m.anchor_w)
        gap = (self._mass, m.separation, m.impulse, bodies.friction, self._start, s.position_w, self._turn)
        for _ in range(self._substeps):
            self._acting.run(1)
            push(s.orientation_w, s.velocity_w, s.angular_velocity_w, bodies.inverse_mass, bodies.inertia_b,
                 self._forces.force_w, self._forces.torque_w, h)
            warm_start(*contacts, m.impulse, *moving)
            solve(*contacts, *gap, *moving, h, True)
            move(s.position_w, s.orientation_w, self._turn, s.velocity_w, s.angular_velocity_w, bodies.movable, h)
            solve(*contacts, *gap, *moving, h, False)
            sum_impulses(m.count, m.points, m.impulse, m.total)
        bounce(*contacts, self._mass, m.impulse, m.total, self._speed, bodies.restitution, *moving)
