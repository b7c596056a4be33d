"""The stage that moves all bodies by one step: sub-steps of forces, contacts and motion, by the scheme of the scene.

Bodies near no other are free: the scheme carries them, asking for forces as often as it needs. Those in contact are
held: forces push them once a sub-step, the solver meets the contacts, and they move.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from drone_sim.arrays import Floats
from drone_sim.collision.manifold import Manifolds
from drone_sim.dynamics.bounce import aim, note, throw
from drone_sim.dynamics.constraints import COLOURS, colour, enter, group, inverse_inertia, tables, take_back, work_out
from drone_sim.dynamics.integrators import (
    cayley, move, move_midpoint, moved, push_euler, push_midpoint, runge_kutta, spun_midpoint, to_body, to_world,
)
from drone_sim.dynamics.solver import GATHERED, PRESSED, ROW, WAY, press_apart, relax, warm_start
from drone_sim.effects import Setting
from drone_sim.kernel import kernel
from drone_sim.program import Program, run_once
from drone_sim.stage import Stage

CALM = 0.25  # m/s, the fastest point of a body that is in no hurry


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
def ready(held, position, orientation, velocity, angular, inertia, radius, start, tensor, moving, hurried):
    """Keeps where the held bodies start, their inverse inertia in the world, and which are in a hurry."""
    for k in range(1, 1 + held[0]):
        i = held[k]
        square, turning = 0.0, 0.0
        for c in range(3):
            square += velocity[i, c] * velocity[i, c]
            turning += angular[i, c] * angular[i, c]
        hurried[i] = math.sqrt(square) + math.sqrt(turning) * radius[i] > CALM
        for c in range(3):
            start[i, c] = position[i, c]
        for c in range(4):
            start[i, 3 + c] = orientation[i, c]
        for c in range(WAY, PRESSED):
            moving[i, c] = 0.0
        moving[i, PRESSED - 1] = 0.5
        inverse_inertia(i, orientation, inertia, tensor)


@kernel
def take_speeds(held, velocity, angular, moving):
    """Velocities of the held bodies into their rows."""
    for k in range(1, 1 + held[0]):
        i = held[k]
        for c in range(3):
            moving[i, c], moving[i, 3 + c] = velocity[i, c], angular[i, c]


@kernel
def give_speeds(held, velocity, angular, moving):
    """And back."""
    for k in range(1, 1 + held[0]):
        i = held[k]
        for c in range(3):
            velocity[i, c], angular[i, c] = moving[i, c], moving[i, 3 + c]


@kernel
def meet(held, groups, body, table, position, orientation, velocity, angular, inverse_mass, force, start, moving,
         gathered, bouncing, h, passes, second_order):
    """Contacts and motion of the held bodies in a sub-step, once forces have pushed them."""
    take_speeds(held, velocity, angular, moving)
    if bouncing:
        aim(groups, body, table, moving, gathered, h)
    for k in range(1, 1 + held[0]):
        moving[held[k], PRESSED] = 0.0
    warm_start(groups, body, table, moving, gathered)
    press_apart(groups, body, table, moving, gathered, h, passes)
    give_speeds(held, velocity, angular, moving)
    for k in range(1, 1 + held[0]):
        i = held[k]
        if second_order:
            move_midpoint(i, position, orientation, velocity, angular, h)
            if moving[i, PRESSED] == 0.0:  # it only fell
                for c in range(3):
                    position[i, c] -= 0.5 * h * h * inverse_mass[i] * force[i, c]
        else:
            move(i, position, orientation, velocity, angular, h)
        moved(i, position, orientation, start, moving)
    relax(groups, body, table, moving, gathered, h, passes)
    if bouncing:
        throw(groups, body, table, moving, h)
    give_speeds(held, velocity, angular, moving)


@kernel
def begin(count, pair, points, normal, anchor, separation, impulse, friction, position, orientation, velocity,
          angular, inverse_mass, inertia, radius, rough, springy, held, start, tensor, moving, hurried, used, colours, size, unit, body, table):
    """Gets the contacts ready for the sub-steps; returns how many groups they make, -g if there is only room for less."""
    ready(held, position, orientation, velocity, angular, inertia, radius, start, tensor, moving, hurried)
    colour(count, pair, points, inverse_mass, used, size[0], colours)
    groups = group(count, colours, size[0], size[1], unit)
    if groups > unit.shape[0]:
        return -groups
    enter(groups, unit, position.shape[0], pair, points, normal, anchor, separation, impulse, friction, inverse_mass,
          tensor, rough, springy, hurried, body, table)
    work_out(groups, table)
    return groups


@kernel
def semi_implicit_euler(function, address, steer, steer_address, clock, awake, end, pair, points, normal, anchor,
                        separation, impulse, friction, total, position, orientation, velocity, angular, force, torque,
                        inverse_mass, inertia, radius, rough, springy, free, held, mark, start, tensor, moving,
                        gathered, hurried, used, colours, size, unit, body, table, trial, substeps, passes, h):
    """First order: velocities from forces, then positions from the new velocities."""
    count = end[-1]
    if count > colours.shape[0]:
        return count
    sort_out(awake, count, pair, free, held, mark)
    groups, bouncing = 0, False
    if count:
        groups = begin(count, pair, points, normal, anchor, separation, impulse, friction, position, orientation,
                       velocity, angular, inverse_mass, inertia, radius, rough, springy, held, start, tensor, moving,
                       hurried, used, colours, size, unit, body, table)
        if groups < 0:
            return groups
    for sub in range(substeps):
        clock[0] = sub * h
        run_once(steer, steer_address)
        run_once(function, address)
        if count:
            take_speeds(held, velocity, angular, moving)
            bouncing = note(groups, body, table, moving, gathered, h)
        for k in range(1, 1 + awake[0]):
            push_euler(awake[k], orientation, velocity, angular, inverse_mass, inertia, force, torque, h)
        for k in range(1, 1 + free[0]):
            move(free[k], position, orientation, velocity, angular, h)
        if count:
            meet(held, groups, body, table, position, orientation, velocity, angular, inverse_mass, force, start, moving,
                 gathered, bouncing, h, passes, False)
    if count:
        take_back(groups, unit, points, table, impulse, friction, total)
    return 0


@kernel
def midpoint(function, address, steer, steer_address, clock, awake, end, pair, points, normal, anchor, separation,
             impulse, friction, total, position, orientation, velocity, angular, force, torque, inverse_mass, inertia,
             radius, rough, springy, free, held, mark, start, tensor, moving, gathered, hurried, used, colours, size,
             unit, body, table, trial, substeps, passes, h):
    """Second order: forces are those half a sub-step ahead; spin keeps energy and momentum (implicit midpoint rule)."""
    count = end[-1]
    if count > colours.shape[0]:
        return count
    sort_out(awake, count, pair, free, held, mark)
    groups, bouncing = 0, False
    if count:
        groups = begin(count, pair, points, normal, anchor, separation, impulse, friction, position, orientation,
                       velocity, angular, inverse_mass, inertia, radius, rough, springy, held, start, tensor, moving,
                       hurried, used, colours, size, unit, body, table)
        if groups < 0:
            return groups
    for sub in range(substeps):
        clock[0] = sub * h
        run_once(steer, steer_address)
        run_once(function, address)
        if count:
            take_speeds(held, velocity, angular, moving)
            bouncing = note(groups, body, table, moving, gathered, h)
        for k in range(1, 1 + held[0]):
            push_midpoint(held[k], orientation, velocity, angular, inverse_mass, inertia, force, torque, h)
        if count:
            meet(held, groups, body, table, position, orientation, velocity, angular, inverse_mass, force, start, moving,
                 gathered, bouncing, h, passes, True)
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
    if count:
        take_back(groups, unit, points, table, impulse, friction, total)
    return 0


@kernel
def rk4(function, address, clock, awake, end, pair, points, normal, anchor, separation, impulse, friction, total,
        position, orientation, velocity, angular, force, torque, inverse_mass, inertia, radius, rough, springy, free,
        held, mark, start, tensor, moving, gathered, hurried, used, colours, size, unit, body, table, trial, substeps,
        passes, h):
    """Fourth order: Runge and Kutta's classical scheme, on position, orientation, velocity and spin of free bodies."""
    count = end[-1]
    if count > colours.shape[0]:
        return count
    sort_out(awake, count, pair, free, held, mark)
    groups = begin(count, pair, points, normal, anchor, separation, impulse, friction, position, orientation,
                   velocity, angular, inverse_mass, inertia, radius, rough, springy, held, start, tensor, moving,
                   hurried, used, colours, size, unit, body, table)
    if groups < 0:
        return groups
    for sub in range(substeps):
        clock[0] = sub * h
        run_once(function, address)
        take_speeds(held, velocity, angular, moving)
        bouncing = note(groups, body, table, moving, gathered, h)
        for k in range(1, 1 + held[0]):
            push_midpoint(held[k], orientation, velocity, angular, inverse_mass, inertia, force, torque, h)
        if count:
            meet(held, groups, body, table, position, orientation, velocity, angular, inverse_mass, force, start, moving,
                 gathered, bouncing, h, passes, True)
        if free[0]:
            for k in range(1, 1 + free[0]):
                keep_trial(free[k], position, orientation, velocity, angular, trial)
            for stage in range(4):
                if stage:
                    clock[0] = (sub + (0.5 if stage < 3 else 1.0)) * h
                    run_once(function, address)
                for k in range(1, 1 + free[0]):
                    runge_kutta(stage, free[k], position, orientation, velocity, angular, inverse_mass, inertia, force,
                                torque, trial, h)
    take_back(groups, unit, points, table, impulse, friction, total)
    return 0


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


