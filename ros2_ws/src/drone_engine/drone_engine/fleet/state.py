"""The state of the drones of a fleet."""

from typing import NamedTuple, Self

from drone_engine.arrays import Floats
from drone_engine.fleet.layout import (
    ANGULAR_VELOCITY,
    COMMAND,
    COMMAND_AGE,
    EXPECTED_VELOCITY,
    HOLD,
    ORIENTATION,
    POSITION,
    ROTOR_ANGLE,
    ROTOR_SPEED,
    VELOCITY,
)


class FleetState(NamedTuple):
    """The drone of each of n copies, as views: values written to them take effect with the next step."""

    position_w: Floats  # (n, 3) m, centers of the bounding boxes
    orientation_w: Floats  # (n, 4) unit quaternions x y z w
    velocity_w: Floats  # (n, 3) m/s
    angular_velocity_w: Floats  # (n, 3) rad/s
    rotor_speed: Floats  # (n, 4) rad/s, of quadrotors
    rotor_angle: Floats  # (n, 4) rad, of quadrotors with four rotors in the scene
    command_b: Floats  # (n, 4) latest command: forward, left, up in m/s, yaw rate in rad/s
    silence: Floats  # (n,) steps since the latest command
    hold_w: Floats  # (n, 3) m, where a drone without commands hovers; NaN until it has stopped
    expected_velocity_and_push: Floats  # (n, 6) m/s and m/s^2, observer of quadrotors; NaN before its first step

    @classmethod
    def of(cls, table: Floats) -> Self:
        """Views of a table (STATE_ROWS, n), see layout.py."""
        sizes = {POSITION: 3, ORIENTATION: 4, VELOCITY: 3, ANGULAR_VELOCITY: 3, ROTOR_SPEED: 4, ROTOR_ANGLE: 4,
                 COMMAND: 4, COMMAND_AGE: 1, HOLD: 3, EXPECTED_VELOCITY: 6}
        return cls(*(table[row] if size == 1 else table[row : row + size].T for row, size in sizes.items()))
