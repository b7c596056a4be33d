"""Time integration of rigid bodies: velocities from forces, poses from velocities, over a time of h s.

Kernels of state take BodyStates and Forces of n bodies, world frame, SI units, and a list of bodies (n + 1,): how many,
and which. The others take and return numbers; angular velocities are in the frame that their docstrings name.
All are inlined: a call would copy a hundred numbers that describe the arrays.
"""

import math
from typing import NamedTuple

from drone_engine.arrays import Floats
from drone_engine.kernel import inlined, kernel
from drone_engine.math.rotation import integrate_rotation, matrix, multiply, normalized, rotate

NEWTON_ITERATIONS = 8  # at most; rotations of more than a radian per step take that many
CONVERGED = 1e-30  # of the square of an angular velocity
SLOW = 1e-4  # rad^2, square of the angle of rotation in a step, below which fixed-point iterations converge fast
# Columns of the scratch (n, 26) of bodies that are integrated in stages: the state at the start, then, for Runge and
# Kutta, the weighted sum of slopes with the same columns.
POSITION, ORIENTATION, VELOCITY, ANGULAR_VELOCITY, SLOPES, TRIAL_FIELDS = 0, 3, 7, 10, 13, 26


class BodyStates(NamedTuple):
    """Poses and velocities of n bodies, at their centers of mass, in the world frame."""

    position: Floats  # (n, 3) m
    orientation: Floats  # (n, 4) unit quaternion x y z w
    velocity: Floats  # (n, 3) m/s
    angular_velocity: Floats  # (n, 3) rad/s


@inlined
def euler_angular_velocity(m, ix, iy, iz, wx, wy, wz, tx, ty, tz, h):
    """Angular velocity (rad/s) after h s of torque t (N m), semi-implicit Euler; all in the world frame.

    The gyroscopic torque is that at the end of the step, by one Newton step in the body frame: rotations of less than a
    radian per step gain no energy, and fast ones lose some (Catto 2015, Numerical Methods, GDC). m: rotation matrix,
    row by row; i: principal moments of inertia, kg m^2.
    """
    wx, wy, wz = (m[0] * wx + m[3] * wy + m[6] * wz, m[1] * wx + m[4] * wy + m[7] * wz,
                  m[2] * wx + m[5] * wy + m[8] * wz)
    wx += h * (m[0] * tx + m[3] * ty + m[6] * tz) / ix
    wy += h * (m[1] * tx + m[4] * ty + m[7] * tz) / iy
    wz += h * (m[2] * tx + m[5] * ty + m[8] * tz) / iz
    # f(w') = I (w' - w) + h w' x I w' = 0, one step from w' = w
    fx, fy, fz = h * wy * wz * (iz - iy), h * wz * wx * (ix - iz), h * wx * wy * (iy - ix)
    dx, dy, dz = _newton_step(ix, iy, iz, h * wx, h * wy, h * wz, fx, fy, fz)
    wx, wy, wz = wx - dx, wy - dy, wz - dz
    return (m[0] * wx + m[1] * wy + m[2] * wz, m[3] * wx + m[4] * wy + m[5] * wz, m[6] * wx + m[7] * wy + m[8] * wz)


@inlined
def _newton_step(ix, iy, iz, sx, sy, sz, fx, fy, fz):
    """Solves (I + [s] I - [I s]) d = f for d, by Cramer's rule: the Jacobian of I w + h w x I w with s = h w."""
    j00, j01, j02 = ix, sz * (iz - iy), sy * (iz - iy)
    j10, j11, j12 = sz * (ix - iz), iy, sx * (ix - iz)
    j20, j21, j22 = sy * (iy - ix), sx * (iy - ix), iz
    c0, c1, c2 = j11 * j22 - j12 * j21, j12 * j20 - j10 * j22, j10 * j21 - j11 * j20
    scale = 1.0 / (j00 * c0 + j01 * c1 + j02 * c2)
    return (scale * (c0 * fx + (j02 * j21 - j01 * j22) * fy + (j01 * j12 - j02 * j11) * fz),
            scale * (c1 * fx + (j00 * j22 - j02 * j20) * fy + (j02 * j10 - j00 * j12) * fz),
            scale * (c2 * fx + (j01 * j20 - j00 * j21) * fy + (j00 * j11 - j01 * j10) * fz))