SCHEMES = {"semi_implicit_euler": semi_implicit_euler, "midpoint": midpoint, "rk4": rk4}


class Motion:
    """The stage and its buffers."""

    def __init__(self, scheme: str, setting: Setting, acting: Program, steering: Program,
                 manifolds: Callable[[], Manifolds], passes: int) -> None:
        n = setting.model.bodies.count
        self._setting, self._acting, self._steering, self._manifolds = setting, acting, steering, manifolds
        self._kernel, self._passes, self._h = SCHEMES[scheme], passes, setting.dt / setting.substeps
        self._free, self._held = np.zeros((2, n + 1), np.int64)
        self._mark, self._hurried, self._used = *np.zeros((2, n), np.bool_), np.zeros((n, 2), np.int64)
        self._radius: Floats = np.linalg.norm(setting.model.bodies.half, axis=1)
        self._start, self._tensor, self._trial = (np.zeros((n, width)) for width in (7, 6, 26))
        self._moving, self._gathered = np.zeros((n + 1, ROW)), np.zeros(GATHERED)  # one row for nobody
        self._moving[:, PRESSED - 1] = 0.5
        self._size = np.empty((2, COLOURS), np.int64)
        self._colours = np.empty((64, 2), np.int64)
        self._tables = tables(32)

    @property
    def stage(self) -> Stage:
        return Stage("motion", self._kernel, self._arguments, self._grow)

    def belong_to(self, program: Program) -> None:
        """Tells which program to bind anew when arrays become others."""
        self._program = program

    def _grow(self, code: int) -> str:
        if code > 0:
            self._colours = np.empty((2 * code, 2), np.int64)
        else:
            self._tables = tables(-2 * code)
        self._program.bind("motion")
        return "motion"

    def _arguments(self) -> tuple[Any, ...]:
        s, bodies, forces, m = self._setting.state, self._setting.model.bodies, self._setting.forces, self._manifolds()
        acting, steering = self._acting, self._steering
        return (acting.function, acting.row, steering.function, steering.row, forces.clock, s.awake, m.end, m.pair,
                m.points, m.normal_w, m.anchor_w, m.separation, m.impulse, m.friction, m.total, s.position_w,
                s.orientation_w, s.velocity_w, s.angular_velocity_w, forces.force_w, forces.torque_w,
                bodies.inverse_mass, bodies.inertia_b, self._radius, bodies.friction, bodies.restitution, self._free,
                self._held, self._mark, self._start, self._tensor, self._moving, self._gathered, self._hurried,
                self._used, self._colours, self._size, *self._tables, self._trial, self._setting.substeps,
                self._passes, self._h)
