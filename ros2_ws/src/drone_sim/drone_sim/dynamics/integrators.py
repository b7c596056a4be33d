"""Semi-implicit Euler: velocities from forces, then positions from the new velocities."""

from drone_sim.kernel import inlined, kernel
from drone_sim.rotation import matrix, turned


@kernel
def push(orientation, velocity, angular, inverse_mass, inertia, force, torque, h):
    """Velocities after h s under forces (N) and torques (N m) of the world frame."""
    for i in range(velocity.shape[0]):
        if inverse_mass[i] == 0.0:
            continue
        for k in range(3):
            velocity[i, k] += h * inverse_mass[i] * force[i, k]
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        angular[i, 0], angular[i, 1], angular[i, 2] = spun(
            m, angular[i, 0], angular[i, 1], angular[i, 2], torque[i, 0], torque[i, 1], torque[i, 2],
            inertia[i, 0], inertia[i, 1], inertia[i, 2], h)


@inlined
def spun(m, ax, ay, az, tx, ty, tz, ix, iy, iz, h):
    """The angular velocity after h s under a torque, both in the world; m: rotation matrix, i: principal moments.

    The gyroscopic torque is taken at the end of the step by one Newton step in the body frame, so that fast spin
    gains no energy (Catto 2015, Numerical Methods, GDC).
    """
    wx = m[0] * ax + m[3] * ay + m[6] * az + h * (m[0] * tx + m[3] * ty + m[6] * tz) / ix
    wy = m[1] * ax + m[4] * ay + m[7] * az + h * (m[1] * tx + m[4] * ty + m[7] * tz) / iy
    wz = m[2] * ax + m[5] * ay + m[8] * az + h * (m[2] * tx + m[5] * ty + m[8] * tz) / iz
    # f(w') = I (w' - w) + h w' x I w' = 0, one step from w' = w
    fx, fy, fz = h * wy * wz * (iz - iy), h * wz * wx * (ix - iz), h * wx * wy * (iy - ix)
    j00, j01, j02 = ix, h * wz * (iz - iy), h * wy * (iz - iy)
    j10, j11, j12 = h * wz * (ix - iz), iy, h * wx * (ix - iz)
    j20, j21, j22 = h * wy * (iy - ix), h * wx * (iy - ix), iz
    c0, c1, c2 = j11 * j22 - j12 * j21, j12 * j20 - j10 * j22, j10 * j21 - j11 * j20
    scale = 1.0 / (j00 * c0 + j01 * c1 + j02 * c2)
    wx -= scale * (c0 * fx + (j02 * j21 - j01 * j22) * fy + (j01 * j12 - j02 * j11) * fz)
    wy -= scale * (c1 * fx + (j00 * j22 - j02 * j20) * fy + (j02 * j10 - j00 * j12) * fz)
    wz -= scale * (c2 * fx + (j01 * j20 - j00 * j21) * fy + (j00 * j11 - j01 * j10) * fz)
    return (m[0] * wx + m[1] * wy + m[2] * wz, m[3] * wx + m[4] * wy + m[5] * wz, m[6] * wx + m[7] * wy + m[8] * wz)


@kernel
def move(position, orientation, turn, velocity, angular, movable, h):
    """Positions and orientations after h s at these velocities; `turn` gathers the rotation since it was unity."""
    for i in range(position.shape[0]):
        if not movable[i]:
            continue
        wx, wy, wz = angular[i, 0], angular[i, 1], angular[i, 2]
        q = turned(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3], wx, wy, wz, h)
        t = turned(turn[i, 0], turn[i, 1], turn[i, 2], turn[i, 3], wx, wy, wz, h)
        for k in range(3):
            position[i, k] += h * velocity[i, k]
        for k in range(4):
            orientation[i, k] = q[k]
            turn[i, k] = t[k]
