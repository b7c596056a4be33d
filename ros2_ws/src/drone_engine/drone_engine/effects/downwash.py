"""Downwash: the jets of air below rotors, which act on bodies under them.

Momentum theory: a rotor with thrust T leaves a jet of twice its induced velocity v_i = sqrt(T / (2 rho pi R^2)), and a
Gaussian profile 2 v_i exp(-(r / R)^2) has the momentum T. Further down it is a turbulent round jet:
u(x, r) = 2 v_i (R / b) exp(-(r / b)^2), b = max(R, S x / sqrt(ln 2)), with constant momentum and the spreading rate
S = 0.094 of Hussein, Capp, George 1994 (Pope 2000, Turbulent Flows, 5.1). Where jets meet, their momenta add, so that
four jets merge into one further down (Reichardt 1942). Bauersfeld et al. 2024 (Robotics Meets Fluid Dynamics) measured
such a jet below a quadrotor. Not modeled: wind does not bend the jets, and the ground does not stop them.

This effect moves the air; `drag` or `linear_drag` turn that into a force.
"""

import math

import numpy as np
from pydantic import Field

from drone_engine.context import Context, Stages
from drone_engine.effects.disks import disks
from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix
from drone_engine.scene.fields import Strict

SLOPE = 1.0 / math.sqrt(math.log(2.0))  # of b over the half-width at half speed
REACH = 3.0  # b, radius beyond which a jet is ignored: 1e-4 of its speed


class Parameters(Strict):
    """Keys of the effect in a scene file."""

    density: float = Field(1.225, gt=0.0, le=2000.0)  # kg/m^3, of the air
    spread: float = Field(0.094, ge=0.01, le=1.0)  # half-width at half speed, per distance
    radius: float | None = Field(None, gt=0.0, le=100.0)  # m, of the rotors; default: the size of their models


@kernel
def pressure(thrust, density, radius, spread, down, square):
    """Square of a jet's speed, m^2/s^2, `down` m below its rotor; square: m^2, of the distance from its axis."""
    b = max(radius, spread * SLOPE * down)
    if square > (REACH * b) ** 2:
        return 0.0
    return 2.0 * thrust / (density * math.pi * b * b) * math.exp(-2.0 * square / (b * b))


@kernel
def aim(disks, thrust, position, orientation, jet):
    """Writes the jets of r rotors, jet (r, 7): origin (m) and unit direction in the world, and 1 where there is thrust.

    disks: the rotors; thrust: (r,) N; position: (n, 3) m; orientation: (n, 4) x y z w.
    """
    body, place, axis = disks.body, disks.place_b, disks.axis_b
    for r in range(body.shape[0]):
        i = body[r]
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        for c in range(3):
            jet[r, c] = position[i, c] + (m[3 * c] * place[r, 0] + m[3 * c + 1] * place[r, 1]
                                          + m[3 * c + 2] * place[r, 2])
            jet[r, 3 + c] = -(m[3 * c] * axis[r, 0] + m[3 * c + 1] * axis[r, 1] + m[3 * c + 2] * axis[r, 2])
        jet[r, 6] = thrust[r] > 0.0


@kernel
def _passes_by(position, i, ball, jet, r, radius, spread):
    """Whether jet r cannot reach the bounding sphere, of radius `ball` m, of body i."""
    x, y, z = position[i, 0] - jet[r, 0], position[i, 1] - jet[r, 1], position[i, 2] - jet[r, 2]
    down = x * jet[r, 3] + y * jet[r, 4] + z * jet[r, 5]
    if down <= -ball:
        return True
    reach = REACH * max(radius, spread * SLOPE * (down + ball)) + ball
    return x * x + y * y + z * z - down * down > reach * reach


@kernel
def wash(awake, position, orientation, half, disks, thrust, jet, density, spread, air_velocity):
    """Adds the jets of r rotors to air_velocity (n, 3), m/s, around all awake bodies except the rotor's own.

    The dynamic pressure is the mean over four Gauss points in the middle plane of the body's box. half: (n, 3) m; jet:
    (r, 7) from `aim`; density: kg/m^3; spread: half-width at half speed, per distance.
    """
    body, radius = disks.body, disks.radius
    point = 1.0 / math.sqrt(3.0)
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        ball = math.sqrt(half[i, 0] ** 2 + half[i, 1] ** 2 + half[i, 2] ** 2)
        sx = sy = sz = 0.0
        for r in range(body.shape[0]):
            if body[r] == i or jet[r, 6] == 0.0 or _passes_by(position, i, ball, jet, r, radius[r], spread):
                continue
            for corner in range(4):
                u = point * half[i, 0] * (1.0 - 2.0 * (corner % 2))
                v = point * half[i, 1] * (1.0 - 2.0 * (corner // 2))
                x = position[i, 0] + m[0] * u + m[1] * v - jet[r, 0]
                y = position[i, 1] + m[3] * u + m[4] * v - jet[r, 1]
                z = position[i, 2] + m[6] * u + m[7] * v - jet[r, 2]
                down = x * jet[r, 3] + y * jet[r, 4] + z * jet[r, 5]
                if down <= 0.0:
                    continue
                square = max(x * x + y * y + z * z - down * down, 0.0)
                p = 0.25 * pressure(thrust[r], density, radius[r], spread, down, square)
                sx, sy, sz = sx + p * jet[r, 3], sy + p * jet[r, 4], sz + p * jet[r, 5]
        total = math.sqrt(sx * sx + sy * sy + sz * sz)
        if total > 0.0:
            speed = 1.0 / math.sqrt(total)
            air_velocity[i, 0] += sx * speed
            air_velocity[i, 1] += sy * speed
            air_velocity[i, 2] += sz * speed


def build(parameters: Parameters, context: Context) -> Stages:
    """The stages of this effect."""
    model = context.model
    if not model.rotors.names:
        return Stages(idle="no drone in the scene has rotors")
    if model.bodies.movable.sum() < 2:
        return Stages(idle="nothing but the drone moves")
    rotors = disks(model, parameters.radius)
    jet = np.zeros((len(rotors.body), 7))
    return Stages(force=(
        context.stage("downwash", aim, disks=rotors, jet=jet),
        context.stage("downwash", wash, disks=rotors, jet=jet, density=parameters.density, spread=parameters.spread)))
