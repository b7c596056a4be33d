"""Velocities and positions of rigid bodies over a sub-step: the pieces that the schemes of schemes.py are made of."""

import math

from drone_engine.kernel import inlined, kernel
from drone_engine.math.rotation import integrate_rotation, matrix, rotate

NEWTON = 8  # iterations at most, which spins of more than a radian a sub-step take
CONVERGED = 1e-30  # of the square of an angular velocity
SLOW = 1e-4  # square of the angle turned in a sub-step


@inlined
def spun_euler(m, ix, iy, iz, wx, wy, wz, tx, ty, tz, h):
    """Angular velocity after h s of torque t, both of the world; m: rotation matrix, i: principal moments.

    The gyroscopic torque is that at the end of the step, by one Newton step in the body frame: fast spin gains no
    energy, it loses some (Catto 2015, Numerical Methods, GDC)."""
    wx, wy, wz = (m[0] * wx + m[3] * wy + m[6] * wz, m[1] * wx + m[4] * wy + m[7] * wz,
                  m[2] * wx + m[5] * wy + m[8] * wz)
    wx += h * (m[0] * tx + m[3] * ty + m[6] * tz) / ix
    wy += h * (m[1] * tx + m[4] * ty + m[7] * tz) / iy
    wz += h * (m[2] * tx + m[5] * ty + m[8] * tz) / iz
    # f(w') = I (w' - w) + h w' x I w' = 0, one step from w' = w
    fx, fy, fz = h * wy * wz * (iz - iy), h * wz * wx * (ix - iz), h * wx * wy * (iy - ix)
    dx, dy, dz = _newton(ix, iy, iz, h * wx, h * wy, h * wz, fx, fy, fz)
    wx, wy, wz = wx - dx, wy - dy, wz - dz
    return (m[0] * wx + m[1] * wy + m[2] * wz, m[3] * wx + m[4] * wy + m[5] * wz, m[6] * wx + m[7] * wy + m[8] * wz)


@inlined
def _newton(ix, iy, iz, sx, sy, sz, fx, fy, fz):
    """Solves (I + [s] I - [I s]) d = f, the Jacobian of I w + h w x I w with s = h w."""
    j00, j01, j02 = ix, sz * (iz - iy), sy * (iz - iy)
    j10, j11, j12 = sz * (ix - iz), iy, sx * (ix - iz)
    j20, j21, j22 = sy * (iy - ix), sx * (iy - ix), iz
    c0, c1, c2 = j11 * j22 - j12 * j21, j12 * j20 - j10 * j22, j10 * j21 - j11 * j20
    scale = 1.0 / (j00 * c0 + j01 * c1 + j02 * c2)
    return (scale * (c0 * fx + (j02 * j21 - j01 * j22) * fy + (j01 * j12 - j02 * j11) * fz),
            scale * (c1 * fx + (j00 * j22 - j02 * j20) * fy + (j02 * j10 - j00 * j12) * fz),
            scale * (c2 * fx + (j01 * j20 - j00 * j21) * fy + (j00 * j11 - j01 * j10) * fz))


@kernel
def spun_midpoint(ix, iy, iz, wx, wy, wz, tx, ty, tz, h):
    """Angular velocity after h s of torque t, all in the body frame, by the implicit midpoint rule: energy and the
    length of the angular momentum stay as they are without torque (Austin, Krishnaprasad and Wang 1993, Almost Poisson
    Integration of Rigid Body Systems)."""
    ax, ay, az = wx + h / ix * tx, wy + h / iy * ty, wz + h / iz * tz
    if slow(wx, wy, wz, h):
        return spun_slow(ix, iy, iz, wx, wy, wz, tx, ty, tz, h)
    for _ in range(NEWTON):
        ax, ay, az, found = nearer(ix, iy, iz, wx, wy, wz, tx, ty, tz, h, ax, ay, az)
        if found:
            break
    return ax, ay, az


@inlined
def slow(wx, wy, wz, h):
    """Whether fixed-point iterations, each of which gains a factor of h w, find the midpoint."""
    return (wx * wx + wy * wy + wz * wz) * h * h < SLOW


@inlined
def spun_slow(ix, iy, iz, wx, wy, wz, tx, ty, tz, h):
    """spun_midpoint where that is slow."""
    ux, uy, uz = h / ix, h / iy, h / iz
    gx, gy, gz = 0.25 * ux * (iz - iy), 0.25 * uy * (ix - iz), 0.25 * uz * (iy - ix)
    cx, cy, cz = wx + ux * tx, wy + uy * ty, wz + uz * tz
    ax, ay, az = cx, cy, cz
    for _ in range(4):
        mx, my, mz = ax + wx, ay + wy, az + wz
        ax, ay, az = cx - gx * my * mz, cy - gy * mz * mx, cz - gz * mx * my
    return ax, ay, az


