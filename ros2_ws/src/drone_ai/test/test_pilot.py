"""The pilot in a small world: a point mass with limited acceleration, a floor and obstacles."""

import math
from collections.abc import Callable, Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drone_ai.pilot import ARRIVED, LARGEST, PATIENCE, TRIES, Observation, Pilot, Point, State

STEP = 1.0 / 30.0
ACCELERATION = 8.0
SQUARE: list[Point] = [(8.0, 0.0, 4.0), (8.0, 6.0, 2.0), (0.0, 6.0, 6.0), (0.0, 0.0, 3.0)]

Obstacle = Callable[[Point, Point], Point]  # old and wanted position to the position that can be reached


def open_air(_: Point, wanted: Point) -> Point:
    return wanted


def wall(x: float, top: float) -> Obstacle:
    """An infinitely long wall at x, m, that cannot be passed below its top, m."""

    def blocked(old: Point, new: Point) -> Point:
        return (old[0], *new[1:]) if (old[0] - x) * (new[0] - x) < 0.0 and new[2] < top else new

    return blocked


class World:
    """A drone that follows commands as well as its acceleration allows; z = 0 is the floor."""

    def __init__(self, pilot: Pilot, position: Point = (0.0, 0.0, 0.0), obstacle: Obstacle = open_air) -> None:
        self.pilot = pilot
        self.position = position
        self.obstacle = obstacle
        self.velocity: Point = (0.0, 0.0, 0.0)
        self.yaw = self.time = 0.0
        self.held = False
        self.command: Point = (0.0, 0.0, 0.0)  # in the world frame

    def step(self) -> None:
        command = self.pilot.fly(Observation(self.time, self.position, self.yaw, self.velocity[2]), self.held)
        assert command is not None
        x, y, z = command.velocity_b
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        self.command = (cos * x - sin * y, sin * x + cos * y, z)
        most = ACCELERATION * STEP
        vx, vy, vz = (v + min(max(c - v, -most), most) for v, c in zip(self.velocity, self.command, strict=True))
        px, py, pz = self.position
        new = self.obstacle(self.position, (px + vx * STEP, py + vy * STEP, max(pz + vz * STEP, 0.0)))
        self.velocity = ((new[0] - px) / STEP, (new[1] - py) / STEP, (new[2] - pz) / STEP)
        self.position = new
        self.yaw += command.yaw_rate * STEP
        self.time += STEP

    def run(self, duration: float) -> Iterator[None]:
        """Steps; after each the caller may look."""
        end = self.time + duration
        while self.time < end:
            self.step()
            yield

    def run_until(self, done: Callable[[], bool], limit: float = 60.0) -> None:
        for _ in self.run(limit):
            if done():
                return
        pytest.fail(f"not within {limit} s: at {self.position}, {self.pilot.state}, waypoint {self.pilot.waypoint}")


def test_it_climbs_straight_up_and_flies_to_every_waypoint_in_turn() -> None:
    world = World(Pilot(SQUARE))
    visited: list[int] = []
    world.run_until(lambda: world.pilot.state is State.PATROL)
    assert world.position[:2] == (0.0, 0.0)
    assert world.position[2] > SQUARE[0][2] - 2 * ARRIVED
    for _ in world.run(60.0):
        near = [i for i, waypoint in enumerate(SQUARE) if math.dist(world.position, waypoint) < ARRIVED + 0.05]
        if near and near != visited[-1:]:
            visited += near
    assert visited[:8] == [0, 1, 2, 3, 0, 1, 2, 3]


def test_it_looks_where_it_flies() -> None:
    world = World(Pilot(SQUARE))
    world.run_until(lambda: world.pilot.waypoint == 1)
    for _ in world.run(2.5):
        pass
    assert world.yaw == pytest.approx(math.pi / 2, abs=0.2)


def test_it_flies_no_lower_than_the_least_height_though_waypoints_do() -> None:
    world = World(Pilot([(8.0, 0.0, 0.2), (0.0, 0.0, -5.0), (4.0, 4.0, 9.0)], speed=4.0, min_height=1.5))
    world.run_until(lambda: world.pilot.state is State.PATROL)
    lowest = math.inf
    for _ in world.run(40.0):
        assert world.pilot.state is State.PATROL
        lowest = min(lowest, world.position[2])
    assert lowest > 1.5 - 0.3
    world.position = (4.0, 0.0, 0.5)  # pushed down
    world.step()
    world.step()
    assert world.pilot.state is State.CLIMBING
    assert world.command[:2] == (0.0, 0.0)
    assert world.command[2] > 0.0


