"""A pilot that flies a patrol, and comes down and stays down while it is held. Knows no ROS.

World frame ENU, m and s; commands are in the body frame, x forward, y left, z up, turned by the yaw alone.
"""

import math
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

Point = tuple[float, float, float]

ARRIVED = 0.3  # m from a waypoint at which it counts as reached
GAIN = 1.2  # 1/s; speed per distance that is left, so that the drone arrives slowly
TURN_GAIN = 2.0  # 1/s; yaw rate per angle that is left
NEAR = 1.0  # m, horizontally; from here on the heading stays, and a detour over an obstacle comes down

DESCENT = 1.0  # m/s
TOUCHDOWN = 0.4  # m/s, on the last metre
AT_REST = 0.05  # m/s; slower than this, vertically, is no motion
REST_TIME = 0.3  # s at rest after which the drone has landed
SLIPPED = 0.3  # m/s; a landed drone that moves vertically like this has lost its ground

PATIENCE = 3.0  # s without progress after which something is in the way
PROGRESS = 0.1  # m closer is progress
STEP_OVER = 1.0  # m that the drone then climbs
TRIES = 3  # such climbs before the next waypoint
TOO_LOW = 0.3  # m below the least height at which the drone climbs before anything else

FARTHEST = 1e6  # m or m/s; beyond this an observation is broken


class State(Enum):
    """What the pilot is doing."""

    CLIMBING = "climbing"
    PATROL = "on patrol"
    DESCENDING = "descending"
    LANDED = "landed"


class Observation(NamedTuple):
    """What is known of the drone at a time."""

    time: float  # s
    position_w: Point
    yaw: float  # rad
    climb_rate: float  # m/s, along world z

    def is_sane(self) -> bool:
        """Whether all of it is finite and of this world."""
        x, y, z = self.position_w
        return math.isfinite(self.time) and all(abs(v) < FARTHEST for v in (x, y, z, self.yaw, self.climb_rate))


class Command(NamedTuple):
    """What the drone is to do: m/s in the body frame and rad/s."""

    velocity_b: Point
    yaw_rate: float


STAY = Command((0.0, 0.0, 0.0), 0.0)


class Pilot:
    """Flies one drone from waypoint to waypoint, again and again, at `speed` m/s at most.

    No waypoint is flown lower than `min_height` m above the floor, which is z = 0.
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
        """Back to the first waypoint."""
        self.waypoint = 0
        self._detour = -math.inf  # m, height kept on this leg because something was in the way
        self._tries = 0
        self._enter(State.CLIMBING)

    def fly(self, seen: Observation, held: bool) -> Command | None:
        """One look at the drone into one command; None if the observation is broken.

        Time that goes back means that the simulation was started over, and so does the patrol.
        """
        if not seen.is_sane():
            return None
        if seen.time < self._time:
            self.restart()
        self._time = seen.time
        if held and self.state in (State.PATROL, State.CLIMBING):
            self._enter(State.DESCENDING)
        elif not held and self.state in (State.DESCENDING, State.LANDED):
            self._enter(State.CLIMBING)
        match self.state:
            case State.CLIMBING:
                return self._climb(seen)
            case State.PATROL:
                return self._patrol(seen)
            case State.DESCENDING:
                return self._descend(seen)
            case State.LANDED:
                return self._rest(seen)

    def _enter(self, state: State) -> None:
        self.state = state
        self._closest = math.inf  # m, the least that was left to go
        self._since: float | None = None  # s, when that was, or since when the drone is at rest

    def _climb(self, seen: Observation) -> Command:
        """Straight up to the height of the next leg."""
        left = max(self._waypoints[self.waypoint][2], self._detour) - seen.position_w[2]
        if left < ARRIVED or self._is_stuck(seen.time, left):
            self._enter(State.PATROL)
            return STAY
        return Command((0.0, 0.0, min(GAIN * left, self._speed)), 0.0)

    def _patrol(self, seen: Observation) -> Command:
        """Towards the waypoint; over what is in the way, and on to the next waypoint if that does not help."""
        x, y, z = seen.position_w
        goal = self._waypoints[self.waypoint]
        if math.dist(seen.position_w, goal) < ARRIVED:
            self._next_waypoint()
            goal = self._waypoints[self.waypoint]
        if z < self._min_height - TOO_LOW:
            self._enter(State.CLIMBING)
            return STAY
        if self._is_stuck(seen.time, math.dist(seen.position_w, goal)):
            self._step_over(z)
            return STAY
        dx, dy = goal[0] - x, goal[1] - y
        across = math.hypot(dx, dy)
        dz = (goal[2] if across < NEAR else max(goal[2], self._detour)) - z
        distance = math.hypot(across, dz)
        pace = min(GAIN, self._speed / max(distance, ARRIVED))
        return Command(
            _to_body((pace * dx, pace * dy, pace * dz), seen.yaw),
            self._turn_to(math.atan2(dy, dx), seen.yaw) if across > NEAR else 0.0,
        )

    def _descend(self, seen: Observation) -> Command:
        """Straight down until something carries the drone."""
        if abs(seen.climb_rate) > AT_REST or self._since is None:
            self._since = seen.time
        if seen.time - self._since >= REST_TIME:
            self._enter(State.LANDED)
            return STAY
        return Command((0.0, 0.0, -min(max(seen.position_w[2], TOUCHDOWN), DESCENT)), 0.0)

    def _rest(self, seen: Observation) -> Command:
        """Nothing, unless the ground has given way."""
        if abs(seen.climb_rate) > SLIPPED:
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
        """Whether the drone has not come closer for so long that something must be in the way."""
        if self._since is None or left < self._closest - PROGRESS:
            self._closest, self._since = left, time
        return time - self._since > PATIENCE

    def _turn_to(self, heading: float, yaw: float) -> float:
        angle = math.remainder(heading - yaw, math.tau)
        return min(max(TURN_GAIN * angle, -self._max_yaw_rate), self._max_yaw_rate)


def _to_body(velocity_w: Point, yaw: float) -> Point:
    x, y, z = velocity_w
    cos, sin = math.cos(yaw), math.sin(yaw)
    return cos * x + sin * y, cos * y - sin * x, z