@inlined
def nearer(ix, iy, iz, wx, wy, wz, tx, ty, tz, h, ax, ay, az):
    """A Newton step from a towards what spun_midpoint looks for; where a is that already, a and True."""
    ux, uy, uz = h / ix, h / iy, h / iz
    gx, gy, gz = 0.25 * ux * (iz - iy), 0.25 * uy * (ix - iz), 0.25 * uz * (iy - ix)
    mx, my, mz = ax + wx, ay + wy, az + wz
    fx, fy, fz = (ax - (wx + ux * tx) + gx * my * mz, ay - (wy + uy * ty) + gy * mz * mx,
                  az - (wz + uz * tz) + gz * mx * my)
    dx, dy, dz = _newton(ix, iy, iz, 0.25 * h * mx, 0.25 * h * my, 0.25 * h * mz, ix * fx, iy * fy, iz * fz)
    found = fx * fx + fy * fy + fz * fz < CONVERGED * (wx * wx + wy * wy + wz * wz)
    return ax if found else ax - dx, ay if found else ay - dy, az if found else az - dz, found


@kernel
def cayley(q, i, wx, wy, wz, h):
    """Turns orientation i of q by h s at the angular velocity w of the body frame, as the midpoint rule does: the
    angular momentum in the world then stays exactly as it is."""
    q[i, 0], q[i, 1], q[i, 2], q[i, 3] = turned_midpoint(q[i, 0], q[i, 1], q[i, 2], q[i, 3], wx, wy, wz, h)


@inlined
def turned_midpoint(x, y, z, w, wx, wy, wz, h):
    """The same for a quaternion."""
    ax, ay, az = 0.5 * h * wx, 0.5 * h * wy, 0.5 * h * wz
    nx, ny, nz = x + w * ax + y * az - z * ay, y + w * ay + z * ax - x * az, z + w * az + x * ay - y * ax
    nw = w - x * ax - y * ay - z * az
    norm = 1.0 / math.sqrt(nx * nx + ny * ny + nz * nz + nw * nw)
    return nx * norm, ny * norm, nz * norm, nw * norm


@kernel
def to_body(orientation, i, x, y, z):
    """A vector of the world in the frame of body i."""
    return rotate(-orientation[i, 0], -orientation[i, 1], -orientation[i, 2], orientation[i, 3], x, y, z)


@kernel
def to_world(orientation, i, x, y, z):
    """A vector of the frame of body i in the world."""
    return rotate(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3], x, y, z)


@kernel
def push_euler(i, orientation, velocity, angular, inverse_mass, inertia, force, torque, h):
    """Velocities of body i after h s of force (N) and torque (N m) of the world frame: semi-implicit Euler."""
    for c in range(3):
        velocity[i, c] += h * inverse_mass[i] * force[i, c]
    m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
    angular[i, 0], angular[i, 1], angular[i, 2] = spun_euler(
        m, inertia[i, 0], inertia[i, 1], inertia[i, 2], angular[i, 0], angular[i, 1], angular[i, 2],
        torque[i, 0], torque[i, 1], torque[i, 2], h)


@kernel
def push_midpoint(i, orientation, velocity, angular, inverse_mass, inertia, force, torque, h):
    """The same by the midpoint rule, without loss of energy; the orientation stays."""
    for c in range(3):
        velocity[i, c] += h * inverse_mass[i] * force[i, c]
    m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
    x, y, z, u, v, w = angular[i, 0], angular[i, 1], angular[i, 2], torque[i, 0], torque[i, 1], torque[i, 2]
    x, y, z = spun_midpoint(
        inertia[i, 0], inertia[i, 1], inertia[i, 2],
        m[0] * x + m[3] * y + m[6] * z, m[1] * x + m[4] * y + m[7] * z, m[2] * x + m[5] * y + m[8] * z,
        m[0] * u + m[3] * v + m[6] * w, m[1] * u + m[4] * v + m[7] * w, m[2] * u + m[5] * v + m[8] * w, h)
    angular[i, 0], angular[i, 1], angular[i, 2] = (
        m[0] * x + m[1] * y + m[2] * z, m[3] * x + m[4] * y + m[5] * z, m[6] * x + m[7] * y + m[8] * z)


