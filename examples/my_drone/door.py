"""A behavior: a door that rises while a drone is near.

In a scene: `behavior: {my_drone.door: {opens_for: user_drone}}`.
"""

import numpy as np
from pydantic import Field

from drone_engine.behavior import Thing
from drone_engine.scene.fields import Name, Strict


class Parameters(Strict):
    """Validates the behavior's part of the scene."""

    opens_for: Name
    near: float = Field(3.0, gt=0.0)  # m
    height: float = Field(2.0, gt=0.0)  # m that it rises
    speed: float = Field(1.0, gt=0.0)  # m/s


class Behavior:
    """Moves the object that it belongs to."""

    def __init__(self, parameters: Parameters, door: Thing) -> None:
        self.p, self.door, self.closed = parameters, door, door.pose[2]

    def step(self) -> None:
        """Sets the velocity that leads to the wanted height."""
        pose, visitor = self.door.pose, self.door.pose_of(self.p.opens_for)
        near = np.linalg.norm(visitor[:2] - pose[:2]) < self.p.near
        missing = self.closed + (self.p.height if near else 0.0) - pose[2]
        self.door.push(force=[0.0, 0.0, self.door.mass * 9.80665])
        self.door.move([0.0, 0.0, np.clip(missing / self.door.dt, -self.p.speed, self.p.speed)])
