"""A behavior: counts the laps around the z axis of the world. In a scene: `behavior: {my_drone.laps: {}}`."""

import math

from drone_engine.behavior import Thing
from drone_engine.scene.fields import Strict


class Parameters(Strict):
    """There are none."""


class Behavior:
    """Counts; the count is part of the state, as `world.state.memory['<object>.laps']`."""

    def __init__(self, parameters: Parameters, drone: Thing) -> None:
        self.drone = drone
        self.laps = drone.remember("laps", [0.0])
        self.last = self.angle

    @property
    def angle(self) -> float:
        """Where the drone is around the axis, rad."""
        x, y = self.drone.pose[:2]
        return math.atan2(y, x)

    def step(self) -> None:
        """Adds the angle flown since the last step, in full turns."""
        angle = self.angle
        self.laps[0] += math.remainder(angle - self.last, 2.0 * math.pi) / (2.0 * math.pi)
        self.last = angle