@kernel
def move(i, position, orientation, velocity, angular, h):
    """Position and orientation of body i after h s at these velocities."""
    for c in range(3):
        position[i, c] += h * velocity[i, c]
    (orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3]) = integrate_rotation(
        orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3],
        angular[i, 0], angular[i, 1], angular[i, 2], h)


@kernel
def move_midpoint(i, position, orientation, velocity, angular, h):
    """The same by the midpoint rule, whose turn needs no sine."""
    for c in range(3):
        position[i, c] += h * velocity[i, c]
    x, y, z, w = orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3]
    ax, ay, az = 0.5 * h * angular[i, 0], 0.5 * h * angular[i, 1], 0.5 * h * angular[i, 2]
    nx, ny, nz = x + w * ax + z * ay - y * az, y + w * ay + x * az - z * ax, z + w * az + y * ax - x * ay
    nw = w - x * ax - y * ay - z * az
    norm = 1.0 / math.sqrt(nx * nx + ny * ny + nz * nz + nw * nw)
    orientation[i, 0], orientation[i, 1] = nx * norm, ny * norm
    orientation[i, 2], orientation[i, 3] = nz * norm, nw * norm


@kernel
def moved(i, position, orientation, start, moving):
    """Writes how far body i has moved and turned since start (n, 7) into its row of moving, as the solver has them."""
    for c in range(3):
        moving[i, 6 + c] = position[i, c] - start[i, c]
    x, y, z, w = orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3]
    a, b, c, d = -start[i, 3], -start[i, 4], -start[i, 5], start[i, 6]
    qx, qy, qz = w * a + x * d + y * c - z * b, w * b + y * d + z * a - x * c, w * c + z * d + x * b - y * a
    qw = w * d - x * a - y * b - z * c
    moving[i, 9], moving[i, 10], moving[i, 11] = 2.0 * qw * qx, 2.0 * qw * qy, 2.0 * qw * qz
    moving[i, 12] = 0.5 / max(qw * qw, 1e-12)  # 1 + cos = 2 w^2


@kernel
def runge_kutta(stage, i, position, orientation, velocity, angular, inverse_mass, inertia, force, torque, trial, h):
    """Stage 0 to 3 of the classical scheme for body i, with the forces at its trial state: adds the slope to the sum in
    the second half of trial (n, 26), whose first half is the start, and sets the next trial state, at last the end."""
    q, w, t = orientation[i], angular[i], trial[i]
    if stage == 0:  # spin is followed in the body's own frame
        t[10], t[11], t[12] = to_body(orientation, i, w[0], w[1], w[2])
    wx, wy, wz = to_body(orientation, i, w[0], w[1], w[2])
    tx, ty, tz = to_body(orientation, i, torque[i, 0], torque[i, 1], torque[i, 2])
    ix, iy, iz = inertia[i, 0], inertia[i, 1], inertia[i, 2]
    ax = (tx + wy * wz * (iy - iz)) / ix  # Euler's equations
    ay = (ty + wz * wx * (iz - ix)) / iy
    az = (tz + wx * wy * (ix - iy)) / iz
    ux, uy, uz = 0.5 * wx, 0.5 * wy, 0.5 * wz
    px, py, pz = q[3] * ux + q[1] * uz - q[2] * uy, q[3] * uy + q[2] * ux - q[0] * uz, q[3] * uz + q[0] * uy - q[1] * ux
    pw = -ux * q[0] - uy * q[1] - uz * q[2]
    weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
    ahead = 0.5 * h if stage < 2 else h
    slope = (velocity[i, 0], velocity[i, 1], velocity[i, 2], px, py, pz, pw, inverse_mass[i] * force[i, 0],
             inverse_mass[i] * force[i, 1], inverse_mass[i] * force[i, 2], ax, ay, az)
    for c in range(13):
        t[13 + c] = weight * slope[c] + (t[13 + c] if stage else 0.0)
    for c in range(3):
        position[i, c] = t[c] + (ahead * slope[c] if stage < 3 else t[13 + c])
        velocity[i, c] = t[7 + c] + (ahead * slope[7 + c] if stage < 3 else t[20 + c])
        angular[i, c] = t[10 + c] + (ahead * slope[10 + c] if stage < 3 else t[23 + c])
    square = 0.0
    for c in range(4):
        orientation[i, c] = t[3 + c] + (ahead * slope[3 + c] if stage < 3 else t[16 + c])
        square += orientation[i, c] * orientation[i, c]
    norm = 1.0 / math.sqrt(square)
    for c in range(4):
        orientation[i, c] *= norm
    angular[i, 0], angular[i, 1], angular[i, 2] = to_world(orientation, i, w[0], w[1], w[2])
