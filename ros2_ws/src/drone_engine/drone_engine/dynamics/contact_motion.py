"""Motion of the bodies in contact: which they are, and how a sub-step solves their contacts and moves them."""

from typing import NamedTuple

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.dynamics.contact_solver import relax, solve, warm_start
from drone_engine.dynamics.contact_table import (
    ANGULAR_VELOCITY,
    LOADED,
    ROTATION,
    ROTATION_FACTOR,
    TRANSLATION,
)
from drone_engine.dynamics.grouping import assign_colors, assign_lanes
from drone_engine.dynamics.integrators import integrate_poses, integrate_poses_midpoint
from drone_engine.dynamics.prepare import prepare, write_inverse_inertia
from drone_engine.dynamics.restitution import apply_restitution, set_target_velocities
from drone_engine.kernel import kernel
from drone_engine.math.rigid_motion import max_point_speed
from drone_engine.math.rotation import multiply

RIGID_SPEED = 0.25  # m/s: contacts of bodies of which no point is faster are rigid, others soft


class MotionBuffers(NamedTuple):
    """Buffers of the motion of n bodies with room for m manifolds. Lists of bodies: their number, then their
    indices."""

    radius: Floats  # (n,) m, of the bounding spheres
    unconstrained: Integers  # (n + 1,) list of the awake bodies without a manifold
    in_contact: Integers  # (n + 1,) list of the awake bodies with one
    has_contact: Booleans  # (n,) scratch
    fast: Booleans  # (n,) whether a body may be faster than RIGID_SPEED
    start: Floats  # (n, 7) pose at the beginning of the step: x y z, quaternion
    inverse_inertia: Floats  # (n, 6) 1/(kg m^2), world frame: xx xy xz yy yz zz; 0 for bodies that do not move
    used_colors: Integers  # (n, 2) scratch, 0 between steps
    color: Integers  # (m, 2) color of each constraint
    color_size: Integers  # (2, COLORS) constraints of each color; scratch
    trial: Floats  # (n, TRIAL_FIELDS) scratch of the integrators


@kernel
def partition(awake, count, pair, has_contact, unconstrained, in_contact):
    """Lists the bodies that are awake as unconstrained or in contact.

    awake: list; pair: (m, 2), of which the first `count` are manifolds; has_contact: (n,) scratch. Out: the two lists.
    """
    for k in range(1, 1 + awake[0]):
        has_contact[awake[k]] = False
    for i in range(count):
        has_contact[pair[i, 0]] = has_contact[pair[i, 1]] = True
    unconstrained[0] = in_contact[0] = 0
    for k in range(1, 1 + awake[0]):
        bodies = in_contact if has_contact[awake[k]] else unconstrained
        bodies[0] += 1
        bodies[bodies[0]] = awake[k]


@kernel
def prepare_bodies(states, inertia, motion, buffers):
    """Prepares the bodies in contact: whether they are fast, their inverse inertia, and their start, from which the
    displacement counts. motion: of SolverArrays."""
    start = buffers.start
    for k in range(1, 1 + buffers.in_contact[0]):
        i = buffers.in_contact[k]
        speed = max_point_speed(i, states.velocity, states.angular_velocity, buffers.radius[i])
        buffers.fast[i] = speed > RIGID_SPEED
        for c in range(3):
            start[i, c] = states.position[i, c]
        for c in range(4):
            start[i, 3 + c] = states.orientation[i, c]
        for c in range(TRANSLATION, LOADED):
            motion[i, c] = 0.0
        motion[i, ROTATION_FACTOR] = 0.5
        write_inverse_inertia(i, states.orientation, inertia, buffers.inverse_inertia)


@kernel
def prepare_contacts(count, contacts, states, forces, friction, restitution, solver, buffers):
    """Prepares the contacts of a step. Returns the number of groups, or its negative if solver has room for fewer."""
    prepare_bodies(states, forces.inertia, solver.motion, buffers)
    size, place = buffers.color_size[0], buffers.color_size[1]
    assign_colors(count, contacts.pair, contacts.points, forces.inverse_mass, buffers.used_colors, size, buffers.color)
    groups = assign_lanes(count, buffers.color, size, place, solver.constraint)
    if groups > solver.constraint.shape[0]:
        return -groups
    prepare(groups, solver, contacts, forces.inverse_mass, friction, restitution, buffers.fast,
            buffers.inverse_inertia)
    return groups


@kernel
def load_velocities(bodies, states, motion):
    """Copies the velocities of a list of bodies to their rows of motion, of SolverArrays."""
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        for c in range(3):
            motion[i, c] = states.velocity[i, c]
            motion[i, ANGULAR_VELOCITY + c] = states.angular_velocity[i, c]


@kernel
def store_velocities(bodies, states, motion):
    """Copies them back."""
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        for c in range(3):
            states.velocity[i, c] = motion[i, c]
            states.angular_velocity[i, c] = motion[i, ANGULAR_VELOCITY + c]


@kernel
def update_displacements(bodies, states, start, motion):
    """Writes the displacements of a list of bodies from start (n, 7) to their rows of motion, of SolverArrays."""
    orientation = states.orientation
    for k in range(1, 1 + bodies[0]):
        i = bodies[k]
        for c in range(3):
            motion[i, TRANSLATION + c] = states.position[i, c] - start[i, c]
        x, y, z, w = multiply(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3],
                              -start[i, 3], -start[i, 4], -start[i, 5], start[i, 6])
        motion[i, ROTATION], motion[i, ROTATION + 1], motion[i, ROTATION + 2] = 2.0 * w * x, 2.0 * w * y, 2.0 * w * z
        motion[i, ROTATION_FACTOR] = 0.5 / max(w * w, 1e-12)  # 1 + cos = 2 w^2


@kernel
def solve_and_move(groups, impacts, states, forces, solver, buffers, h, iterations, second_order):
    """Solves the contacts and moves the bodies in contact by h s, once forces have changed their velocities.

    impacts: whether restitution.mark_impacts has marked any point; second_order: whether poses are integrated by the
    midpoint rule. A body that no contact pushes falls as exactly as an unconstrained one: its position is corrected for
    the velocity that the force has added, of which half counts.
    """
    bodies, motion = buffers.in_contact, solver.motion
    load_velocities(bodies, states, motion)
    if impacts:
        set_target_velocities(groups, solver, h)
    for k in range(1, 1 + bodies[0]):
        motion[bodies[k], LOADED] = 0.0
    warm_start(groups, solver)
    solve(groups, solver, h, iterations)
    store_velocities(bodies, states, motion)
    if second_order:
        integrate_poses_midpoint(bodies, states, h)
        for k in range(1, 1 + bodies[0]):
            i = bodies[k]
            if motion[i, LOADED] == 0.0:
                for c in range(3):
                    states.position[i, c] -= 0.5 * h * h * forces.inverse_mass[i] * forces.force[i, c]
    else:
        integrate_poses(bodies, states, h)
    update_displacements(bodies, states, buffers.start, motion)
    relax(groups, solver, h, iterations)
    if impacts:
        apply_restitution(groups, solver, h)
    store_velocities(bodies, states, motion)
