"""The motion of all bodies in one step: one kernel for each `integrator` that a scene may choose.

Collision detection has found the contacts before. A body without any is unconstrained in this step: the integrator
evaluates forces as often as it needs and moves it. Bodies in contact are accelerated by the forces once per sub-step;
then the contact solver changes their velocities, and they move.

Parameters of the integrators: force_program, substep_program, the compiled stages that evaluate forces, and those that
run at the beginning of each sub-step; contacts, ContactArrays, in and out; awake, list of the bodies that move (their
number, then their indices); states, BodyStates, in and out; forces, Forces, which force_program writes; friction,
restitution, (n,) coefficients of the bodies; solver, SolverArrays; buffers, MotionBuffers; substeps of h s; iterations
of the contact solver per sub-step, at most. They return 0, or before anything has changed a code: the number of
manifolds if buffers has room for fewer, or minus the number of groups if solver has.
"""

from drone_engine.dynamics.contact_motion import load_velocities, partition, prepare_contacts, solve_and_move
from drone_engine.dynamics.integrators import (
    integrate_poses,
    integrate_velocities_euler,
    integrate_velocities_midpoint,
    midpoint_correct,
    midpoint_predict,
    rk4_stage,
    save_states,
)
from drone_engine.dynamics.prepare import store_impulses
from drone_engine.dynamics.restitution import mark_impacts
from drone_engine.kernel import inlined, kernel
from drone_engine.program.program import run_once


@kernel
def semi_implicit_euler(force_program, substep_program, contacts, awake, states, forces, friction, restitution, solver,
                        buffers, substeps, iterations, h):
    """Moves all bodies by one step, first order: velocities from forces, then poses from the new velocities."""
    groups, code = _begin_step(contacts, awake, states, forces, friction, restitution, solver, buffers)
    if code != 0:
        return code
    for substep in range(substeps):
        impacts = _begin_substep(substep * h, h, force_program, substep_program, groups, states, forces, solver,
                                 buffers)
        integrate_velocities_euler(awake, states, forces, h)
        integrate_poses(buffers.unconstrained, states, h)
        if groups:
            solve_and_move(groups, impacts, states, forces, solver, buffers, h, iterations, False)
    if groups:
        store_impulses(groups, solver, contacts)
    return 0


@kernel
def midpoint(force_program, substep_program, contacts, awake, states, forces, friction, restitution, solver, buffers,
             substeps, iterations, h):
    """Moves all bodies by one step, second order: forces on unconstrained bodies are those half a sub-step ahead.
    Rotation conserves energy and angular momentum (implicit midpoint rule)."""
    groups, code = _begin_step(contacts, awake, states, forces, friction, restitution, solver, buffers)
    if code != 0:
        return code
    for substep in range(substeps):
        impacts = _begin_substep(substep * h, h, force_program, substep_program, groups, states, forces, solver,
                                 buffers)
        if groups:
            integrate_velocities_midpoint(buffers.in_contact, states, forces, h)
            solve_and_move(groups, impacts, states, forces, solver, buffers, h, iterations, True)
        if buffers.unconstrained[0]:
            midpoint_predict(buffers.unconstrained, states, forces, buffers.trial, h)
            forces.time_in_step[0] = (substep + 0.5) * h
            run_once(force_program)
            midpoint_correct(buffers.unconstrained, states, forces, buffers.trial, h)
    if groups:
        store_impulses(groups, solver, contacts)
    return 0


@kernel
def rk4(force_program, substep_program, contacts, awake, states, forces, friction, restitution, solver, buffers,
        substeps, iterations, h):
    """Moves all bodies by one step, fourth order: the classical Runge-Kutta scheme. Bodies in contact as in
    midpoint."""
    groups, code = _begin_step(contacts, awake, states, forces, friction, restitution, solver, buffers)
    if code != 0:
        return code
    for substep in range(substeps):
        impacts = _begin_substep(substep * h, h, force_program, substep_program, groups, states, forces, solver,
                                 buffers)
        if groups:
            integrate_velocities_midpoint(buffers.in_contact, states, forces, h)
            solve_and_move(groups, impacts, states, forces, solver, buffers, h, iterations, True)
        if buffers.unconstrained[0]:
            save_states(buffers.unconstrained, states, buffers.trial)
            for stage in range(4):
                if stage:
                    forces.time_in_step[0] = (substep + (0.5 if stage < 3 else 1.0)) * h
                    run_once(force_program)
                rk4_stage(stage, buffers.unconstrained, states, forces, buffers.trial, h)
    if groups:
        store_impulses(groups, solver, contacts)
    return 0


@inlined
def _begin_step(contacts, awake, states, forces, friction, restitution, solver, buffers):
    """Lists the bodies by whether they are in contact, and prepares the contacts. Returns the number of groups, and the
    code of the step."""
    count = contacts.end[-1]
    if count > buffers.color.shape[0]:
        return 0, count
    partition(awake, count, contacts.pair, buffers.has_contact, buffers.unconstrained, buffers.in_contact)
    if count == 0:
        return 0, 0
    groups = prepare_contacts(count, contacts, states, forces, friction, restitution, solver, buffers)
    return groups, min(groups, 0)


@inlined
def _begin_substep(time, h, force_program, substep_program, groups, states, forces, solver, buffers):
    """Runs the stages of a sub-step and evaluates the forces. Returns whether points in contact are about to impact."""
    forces.time_in_step[0] = time
    run_once(substep_program)
    run_once(force_program)
    if groups == 0:
        return False
    load_velocities(buffers.in_contact, states, solver.motion)
    return mark_impacts(groups, solver, h)


INTEGRATORS = {"semi_implicit_euler": semi_implicit_euler, "midpoint": midpoint, "rk4": rk4}