@kernel
def midpoint_angular_velocity(ix, iy, iz, wx, wy, wz, tx, ty, tz, h):
    """Angular velocity (rad/s) after h s of torque t (N m), implicit midpoint rule; all in the body frame.

    Without torque, energy and the length of the angular momentum are conserved (Austin, Krishnaprasad and Wang 1993,
    Almost Poisson Integration of Rigid Body Systems). i: principal moments of inertia, kg m^2.
    """
    ax, ay, az = wx + h / ix * tx, wy + h / iy * ty, wz + h / iz * tz
    if is_slow(wx, wy, wz, h):
        return midpoint_fixed_point(ix, iy, iz, wx, wy, wz, tx, ty, tz, h)
    for _ in range(NEWTON_ITERATIONS):
        ax, ay, az, found = midpoint_newton_step(ix, iy, iz, wx, wy, wz, tx, ty, tz, h, ax, ay, az)
        if found:
            break
    return ax, ay, az


@inlined
def is_slow(wx, wy, wz, h):
    """Whether fixed-point iterations solve the midpoint rule: each reduces the error by a factor of h |w|."""
    return (wx * wx + wy * wy + wz * wz) * h * h < SLOW


@inlined
def midpoint_fixed_point(ix, iy, iz, wx, wy, wz, tx, ty, tz, h):
    """midpoint_angular_velocity where is_slow."""
    ux, uy, uz = h / ix, h / iy, h / iz
    gx, gy, gz = 0.25 * ux * (iz - iy), 0.25 * uy * (ix - iz), 0.25 * uz * (iy - ix)
    cx, cy, cz = wx + ux * tx, wy + uy * ty, wz + uz * tz
    ax, ay, az = cx, cy, cz
    for _ in range(4):
        mx, my, mz = ax + wx, ay + wy, az + wz
        ax, ay, az = cx - gx * my * mz, cy - gy * mz * mx, cz - gz * mx * my
    return ax, ay, az


@inlined
def midpoint_newton_step(ix, iy, iz, wx, wy, wz, tx, ty, tz, h, ax, ay, az):
    """One Newton step from the estimate a towards the solution of midpoint_angular_velocity. Returns the new estimate,
    or a itself if it has converged, and whether it has."""
    ux, uy, uz = h / ix, h / iy, h / iz
    gx, gy, gz = 0.25 * ux * (iz - iy), 0.25 * uy * (ix - iz), 0.25 * uz * (iy - ix)
    mx, my, mz = ax + wx, ay + wy, az + wz
    fx, fy, fz = (ax - (wx + ux * tx) + gx * my * mz, ay - (wy + uy * ty) + gy * mz * mx,
                  az - (wz + uz * tz) + gz * mx * my)
    dx, dy, dz = _newton_step(ix, iy, iz, 0.25 * h * mx, 0.25 * h * my, 0.25 * h * mz, ix * fx, iy * fy, iz * fz)
    found = fx * fx + fy * fy + fz * fz < CONVERGED * (wx * wx + wy * wy + wz * wz)
    return ax if found else ax - dx, ay if found else ay - dy, az if found else az - dz, found


@inlined
def cayley(x, y, z, w, wx, wy, wz, h):
    """Orientation (x, y, z, w) after h s at the angular velocity (wx, wy, wz), rad/s in the body frame, by the Cayley
    map.

    With the mean angular velocity of midpoint_angular_velocity, the angular momentum in the world is conserved exactly.
    """
    nx, ny, nz, nw = multiply(x, y, z, w, 0.5 * h * wx, 0.5 * h * wy, 0.5 * h * wz, 1.0)
    return normalized(nx, ny, nz, nw)


@inlined
def to_body(orientation, i, x, y, z):
    """Rotates a vector from the world frame into the frame of body i."""
    return rotate(-orientation[i, 0], -orientation[i, 1], -orientation[i, 2], orientation[i, 3], x, y, z)


@inlined
def to_world(orientation, i, x, y, z):
    """Rotates a vector from the frame of body i into the world frame."""
    return rotate(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3], x, y, z)


@inlined
def integrate_velocities_euler(bodies, states, forces, h):
    """Velocities after h s of force and torque: semi-implicit Euler."""
    orientation, angular_velocity, inertia, torque = (states.orientation, states.angular_velocity, forces.inertia,
                                                      forces.torque)
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        for c in range(3):
            states.velocity[i, c] += h * forces.inverse_mass[i] * forces.force[i, c]
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        angular_velocity[i, 0], angular_velocity[i, 1], angular_velocity[i, 2] = euler_angular_velocity(
            m, inertia[i, 0], inertia[i, 1], inertia[i, 2],
            angular_velocity[i, 0], angular_velocity[i, 1], angular_velocity[i, 2],
            torque[i, 0], torque[i, 1], torque[i, 2], h)