def test_it_lands_while_held_stays_and_resumes_where_it_left() -> None:
    world = World(Pilot(SQUARE))
    world.run_until(lambda: world.pilot.waypoint == 2)
    x, y, _ = world.position
    world.held = True
    speeds = []
    for _ in world.run(20.0):
        if world.pilot.state is State.DESCENDING and world.position[2] > 0.0:
            speeds.append((world.position[2], -world.velocity[2]))
        if world.pilot.state is State.LANDED:
            break
    assert world.position[2] == 0.0
    assert math.dist(world.position, (x, y, 0.0)) < 0.6  # what it takes to stop
    assert max(speed for _, speed in speeds) <= 1.0 + 1e-9
    assert all(speed < 0.5 for height, speed in speeds if height < 0.3)
    for _ in world.run(5.0):
        assert world.command == (0.0, 0.0, 0.0)
        assert world.pilot.state is State.LANDED
        assert world.position[2] == 0.0
    world.held = False
    ground = world.position[:2]
    world.run_until(lambda: world.pilot.state is State.PATROL)
    assert world.position[:2] == ground
    assert world.pilot.waypoint == 2
    world.run_until(lambda: world.pilot.waypoint == 3)


def test_it_keeps_coming_down_until_it_rests() -> None:
    world = World(Pilot(SQUARE), (0.0, 0.0, 20.0))
    world.held = True
    for _ in world.run(18.0):
        assert world.position[2] > 0.5
        assert world.pilot.state is State.DESCENDING
    world.run_until(lambda: world.pilot.state is State.LANDED)


def test_ground_that_gives_way_makes_it_come_down_again() -> None:
    world = World(Pilot(SQUARE))
    world.held = True
    world.run_until(lambda: world.pilot.state is State.LANDED)
    world.position, world.velocity = (0.0, 0.0, 5.0), (0.0, 0.0, -1.0)
    world.step()
    assert world.pilot.state is State.DESCENDING


def test_it_flies_over_a_wall() -> None:
    world = World(Pilot([(10.0, 0.0, 2.0), (0.0, 0.0, 2.0)]), obstacle=wall(5.0, 4.5))
    world.run_until(lambda: world.pilot.waypoint == 1)
    assert math.dist(world.position, (10.0, 0.0, 2.0)) < 0.4


def test_it_gives_up_a_waypoint_that_it_cannot_reach() -> None:
    world = World(Pilot([(10.0, 0.0, 2.0), (0.0, 5.0, 2.0)]), obstacle=wall(5.0, 100.0))
    world.run_until(lambda: world.pilot.waypoint == 1)
    assert world.time > (TRIES + 1) * PATIENCE
    assert 2.0 + TRIES - 0.5 < world.position[2] < 2.0 + TRIES + 0.5
    world.run_until(lambda: world.pilot.waypoint == 0)
    assert math.dist(world.position, (0.0, 5.0, 2.0)) < 0.4


def test_time_that_goes_back_starts_the_patrol_over() -> None:
    world = World(Pilot(SQUARE))
    world.run_until(lambda: world.pilot.waypoint == 2)
    world.time = 0.0
    world.step()
    assert world.pilot.waypoint == 0


numbers = st.floats(-LARGEST, LARGEST, exclude_min=True, exclude_max=True)
points = st.tuples(numbers, numbers, numbers)
observations = st.builds(Observation, st.floats(0.0, 1e9), points, numbers, numbers)


@given(
    waypoints=st.lists(points, min_size=2, max_size=5),
    speed=st.floats(0.01, 100.0),
    seen=st.lists(st.tuples(observations, st.booleans()), max_size=20),
)
def test_commands_are_finite_and_within_the_speeds(
    waypoints: list[Point], speed: float, seen: list[tuple[Observation, bool]]
) -> None:
    pilot = Pilot(waypoints, speed=speed, max_yaw_rate=0.7)
    for observation, held in seen:
        command = pilot.fly(observation, held)
        assert command is not None
        assert math.hypot(*command.velocity_b) <= max(speed, 1.0) * (1 + 1e-9)
        assert abs(command.yaw_rate) <= 0.7


@pytest.mark.parametrize("broken", [math.nan, math.inf, -math.inf, 2 * LARGEST])
@pytest.mark.parametrize("field", ["x", "y", "z", "yaw", "climb_rate"])
def test_a_broken_observation_is_ignored(broken: float, field: str) -> None:
    world = World(Pilot(SQUARE))
    world.run_until(lambda: world.pilot.waypoint == 1)
    good = {"x": 0.0, "y": 0.0, "z": 0.0, "yaw": 0.0, "climb_rate": 0.0} | {field: broken}
    seen = Observation(0.0, (good["x"], good["y"], good["z"]), good["yaw"], good["climb_rate"])
    assert world.pilot.fly(seen, held=True) is None
    assert (world.pilot.state, world.pilot.waypoint) == (State.PATROL, 1)
