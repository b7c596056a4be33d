"""A controller: follows another object. In a scene: `flight: {controller: {my_drone.follow: {target: person}}}`."""

import numpy as np
from pydantic import Field

from drone_engine.behavior import Command, Thing
from drone_engine.math.poses import inverse, rotate_all
from drone_engine.scene.fields import Name, Strict


class Parameters(Strict):
    """Validates the controller's part of the scene."""

    target: Name
    distance: float = Field(2.0, ge=0.0)  # m, horizontally
    height: float = 1.0  # m above the target


class Controller:
    """Commands the drone that it belongs to."""

    def __init__(self, parameters: Parameters, drone: Thing) -> None:
        self.p, self.drone = parameters, drone

    def command(self) -> Command:
        """Velocity towards the place beside the target, in the drone's frame."""
        pose, target = self.drone.pose, self.drone.pose_of(self.p.target)[:3]
        away = pose[:2] - target[:2]
        away *= self.p.distance / max(float(np.linalg.norm(away)), 1e-6)
        error = target + np.array([*away, self.p.height]) - pose[:3]
        forward, left, up = rotate_all(inverse(pose[3:]), error)
        return float(forward), float(left), float(up), 0.0
