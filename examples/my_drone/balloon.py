"""A flight model: a balloon that drifts with the wanted velocity and never tilts.

In a scene: `flight: {model: my_drone.balloon, parameters: {response: 1.0}}`.
"""

import numpy as np
from pydantic import Field

from drone_engine.context import Context, Stages
from drone_engine.kernel import kernel
from drone_engine.scene.fields import Strict


class Parameters(Strict):
    """Validates `flight.parameters`."""

    response: float = Field(1.0, ge=0.05, le=60.0)  # s in which a difference in velocity falls to 1/e


@kernel
def drift(drone, drone_body, velocity, angular_velocity, mass, body_inertia, wanted, weight, response, force, torque):
    """Adds a force towards the wanted velocity, and the weight to carry, to force (n, 3), N, and a torque against
    rotation to torque (n, 3), N m. drone: (1,); wanted: (d, 4) m/s and rad/s; weight: m/s^2; response: s."""
    for k in range(drone.shape[0]):
        i = drone_body[drone[k]]
        for c in range(3):
            force[i, c] += mass[i] * (wanted[drone[k], c] - velocity[i, c]) / response
            torque[i, c] -= body_inertia[i, c] * angular_velocity[i, c] / response
        force[i, 2] += mass[i] * weight


def build(parameters: Parameters, context: Context, drone: np.ndarray, wanted: np.ndarray, weight: float) -> Stages:
    """The stages of one drone; wanted: (d, 4) velocity in the world and yaw rate, from the pilot."""
    return Stages(force=(context.stage("balloon", drift, drone=drone, wanted=wanted, weight=weight,
                                       response=parameters.response),))
