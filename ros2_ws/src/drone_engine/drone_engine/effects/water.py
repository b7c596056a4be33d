"""Water: buoyancy, drag and added mass of the part of each box below the surface, the plane z = `level`.

Buoyancy is the weight of the water displaced (Archimedes), exact for a box in any pose, at the centroid of the
submerged part. Drag is linear and quadratic (Fossen 2011, Handbook of Marine Craft Hydrodynamics, 6.4):
F = -(k rho V + 1/2 rho C A |v|) v, with V the submerged volume and A the box's projected area along its velocity,
scaled by the submerged share of the volume; k damps rotation likewise. The added mass is c rho V (DNV-RP-C205, table
D-2; 0.68 for a cube); the moments of inertia grow in the same proportion. There are no waves. Gravity is the scene's:
without it nothing floats.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from drone_engine.context import Context, Stages
from drone_engine.effects import STABLE, weight
from drone_engine.effects.submerged import ROWS, submerged
from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix
from drone_engine.scene.fields import Place, Strict

Speed = Annotated[float, Field(ge=-100.0, le=100.0)]


class Parameters(Strict):
    """Keys of the effect in a scene file."""

    level: Place = 0.0  # m, of the surface
    density: float = Field(1025.0, gt=0.0, le=20000.0)  # kg/m^3; sea water, 998 for fresh water
    coefficient: float = Field(1.0, ge=0.0, le=10.0)  # of quadratic drag; about 1.05 for a cube
    damping: float = Field(0.5, ge=0.0, le=100.0)  # 1/s, of the displaced water's momentum
    added_mass: float = Field(0.68, ge=0.1, le=10.0)  # per displaced mass; default: a cube's
    current: tuple[Speed, Speed, Speed] = (0.0, 0.0, 0.0)  # m/s


class Sea(NamedTuple):
    """The water, SI units."""

    level: float  # m, of the surface
    density: float  # kg/m^3
    gravity: float  # m/s^2
    drag: float  # C / 2
    damping: float  # 1/s
    added_mass: float  # per mass of displaced water
    current_x: float  # m/s, world
    current_y: float
    current_z: float


@kernel
def float_up(awake, position, orientation, velocity, angular_velocity, half, mass, body_inertia, sea, h, scratch,
             force, torque, inverse_mass, inertia):
    """Adds buoyancy and drag to force (N) and torque (N m), (n, 3), and writes inverse_mass (n,) and inertia (n, 3)
    with the added mass of the water. half: (n, 3) m; body_inertia: (n, 3) kg m^2 without water; sea: Sea; h: s of a
    sub-step; scratch: (ROWS, 3)."""
    level, density, gravity, drag = sea.level, sea.density, sea.gravity, sea.drag
    damping, added = sea.damping, sea.added_mass
    cx, cy, cz = sea.current_x, sea.current_y, sea.current_z
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        inverse_mass[i] = 1.0 / mass[i]
        for c in range(3):
            inertia[i, c] = body_inertia[i, c]
        ball = math.sqrt(half[i, 0] ** 2 + half[i, 1] ** 2 + half[i, 2] ** 2)
        if position[i, 2] - ball >= level:
            continue
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        volume, px, py, pz = submerged(m, half[i], level - position[i, 2], scratch)
        if volume == 0.0:
            continue
        whole = 8.0 * half[i, 0] * half[i, 1] * half[i, 2]
        under, water = volume / whole, density * volume
        more = 1.0 + added * water / mass[i]  # ratio to the mass of the body alone
        inverse_mass[i] /= more
        for c in range(3):
            inertia[i, c] *= more

        wx, wy, wz = angular_velocity[i, 0], angular_velocity[i, 1], angular_velocity[i, 2]
        vx = velocity[i, 0] + wy * pz - wz * py - cx
        vy = velocity[i, 1] + wz * px - wx * pz - cy
        vz = velocity[i, 2] + wx * py - wy * px - cz
        area_speed = 0.0
        for c in range(3):
            face = 4.0 * half[i, (c + 1) % 3] * half[i, (c + 2) % 3]
            area_speed += face * abs(m[c] * vx + m[3 + c] * vy + m[6 + c] * vz)
        least = min(body_inertia[i, 0], min(body_inertia[i, 1], body_inertia[i, 2]))
        felt = more / (1.0 / mass[i] + (px * px + py * py + pz * pz) / least)  # effective mass at that point
        # Limited, so that it does not reverse the motion of that point within a sub-step.
        rate = min(damping * water + drag * density * under * area_speed, STABLE * felt / h)
        fx, fy, fz = -rate * vx, -rate * vy, water * gravity - rate * vz
        force[i, 0] += fx
        force[i, 1] += fy
        force[i, 2] += fz

        spin = min(damping * water / mass[i], STABLE * more / h)
        bx = spin * body_inertia[i, 0] * (m[0] * wx + m[3] * wy + m[6] * wz)
        by = spin * body_inertia[i, 1] * (m[1] * wx + m[4] * wy + m[7] * wz)
        bz = spin * body_inertia[i, 2] * (m[2] * wx + m[5] * wy + m[8] * wz)
        torque[i, 0] += py * fz - pz * fy - (m[0] * bx + m[1] * by + m[2] * bz)
        torque[i, 1] += pz * fx - px * fz - (m[3] * bx + m[4] * by + m[5] * bz)
        torque[i, 2] += px * fy - py * fx - (m[6] * bx + m[7] * by + m[8] * bz)


def build(parameters: Parameters, context: Context) -> Stages:
    """The stages of this effect."""
    p = parameters
    if not context.model.bodies.movable.any():
        return Stages(idle="nothing in the scene moves")
    sea = Sea(p.level, p.density, weight(context.active), 0.5 * p.coefficient, p.damping, p.added_mass, *p.current)
    return Stages(force=(context.stage("water", float_up, sea=sea, scratch=np.empty((ROWS, 3))),))
