"""How a step is integrated: the kernels that a scene's `integrator` chooses from.

Bodies near no other are free: the scheme carries them, asking for forces as often as it needs. Those in contact are
held: forces push them once a sub-step, the solver meets the contacts, and they move.

Parameters of the three: force_program, substep_program: Compiled stages; contacts: ContactArrays; awake: (n + 1,);
state of n bodies in the world: position (n, 3) m, orientation (n, 4), velocity (n, 3) m/s, angular_velocity (n, 3)
rad/s, in and out; forces: Forces; friction, restitution: (n,) coefficients; solver: SolverArrays; substeps of length h
s; iterations: of the contact solver, at most. They return 0, or a code that `Motion` handles.
"""

from drone_engine.dynamics.contact_constraints import take_back
from drone_engine.dynamics.contact_motion import begin, meet, sort_out, take_speeds
from drone_engine.dynamics.integrators import (
    cayley,
    move,
    push_euler,
    push_midpoint,
    runge_kutta,
    spun_midpoint,
    to_body,
    to_world,
)
from drone_engine.dynamics.restitution import note
from drone_engine.kernel import kernel
from drone_engine.program.program import run_once


@kernel
def keep_trial(i, position, orientation, velocity, angular, trial):
    """Keeps the state of body i in the first half of trial (n, 26) while others are tried."""
    for c in range(3):
        trial[i, c], trial[i, 7 + c], trial[i, 10 + c] = position[i, c], velocity[i, c], angular[i, c]
    for c in range(4):
        trial[i, 3 + c] = orientation[i, c]


@kernel
def put_back(i, position, orientation, velocity, angular, trial):
    """The state of body i is again what it was."""
    for c in range(3):
        position[i, c], velocity[i, c], angular[i, c] = trial[i, c], trial[i, 7 + c], trial[i, 10 + c]
    for c in range(4):
        orientation[i, c] = trial[i, 3 + c]


@kernel
def semi_implicit_euler(force_program, substep_program, contacts, awake, position, orientation, velocity,
                        angular_velocity, forces, friction, restitution, solver, substeps, iterations, h):
    """First order: velocities from forces, then positions from the new velocities."""
    end, pair, points, normal, anchor = contacts.end, contacts.pair, contacts.points, contacts.normal, contacts.anchor
    separation, impulse, total = contacts.separation, contacts.impulse, contacts.total
    friction_impulse = contacts.friction_impulse
    force, torque, inverse_mass, inertia = forces.force, forces.torque, forces.inverse_mass, forces.inertia
    radius, free, held, mark, start, tensor = (solver.radius, solver.free, solver.held, solver.mark, solver.start,
                                               solver.tensor)
    moving, gathered, hurried, used = solver.moving, solver.gathered, solver.hurried, solver.used
    colours, size, unit, body, table = solver.colours, solver.size, solver.unit, solver.body, solver.table
    angular, clock = angular_velocity, forces.time_in_step
    count = end[-1]
    if count > colours.shape[0]:
        return count
    sort_out(awake, count, pair, free, held, mark)
    groups, bouncing = 0, False
    if count:
        groups = begin(count, pair, points, normal, anchor, separation, impulse, friction_impulse, position,
                       orientation, velocity, angular, inverse_mass, inertia, radius, friction, restitution, held,
                       start, tensor, moving, hurried, used, colours, size, unit, body, table)
        if groups < 0:
            return groups
    for sub in range(substeps):
        clock[0] = sub * h
        run_once(substep_program)
        run_once(force_program)
        if count:
            take_speeds(held, velocity, angular, moving)
            bouncing = note(groups, body, table, moving, gathered, h)
        for k in range(1, 1 + awake[0]):
            push_euler(awake[k], orientation, velocity, angular, inverse_mass, inertia, force, torque, h)
        for k in range(1, 1 + free[0]):
            move(free[k], position, orientation, velocity, angular, h)
        if count:
            meet(held, groups, body, table, position, orientation, velocity, angular, inverse_mass, force, start,
                 moving, gathered, bouncing, h, iterations, False)
    if count:
        take_back(groups, unit, points, table, impulse, friction_impulse, total)
    return 0


