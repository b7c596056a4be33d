"""Ground effect, the additional thrust of rotors near the ground: T / T_inf = 1 / (1 - (R / 4 z)^2 / (1 + (V /
v_i)^2)).

Cheeseman, Bennett 1955, The Effect of the Ground on a Helicopter Rotor in Forward Flight (ARC R&M 3021), with z the
rotor's height, V its speed along the ground, and v_i = sqrt(T / (2 rho pi R^2)) from momentum theory. Rotors are
independent. Only the scene's floors and terrain count, no other objects. Measurements begin at z = R / 2, where the
gain is a third; it is constant below.
"""

import math

import numpy as np
from pydantic import Field

from drone_engine.collision.terrain.height_field import NO_GROUND, face_below, of_model
from drone_engine.context import Context, Stages
from drone_engine.effects.disks import disks
from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix
from drone_engine.scene.fields import Strict

CLOSEST = 0.5  # R, height below which the gain is constant


class Parameters(Strict):
    """Keys of the effect in a scene file."""

    density: float = Field(1.225, gt=0.0, le=2000.0)  # kg/m^3, of the air
    radius: float | None = Field(None, gt=0.0, le=100.0)  # m, of the rotors; default: the size of their models


@kernel
def gain(radius, height, speed, induced):
    """Relative increase of a rotor's thrust near the ground. radius, height: m; speed along the ground, induced
    velocity: m/s."""
    x = radius / (4.0 * max(height, CLOSEST * radius))
    ratio = speed / induced
    lost = x * x / (1.0 + ratio * ratio)
    return lost / (1.0 - lost)


@kernel
def lift(floors, height_field, disks, thrust, position, orientation, velocity, air_velocity, density, force, torque):
    """Adds the additional thrust of r rotors near the ground to force (N) and torque (N m), (n, 3) in the world.

    floors: (f,) heights in m; height_field: HeightField of the terrain, or NO_GROUND; disks: the rotors; thrust: (r,)
    N; air_velocity: (n, 3) m/s, or (0, 3) where the air is at rest; density: kg/m^3.
    """
    body, place, axis, radius = disks.body, disks.place_b, disks.axis_b, disks.radius
    for r in range(body.shape[0]):
        if thrust[r] <= 0.0:
            continue
        i = body[r]
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        az = m[6] * axis[r, 0] + m[7] * axis[r, 1] + m[8] * axis[r, 2]
        if az <= 0.0:  # upside down, it blows upwards
            continue
        ax = m[0] * axis[r, 0] + m[1] * axis[r, 1] + m[2] * axis[r, 2]
        ay = m[3] * axis[r, 0] + m[4] * axis[r, 1] + m[5] * axis[r, 2]
        px = m[0] * place[r, 0] + m[1] * place[r, 1] + m[2] * place[r, 2]
        py = m[3] * place[r, 0] + m[4] * place[r, 1] + m[5] * place[r, 2]
        pz = m[6] * place[r, 0] + m[7] * place[r, 1] + m[8] * place[r, 2]
        height = math.inf
        for f in range(floors.shape[0]):
            above = position[i, 2] + pz - floors[f]
            if 0.0 <= above < height:
                height = above
        if height_field.grid.shape[0]:
            _, ground = face_below(height_field, position[i, 0] + px, position[i, 1] + py)
            above = position[i, 2] + pz - ground
            if 0.0 <= above < height:
                height = above
        if height == math.inf:
            continue
        vx, vy = velocity[i, 0], velocity[i, 1]
        if air_velocity.shape[0]:
            vx, vy = vx - air_velocity[i, 0], vy - air_velocity[i, 1]
        induced = math.sqrt(thrust[r] / (2.0 * density * math.pi * radius[r] * radius[r]))
        more = thrust[r] * gain(radius[r], height, math.sqrt(vx * vx + vy * vy), induced)
        fx, fy, fz = more * ax, more * ay, more * az
        force[i, 0] += fx
        force[i, 1] += fy
        force[i, 2] += fz
        torque[i, 0] += py * fz - pz * fy
        torque[i, 1] += pz * fx - px * fz
        torque[i, 2] += px * fy - py * fx


def build(parameters: Parameters, context: Context) -> Stages:
    """The stages of this effect."""
    model = context.model
    if not model.rotors.names:
        return Stages(idle="no drone in the scene has rotors")
    if not model.planes:
        return Stages(idle="no floor or ground in the scene")
    floors = np.array([floor.height for floor in model.planes if math.isfinite(floor.height)], np.float64)
    rotors = disks(model, parameters.radius)
    return Stages(force=(context.stage(
        "ground_effect", lift, floors=floors, height_field=of_model(model) or NO_GROUND, disks=rotors,
        density=parameters.density),))
