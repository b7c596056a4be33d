"""Kinematics of rigid bodies."""

import math

from drone_engine.kernel import kernel


@kernel
def max_point_speed(i, velocity, angular_velocity, radius):
    """Upper bound of the speed of every point of body i that is at most `radius` m from its position: |v| + |w| r, m/s.

    velocity: (n, 3) m/s; angular_velocity: (n, 3) rad/s; both in the same frame.
    """
    speed = math.sqrt(velocity[i, 0] ** 2 + velocity[i, 1] ** 2 + velocity[i, 2] ** 2)
    turning = math.sqrt(angular_velocity[i, 0] ** 2 + angular_velocity[i, 1] ** 2 + angular_velocity[i, 2] ** 2)
    return speed + turning * radius