@kernel
def midpoint(force_program, substep_program, contacts, awake, position, orientation, velocity, angular_velocity,
             forces, friction, restitution, solver, substeps, iterations, h):
    """Second order: forces are those half a sub-step ahead; spin keeps energy and momentum (implicit midpoint rule)."""
    end, pair, points, normal, anchor = contacts.end, contacts.pair, contacts.points, contacts.normal, contacts.anchor
    separation, impulse, total = contacts.separation, contacts.impulse, contacts.total
    friction_impulse = contacts.friction_impulse
    force, torque, inverse_mass, inertia = forces.force, forces.torque, forces.inverse_mass, forces.inertia
    radius, free, held, mark, start, tensor = (solver.radius, solver.free, solver.held, solver.mark, solver.start,
                                               solver.tensor)
    moving, gathered, hurried, used = solver.moving, solver.gathered, solver.hurried, solver.used
    colours, size, unit, body, table = solver.colours, solver.size, solver.unit, solver.body, solver.table
    trial, angular, clock = solver.trial, angular_velocity, forces.time_in_step
    count = end[-1]
    if count > colours.shape[0]:
        return count
    sort_out(awake, count, pair, free, held, mark)
    groups, bouncing = 0, False
    if count:
        groups = begin(count, pair, points, normal, anchor, separation, impulse, friction_impulse, position,
                       orientation, velocity, angular, inverse_mass, inertia, radius, friction, restitution, held,
                       start, tensor, moving, hurried, used, colours, size, unit, body, table)
        if groups < 0:
            return groups
    for sub in range(substeps):
        clock[0] = sub * h
        run_once(substep_program)
        run_once(force_program)
        if count:
            take_speeds(held, velocity, angular, moving)
            bouncing = note(groups, body, table, moving, gathered, h)
        for k in range(1, 1 + held[0]):
            push_midpoint(held[k], orientation, velocity, angular, inverse_mass, inertia, force, torque, h)
        if count:
            meet(held, groups, body, table, position, orientation, velocity, angular, inverse_mass, force, start,
                 moving, gathered, bouncing, h, iterations, True)
        if free[0]:
            for k in range(1, 1 + free[0]):
                i = free[k]
                keep_trial(i, position, orientation, velocity, angular, trial)
                for c in range(3):
                    position[i, c] += 0.5 * h * velocity[i, c]
                push_midpoint(i, orientation, velocity, angular, inverse_mass, inertia, force, torque, 0.5 * h)
                wx, wy, wz = to_body(orientation, i, trial[i, 10], trial[i, 11], trial[i, 12])
                cayley(orientation, i, wx, wy, wz, 0.5 * h)
            clock[0] = (sub + 0.5) * h
            run_once(force_program)
            for k in range(1, 1 + free[0]):
                i = free[k]
                tx, ty, tz = to_body(orientation, i, torque[i, 0], torque[i, 1], torque[i, 2])
                put_back(i, position, orientation, velocity, angular, trial)
                for c in range(3):
                    old = velocity[i, c]
                    velocity[i, c] += h * inverse_mass[i] * force[i, c]
                    position[i, c] += 0.5 * h * (old + velocity[i, c])
                ax, ay, az = to_body(orientation, i, angular[i, 0], angular[i, 1], angular[i, 2])
                bx, by, bz = spun_midpoint(inertia[i, 0], inertia[i, 1], inertia[i, 2], ax, ay, az, tx, ty, tz, h)
                cayley(orientation, i, 0.5 * (ax + bx), 0.5 * (ay + by), 0.5 * (az + bz), h)
                angular[i, 0], angular[i, 1], angular[i, 2] = to_world(orientation, i, bx, by, bz)
    if count:
        take_back(groups, unit, points, table, impulse, friction_impulse, total)
    return 0


@kernel
def rk4(force_program, substep_program, contacts, awake, position, orientation, velocity, angular_velocity,
        forces, friction, restitution, solver, substeps, iterations, h):
    """Fourth order: Runge and Kutta's classical scheme, on position, orientation, velocity and spin of free bodies."""
    end, pair, points, normal, anchor = contacts.end, contacts.pair, contacts.points, contacts.normal, contacts.anchor
    separation, impulse, total = contacts.separation, contacts.impulse, contacts.total
    friction_impulse = contacts.friction_impulse
    force, torque, inverse_mass, inertia = forces.force, forces.torque, forces.inverse_mass, forces.inertia
    radius, free, held, mark, start, tensor = (solver.radius, solver.free, solver.held, solver.mark, solver.start,
                                               solver.tensor)
    moving, gathered, hurried, used = solver.moving, solver.gathered, solver.hurried, solver.used
    colours, size, unit, body, table = solver.colours, solver.size, solver.unit, solver.body, solver.table
    trial, angular, clock = solver.trial, angular_velocity, forces.time_in_step
    count = end[-1]
    if count > colours.shape[0]:
        return count
    sort_out(awake, count, pair, free, held, mark)
    groups, bouncing = 0, False
    if count:
        groups = begin(count, pair, points, normal, anchor, separation, impulse, friction_impulse, position,
                       orientation, velocity, angular, inverse_mass, inertia, radius, friction, restitution, held,
                       start, tensor, moving, hurried, used, colours, size, unit, body, table)
        if groups < 0:
            return groups
    for sub in range(substeps):
        clock[0] = sub * h
        run_once(substep_program)
        run_once(force_program)
        if count:
            take_speeds(held, velocity, angular, moving)
            bouncing = note(groups, body, table, moving, gathered, h)
        for k in range(1, 1 + held[0]):
            push_midpoint(held[k], orientation, velocity, angular, inverse_mass, inertia, force, torque, h)
        if count:
            meet(held, groups, body, table, position, orientation, velocity, angular, inverse_mass, force, start,
                 moving, gathered, bouncing, h, iterations, True)
        if free[0]:
            for k in range(1, 1 + free[0]):
                keep_trial(free[k], position, orientation, velocity, angular, trial)
            for stage in range(4):
                if stage:
                    clock[0] = (sub + (0.5 if stage < 3 else 1.0)) * h
                    run_once(force_program)
                for k in range(1, 1 + free[0]):
                    runge_kutta(stage, free[k], position, orientation, velocity, angular, inverse_mass, inertia, force,
                                torque, trial, h)
    if count:
        take_back(groups, unit, points, table, impulse, friction_impulse, total)
    return 0


SCHEMES = {"semi_implicit_euler": semi_implicit_euler, "midpoint": midpoint, "rk4": rk4}