@inlined
def integrate_velocities_midpoint(bodies, states, forces, h):
    """Velocities after h s of force and torque: midpoint rule, at the orientation as it is."""
    for k in range(1, 1 + bodies[0]):
        integrate_velocity_midpoint(bodies[k], states, forces, h)


@inlined
def integrate_velocity_midpoint(i, states, forces, h):
    """The same for body i."""
    orientation, angular_velocity, inertia, torque = (states.orientation, states.angular_velocity, forces.inertia,
                                                      forces.torque)
    for c in range(3):
        states.velocity[i, c] += h * forces.inverse_mass[i] * forces.force[i, c]
    m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
    x, y, z = angular_velocity[i, 0], angular_velocity[i, 1], angular_velocity[i, 2]
    u, v, w = torque[i, 0], torque[i, 1], torque[i, 2]
    x, y, z = midpoint_angular_velocity(
        inertia[i, 0], inertia[i, 1], inertia[i, 2],
        m[0] * x + m[3] * y + m[6] * z, m[1] * x + m[4] * y + m[7] * z, m[2] * x + m[5] * y + m[8] * z,
        m[0] * u + m[3] * v + m[6] * w, m[1] * u + m[4] * v + m[7] * w, m[2] * u + m[5] * v + m[8] * w, h)
    angular_velocity[i, 0], angular_velocity[i, 1], angular_velocity[i, 2] = (
        m[0] * x + m[1] * y + m[2] * z, m[3] * x + m[4] * y + m[5] * z, m[6] * x + m[7] * y + m[8] * z)


@inlined
def integrate_poses(bodies, states, h):
    """Poses after h s at constant velocities, by the exponential map."""
    orientation, angular_velocity = states.orientation, states.angular_velocity
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        for c in range(3):
            states.position[i, c] += h * states.velocity[i, c]
        orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3] = integrate_rotation(
            orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3],
            angular_velocity[i, 0], angular_velocity[i, 1], angular_velocity[i, 2], h)


@inlined
def integrate_poses_midpoint(bodies, states, h):
    """Poses after h s at constant velocities, by the Cayley map, which needs no sine."""
    orientation, angular_velocity = states.orientation, states.angular_velocity
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        for c in range(3):
            states.position[i, c] += h * states.velocity[i, c]
        x, y, z, w = multiply(
            0.5 * h * angular_velocity[i, 0], 0.5 * h * angular_velocity[i, 1], 0.5 * h * angular_velocity[i, 2], 1.0,
            orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3] = normalized(x, y, z, w)


@inlined
def save_states(bodies, states, trial):
    """Copies the states of bodies to the first columns of trial (n, TRIAL_FIELDS)."""
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        for c in range(3):
            trial[i, POSITION + c], trial[i, VELOCITY + c] = states.position[i, c], states.velocity[i, c]
            trial[i, ANGULAR_VELOCITY + c] = states.angular_velocity[i, c]
        for c in range(4):
            trial[i, ORIENTATION + c] = states.orientation[i, c]


@inlined
def _restore_state(i, states, trial):
    """Copies the saved state of body i back."""
    for c in range(3):
        states.position[i, c], states.velocity[i, c] = trial[i, POSITION + c], trial[i, VELOCITY + c]
        states.angular_velocity[i, c] = trial[i, ANGULAR_VELOCITY + c]
    for c in range(4):
        states.orientation[i, c] = trial[i, ORIENTATION + c]


@inlined
def _rotate_cayley(i, orientation, wx, wy, wz, h):
    """Changes the orientation of body i by the Cayley map."""
    orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3] = cayley(
        orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3], wx, wy, wz, h)


@inlined
def midpoint_predict(bodies, states, forces, trial, h):
    """First half of the midpoint scheme: the states half a step ahead, from the forces at the start; the start is
    saved."""
    save_states(bodies, states, trial)
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        for c in range(3):
            states.position[i, c] += 0.5 * h * states.velocity[i, c]
        integrate_velocity_midpoint(i, states, forces, 0.5 * h)
        wx, wy, wz = to_body(states.orientation, i, trial[i, ANGULAR_VELOCITY], trial[i, ANGULAR_VELOCITY + 1],
                             trial[i, ANGULAR_VELOCITY + 2])
        _rotate_cayley(i, states.orientation, wx, wy, wz, 0.5 * h)


