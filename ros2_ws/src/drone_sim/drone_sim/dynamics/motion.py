"""The stage that moves all bodies by one step: sub-steps of forces, contacts and motion, by the scheme of the scene.

Bodies near no other are free: the scheme carries them, asking for forces as often as it needs. Those in contact are
held: forces push them once a sub-step, the solver meets the contacts, and they move.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from drone_sim.arrays import Integers
from drone_sim.collision.manifold import Manifolds
from drone_sim.dynamics.bounce import aim, note, throw
from drone_sim.dynamics.constraints import HEAD, ROW, inverse_inertia, prepare, take_back
from drone_sim.dynamics.integrators import (
    cayley, move, moved, push_euler, push_midpoint, spun_midpoint, to_body, to_world,
)
from drone_sim.dynamics.solver import follow, solve, warm_start
from drone_sim.effects import Setting
from drone_sim.kernel import kernel
from drone_sim.program import Program, run_once
from drone_sim.stage import Stage


@kernel
def sort_out(awake, count, pair, free, held, mark):
    """Writes which of the bodies awake are free and which are held: (n + 1,), how many and which."""
    for k in range(1, 1 + awake[0]):
        mark[awake[k]] = False
    for i in range(count):
        mark[pair[i, 0]] = mark[pair[i, 1]] = True
    free[0] = held[0] = 0
    for k in range(1, 1 + awake[0]):
        which = held if mark[awake[k]] else free
        which[0] += 1
        which[which[0]] = awake[k]


@kernel
def ready(held, position, orientation, inertia, start, tensor):
    """Keeps where the held bodies start, and their inverse inertia in the world."""
    for k in range(1, 1 + held[0]):
        i = held[k]
        for c in range(3):
            start[i, c] = position[i, c]
        for c in range(4):
            start[i, 3 + c] = orientation[i, c]
        inverse_inertia(i, orientation, inertia, tensor)


@kernel
def meet(held, count, pair, points, normal, anchor, head, row, position, orientation, velocity, angular, inverse_mass,
         force, start, shift, pressed_on, bouncing, h, second_order):
    """Contacts and motion of the held bodies in a sub-step, once forces have pushed them."""
    if bouncing:
        aim(count, pair, points, head, row, velocity, angular, h)
    for k in range(1, 1 + held[0]):
        pressed_on[held[k]] = False
    warm_start(count, pair, points, head, row, velocity, angular)
    solve(count, pair, points, head, row, velocity, angular, pressed_on, h, True)
    for k in range(1, 1 + held[0]):
        i = held[k]
        move(i, position, orientation, velocity, angular, h)
        if second_order and not pressed_on[i]:  # it only fell
            for c in range(3):
                position[i, c] -= 0.5 * h * h * inverse_mass[i] * force[i, c]
        moved(i, position, orientation, start, shift)
    follow(count, pair, points, normal, anchor, shift, row)
    solve(count, pair, points, head, row, velocity, angular, pressed_on, h, False)
    if bouncing:
        throw(count, pair, points, head, row, velocity, angular)


@kernel
def semi_implicit_euler(function, address, clock, awake, end, pair, points, normal, anchor, separation, impulse,
                        friction, total, position, orientation, velocity, angular, force, torque, inverse_mass, inertia,
                        rough, springy, free, held, mark, start, shift, tensor, pressed_on, head, row, trial, substeps,
                        h):
    """First order: velocities from forces, then positions from the new velocities."""
    count = end[-1]
    if count > head.shape[0]:
        return count
    sort_out(awake, count, pair, free, held, mark)
    ready(held, position, orientation, inertia, start, tensor)
    prepare(0, count, pair, points, normal, anchor, separation, impulse, friction, inverse_mass, tensor, rough, springy,
            head, row)
    for sub in range(substeps):
        clock[0] = sub * h
        run_once(function, address)
        bouncing = note(count, pair, points, head, row, velocity, angular, h)
        for k in range(1, 1 + awake[0]):
            push_euler(awake[k], orientation, velocity, angular, inverse_mass, inertia, force, torque, h)
        for k in range(1, 1 + free[0]):
            move(free[k], position, orientation, velocity, angular, h)
        if count:
            meet(held, count, pair, points, normal, anchor, head, row, position, orientation, velocity, angular,
                 inverse_mass, force, start, shift, pressed_on, bouncing, h, False)
    take_back(count, points, head, row, impulse, friction, total)
    return 0


@kernel
def midpoint(function, address, clock, awake, end, pair, points, normal, anchor, separation, impulse, friction, total,
             position, orientation, velocity, angular, force, torque, inverse_mass, inertia, rough, springy, free, held,
             mark, start, shift, tensor, pressed_on, head, row, trial, substeps, h):
    """Second order: forces are those half a sub-step ahead; spin keeps energy and momentum (implicit midpoint rule)."""
    count = end[-1]
    if count > head.shape[0]:
        return count
    sort_out(awake, count, pair, free, held, mark)
    ready(held, position, orientation, inertia, start, tensor)
    prepare(0, count, pair, points, normal, anchor, separation, impulse, friction, inverse_mass, tensor, rough, springy,
            head, row)
    for sub in range(substeps):
        clock[0] = sub * h
        run_once(function, address)
        bouncing = note(count, pair, points, head, row, velocity, angular, h)
        for k in range(1, 1 + held[0]):
            push_midpoint(held[k], orientation, velocity, angular, inverse_mass, inertia, force, torque, h)
        if count:
            meet(held, count, pair, points, normal, anchor, head, row, position, orientation, velocity, angular,
                 inverse_mass, force, start, shift, pressed_on, bouncing, h, True)
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
            run_once(function, address)
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
    take_back(count, points, head, row, impulse, friction, total)
    return 0


@kernel
def keep_trial(i, position, orientation, velocity, angular, trial):
    """Keeps the state of body i in trial (n, 13) while others are tried."""
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


SCHEMES = {"semi_implicit_euler": semi_implicit_euler, "midpoint": midpoint}


class Motion:
    """The stage and its buffers."""

    def __init__(self, scheme: str, setting: Setting, acting: Program, manifolds: Callable[[], Manifolds],
                 substeps: int) -> None:
        n = setting.model.bodies.count
        self._setting, self._acting, self._manifolds = setting, acting, manifolds
        self._kernel, self._substeps, self._h = SCHEMES[scheme], substeps, setting.dt / substeps
        self._free, self._held = np.zeros((2, n + 1), np.int64)
        self._mark, self._pressed_on = np.zeros((2, n), np.bool_)
        self._start, self._shift, self._tensor, self._trial = (np.zeros((n, width)) for width in (7, 12, 6, 13))
        self._head, self._row = np.empty((64, HEAD)), np.empty((64, 8, ROW))

    @property
    def stage(self) -> Stage:
        return Stage("motion", self._kernel, self._arguments, self._grow)

    def belong_to(self, program: Program) -> None:
        """Tells which program to bind anew when arrays become others."""
        self._program = program

    def _grow(self, manifolds: int) -> str:
        self._head, self._row = np.empty((2 * manifolds, HEAD)), np.empty((2 * manifolds, 8, ROW))
        self._program.bind("motion")
        return "motion"

    def _arguments(self) -> tuple[Any, ...]:
        s, bodies, forces, m = self._setting.state, self._setting.model.bodies, self._setting.forces, self._manifolds()
        functions: Integers = self._acting.function
        return (functions, self._acting.row, forces.clock, s.awake, m.end, m.pair, m.points, m.normal_w, m.anchor_w,
                m.separation, m.impulse, m.friction, m.total, s.position_w, s.orientation_w, s.velocity_w,
                s.angular_velocity_w, forces.force_w, forces.torque_w, bodies.inverse_mass, bodies.inertia_b,
                bodies.friction, bodies.restitution, self._free, self._held, self._mark, self._start, self._shift,
                self._tensor, self._pressed_on, self._head, self._row, self._trial, self._substeps, self._h)
