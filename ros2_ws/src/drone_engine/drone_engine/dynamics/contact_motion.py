"""Bodies in contact: who they are, and how a sub-step moves them once forces have pushed them."""

import math

from drone_engine.dynamics.contact_constraints import colour, enter, group, inverse_inertia, work_out
from drone_engine.dynamics.contact_solver import PRESSED, WAY, press_apart, relax, warm_start
from drone_engine.dynamics.integrators import move, move_midpoint, moved
from drone_engine.dynamics.restitution import aim, throw
from drone_engine.kernel import kernel

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
def begin(count, pair, points, normal, anchor, separation, impulse, friction, position, orientation, velocity, angular,
          inverse_mass, inertia, radius, rough, springy, held, start, tensor, moving, hurried, used, colours, size,
          unit, body, table):
    """Gets the contacts ready for the sub-steps; returns how many groups they make, -g where there is no room for so
    many."""
    ready(held, position, orientation, velocity, angular, inertia, radius, start, tensor, moving, hurried)
    colour(count, pair, points, inverse_mass, used, size[0], colours)
    groups = group(count, colours, size[0], size[1], unit)
    if groups > unit.shape[0]:
        return -groups
    enter(groups, unit, position.shape[0], pair, points, normal, anchor, separation, impulse, friction, inverse_mass,
          tensor, rough, springy, hurried, body, table)
    work_out(groups, table)
    return groups