@inlined
def midpoint_correct(bodies, states, forces, trial, h):
    """Second half: the states after h s from the saved start, with the forces half a step ahead."""
    position, orientation = states.position, states.orientation
    velocity, angular_velocity = states.velocity, states.angular_velocity
    torque, inertia = forces.torque, forces.inertia
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        tx, ty, tz = to_body(orientation, i, torque[i, 0], torque[i, 1], torque[i, 2])
        _restore_state(i, states, trial)
        for c in range(3):
            start = velocity[i, c]
            velocity[i, c] += h * forces.inverse_mass[i] * forces.force[i, c]
            position[i, c] += 0.5 * h * (start + velocity[i, c])
        ax, ay, az = to_body(orientation, i, angular_velocity[i, 0], angular_velocity[i, 1], angular_velocity[i, 2])
        bx, by, bz = midpoint_angular_velocity(inertia[i, 0], inertia[i, 1], inertia[i, 2], ax, ay, az, tx, ty, tz, h)
        _rotate_cayley(i, orientation, 0.5 * (ax + bx), 0.5 * (ay + by), 0.5 * (az + bz), h)
        angular_velocity[i, 0], angular_velocity[i, 1], angular_velocity[i, 2] = to_world(orientation, i, bx, by, bz)


@inlined
def rk4_stage(stage, bodies, states, forces, trial, h):
    """Stage 0 to 3 of the classical Runge-Kutta scheme, with the forces at the states of that stage.

    Adds the slopes to their weighted sum in trial, and sets the states of the next stage; those of stage 3 are the
    result. States are to be saved in trial before stage 0. The angular velocity is integrated in the body frame
    (Euler's equations), and kept in that frame in trial.
    """
    weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
    ahead = 0.5 * h if stage < 2 else h
    position, orientation = states.position, states.orientation
    velocity, angular_velocity = states.velocity, states.angular_velocity
    torque, inertia = forces.torque, forces.inertia
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        q, w, t = orientation[i], angular_velocity[i], trial[i]
        if stage == 0:
            (t[ANGULAR_VELOCITY], t[ANGULAR_VELOCITY + 1], t[ANGULAR_VELOCITY + 2]) = to_body(
                orientation, i, w[0], w[1], w[2])
        wx, wy, wz = to_body(orientation, i, w[0], w[1], w[2])
        tx, ty, tz = to_body(orientation, i, torque[i, 0], torque[i, 1], torque[i, 2])
        ix, iy, iz = inertia[i, 0], inertia[i, 1], inertia[i, 2]
        ax = (tx + wy * wz * (iy - iz)) / ix
        ay = (ty + wz * wx * (iz - ix)) / iy
        az = (tz + wx * wy * (ix - iy)) / iz
        # q' = q (w / 2, 0). Not `multiply`, whose zero terms would change the sign of zeros.
        ux, uy, uz = 0.5 * wx, 0.5 * wy, 0.5 * wz
        px, py, pz = (q[3] * ux + q[1] * uz - q[2] * uy, q[3] * uy + q[2] * ux - q[0] * uz,
                      q[3] * uz + q[0] * uy - q[1] * ux)
        pw = -ux * q[0] - uy * q[1] - uz * q[2]
        slope = (velocity[i, 0], velocity[i, 1], velocity[i, 2], px, py, pz, pw,
                 forces.inverse_mass[i] * forces.force[i, 0], forces.inverse_mass[i] * forces.force[i, 1],
                 forces.inverse_mass[i] * forces.force[i, 2], ax, ay, az)
        for c in range(SLOPES):
            t[SLOPES + c] = weight * slope[c] + (t[SLOPES + c] if stage else 0.0)
        for c in range(3):
            position[i, c] = _next(stage, ahead, slope, t, POSITION + c)
            velocity[i, c] = _next(stage, ahead, slope, t, VELOCITY + c)
            w[c] = _next(stage, ahead, slope, t, ANGULAR_VELOCITY + c)
        square = 0.0
        for c in range(4):
            q[c] = _next(stage, ahead, slope, t, ORIENTATION + c)
            square += q[c] * q[c]
        scale = 1.0 / math.sqrt(square)
        for c in range(4):
            q[c] *= scale
        w[0], w[1], w[2] = to_world(orientation, i, w[0], w[1], w[2])


@inlined
def _next(stage, ahead, slope, t, c):
    """Column c of a body's next state: `ahead` s from the start along the slope, or by the sum of slopes after stage
    3."""
    return t[c] + (ahead * slope[c] if stage < 3 else t[SLOPES + c])
