"""A pilot that flies a patrol, and lands and stays on the ground while it is held. Independent of ROS.

Positions are in the world frame (ENU), m and s. Commands are in the body frame without its tilt: x forward, y left,
z up.
"""

import math
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

Point = tuple[float, float, float]

ARRIVED = 0.3  # m from a waypoint within which it counts as reached
GAIN = 1.2  # 1/s; speed per remaining distance, so that the drone slows down as it arrives
YAW_GAIN = 2.0  # 1/s; yaw rate per heading error
NEAR = 1.0  # m, horizontal distance to the waypoint below which the heading is kept and a detour descends

DESCENT = 1.0  # m/s
TOUCHDOWN = 0.4  # m/s, near the ground
AT_REST = 0.05  # m/s; vertical speed below which the drone counts as resting
REST_TIME = 0.3  # s at rest after which the drone has landed
SLIPPED = 0.3  # m/s; vertical speed at which a landed drone has lost its support

PATIENCE = 3.0  # s without progress after which the drone counts as blocked
PROGRESS = 0.1  # m; getting closer by this much is progress
STEP_OVER = 1.0  # m that a blocked drone climbs
TRIES = 3  # climbs before the waypoint is skipped
TOO_LOW = 0.3  # m below the minimum height at which the drone climbs first

LARGEST = 1e6  # m or m/s; an observation with larger values is invalid


class State(Enum):
    """The state of a pilot; the values are shown in diagnostics."""

    CLIMBING = "climbing"
    PATROL = "on patrol"
    DESCENDING = "descending"
    LANDED = "landed"


class Observation(NamedTuple):
    """The state of the drone at a time."""

    time: float  # s
    position_w: Point
    yaw: float  # rad
    climb_rate: float  # m/s, along world z

    def is_valid(self) -> bool:
        """Whether all values are finite and at most LARGEST."""
        x, y, z = self.position_w
        return math.isfinite(self.time) and all(abs(v) < LARGEST for v in (x, y, z, self.yaw, self.climb_rate))


class Command(NamedTuple):
    """A velocity in the body frame, m/s, and a yaw rate, rad/s."""

    velocity_b: Point
    yaw_rate: float


STAY = Command((0.0, 0.0, 0.0), 0.0)


class Pilot:
    """Flies one drone from waypoint to waypoint in a loop.

    waypoints: world frame, m; they are raised to at least `min_height`, m above z = 0. speed: at most, m/s.
    max_yaw_rate: rad/s.
    """

    def __init__(
        self, waypoints: Sequence[Point], speed: float = 2.0, min_height: float = 1.0, max_yaw_rate: float = 1.0
    ) -> None:
        self._waypoints = [(x, y, max(z, min_height)) for x, y, z in waypoints]
        self._speed = speed
        self._min_height = min_height
        self._max_yaw_rate = max_yaw_rate
        self._time = -math.inf
        self.restart()

    def restart(self) -> None:
        """Starts again at the first waypoint."""
        self.waypoint = 0
        self._detour = -math.inf  # m, minimum height on this leg to pass an obstacle
        self._tries = 0
        self._enter(State.CLIMBING)

    def fly(self, observed: Observation, held: bool) -> Command | None:
        """Returns the command for an observation; None if the observation is invalid. held: whether to land.

        If time goes back, the simulation was reset, and the patrol starts again.
        """
        if not observed.is_valid():
            return None
        if observed.time < self._time:
            self.restart()
        self._time = observed.time
        if held and self.state in (State.PATROL, State.CLIMBING):
            self._enter(State.DESCENDING)
        elif not held and self.state in (State.DESCENDING, State.LANDED):
            self._enter(State.CLIMBING)
        match self.state:
            case State.CLIMBING:
                return self._climb(observed)
            case State.PATROL:
                return self._patrol(observed)
            case State.DESCENDING:
                return self._descend(observed)
            case State.LANDED:
                return self._rest(observed)

    def _enter(self, state: State) -> None:
        self.state = state
        self._closest = math.inf  # m, the smallest remaining distance so far
        self._since: float | None = None  # s, when that was reached, or when the drone came to rest

    def _climb(self, observed: Observation) -> Command:
        """Climbs straight up to the height of the next leg."""
        left = max(self._waypoints[self.waypoint][2], self._detour) - observed.position_w[2]
        if left < ARRIVED or self._is_stuck(observed.time, left):
            self._enter(State.PATROL)
            return STAY
        return Command((0.0, 0.0, min(GAIN * left, self._speed)), 0.0)

    def _patrol(self, observed: Observation) -> Command:
        """Flies toward the waypoint, climbs over an obstacle, and skips the waypoint if that does not help."""
        x, y, z = observed.position_w
        goal = self._waypoints[self.waypoint]
        if math.dist(observed.position_w, goal) < ARRIVED:
            self._next_waypoint()
            goal = self._waypoints[self.waypoint]
        if z < self._min_height - TOO_LOW:
            self._enter(State.CLIMBING)
            return STAY
        if self._is_stuck(observed.time, math.dist(observed.position_w, goal)):
            self._step_over(z)
            return STAY
        dx, dy = goal[0] - x, goal[1] - y
        across = math.hypot(dx, dy)
        dz = (goal[2] if across < NEAR else max(goal[2], self._detour)) - z
        distance = math.hypot(across, dz)
        pace = min(GAIN, self._speed / max(distance, ARRIVED))
        return Command(
            _to_body((pace * dx, pace * dy, pace * dz), observed.yaw),
            self._yaw_rate_to(math.atan2(dy, dx), observed.yaw) if across > NEAR else 0.0,
        )

    def _descend(self, observed: Observation) -> Command:
        """Descends straight down until the drone rests on something."""
        if abs(observed.climb_rate) > AT_REST or self._since is None:
            self._since = observed.time
        if observed.time - self._since >= REST_TIME:
            self._enter(State.LANDED)
            return STAY
        return Command((0.0, 0.0, -min(max(observed.position_w[2], TOUCHDOWN), DESCENT)), 0.0)

    def _rest(self, observed: Observation) -> Command:
        """Stays on the ground; descends again if the support is gone."""
        if abs(observed.climb_rate) > SLIPPED:
            self._enter(State.DESCENDING)
        return STAY

    def _next_waypoint(self) -> None:
        self.waypoint = (self.waypoint + 1) % len(self._waypoints)
        self._detour = -math.inf
        self._tries = 0
        self._enter(State.PATROL)

    def _step_over(self, z: float) -> None:
        if self._tries == TRIES:
            self._next_waypoint()
        else:
            self._tries += 1
            self._detour = z + STEP_OVER
            self._enter(State.CLIMBING)

    def _is_stuck(self, time: float, left: float) -> bool:
        """Whether the remaining distance `left`, m, has not decreased for PATIENCE."""
        if self._since is None or left < self._closest - PROGRESS:
            self._closest, self._since = left, time
        return time - self._since > PATIENCE

    def _yaw_rate_to(self, heading: float, yaw: float) -> float:
        """Yaw rate, rad/s, toward a heading, rad."""
        angle = math.remainder(heading - yaw, math.tau)
        return min(max(YAW_GAIN * angle, -self._max_yaw_rate), self._max_yaw_rate)


def _to_body(velocity_w: Point, yaw: float) -> Point:
    """Rotates a velocity from the world frame into the body frame without its tilt."""
    x, y, z = velocity_w
    cos, sin = math.cos(yaw), math.sin(yaw)
    return cos * x + sin * y, cos * y - sin * x, z
