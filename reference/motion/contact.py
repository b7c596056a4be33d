"""Hard cases of motion with contact: stacks, bounces, slopes, corners, and bodies that overlap at the start."""

import math

import numpy as np

from drone_engine.math.poses import rotate_all
from drone_engine.math.quaternion import from_rpy
from drone_engine.world import World
from reference.box_world import Box, G, Setting, advance, depth, energy, highest_speed, world_of
from reference.motion.outcome import Criterion, Outcome, thinned

EDGE = 0.6  # m, of a crate
FRICTION = 0.5
STICKS, SLIDES = 0.99, 1.01  # slope angle, relative to the friction angle


def stack(setting: Setting, seconds: float = 60.0) -> Outcome:
    """A stack of ten boxes."""
    world = world_of({f"box_{i}": Box((EDGE,) * 3, (0.0, 0.0, EDGE * (i + 0.5)), 5.0) for i in range(10)}, setting,
                     floor=0.0)
    start, first = world.state.position_w[9].copy(), energy(world)
    t, moved, gain, lowest, rise = [0.0], [0.0], [0.0], first, 0.0
    for time in advance(world, seconds):
        total = energy(world)
        rise, lowest = max(rise, total - lowest), min(lowest, total)
        t.append(time)
        moved.append(1000.0 * float(np.linalg.norm(world.state.position_w[9] - start)))
        gain.append(1000.0 * (total - first))
    return Outcome((Criterion("motion of the top box", max(moved), 1.0, "mm"),
                    Criterion("energy above the start", max(0.0, *gain), 0.0, "mJ"),
                    Criterion("later rise of the energy", 1000.0 * rise, 1e-6 * 1000.0 * first, "mJ")),
                   thinned({"time_s": t, "moved_mm": moved, "energy_mJ": gain}))


def mass_ratio(setting: Setting, seconds: float = 10.0) -> Outcome:
    """A box of 1000 kg on a box of 1 kg of the same size."""
    world = world_of({"light": Box((EDGE,) * 3, (0.0, 0.0, 0.5 * EDGE), 1.0),
                      "heavy": Box((EDGE,) * 3, (0.0, 0.0, 1.5 * EDGE), 1000.0)}, setting, floor=0.0)
    t, depths = [0.0], [0.0]
    for time in advance(world, seconds):
        light, heavy = world.state.position_w[:2, 2]
        t.append(time)
        depths.append(100.0 * max(depth(world), 0.5 * EDGE - light, EDGE - (heavy - light)) / EDGE)
    return Outcome((Criterion("penetration, relative to the smaller box", max(depths), 1.0, "%"),),
                   thinned({"time_s": t, "depth_percent": depths}))


def bounce(setting: Setting, bounces: int = 10) -> Outcome:
    """A box dropped flat from 1 m with restitution 1."""
    world = world_of({"box": Box((EDGE,) * 3, (0.0, 0.0, 1.0 + 0.5 * EDGE), 5.0, 0.6, 1.0)}, setting, floor=0.0,
                     restitution=1.0)
    rest = world.model.bodies.mass[0] * G * 0.5 * EDGE  # J, potential energy at rest on the floor
    first, t, heights, drift, count, rising = energy(world) - rest, [0.0], [1.0], [0.0], 0, False
    for time in advance(world, 1.5 * bounces):
        up = bool(world.state.velocity_w[0, 2] > 0.0)
        count, rising = count + (up and not rising), up
        t.append(time)
        heights.append(float(world.state.position_w[0, 2]) - 0.5 * EDGE)
        drift.append(100.0 * ((energy(world) - rest) / first - 1.0))
        if count == bounces and not rising:
            break
    return Outcome((Criterion("missing bounces", float(bounces - count), 0.0),
                    Criterion("energy error", float(np.abs(drift).max()), 1.0, "%")),
                   thinned({"time_s": t, "height_m": heights, "energy_percent": drift}))


def slope(setting: Setting, part: float, seconds: float = 10.0) -> Outcome:
    """A crate on a slope at `part` of the friction angle.

    Below 1 it has to stick; above 1 its acceleration has to be that of Coulomb friction.
    """
    angle = part * math.atan(FRICTION)
    orientation = from_rpy(0.0, angle, 0.0)
    up = rotate_all(np.array([orientation]), np.array([[0.0, 0.0, 1.0]]))[0]
    down = rotate_all(np.array([orientation]), np.array([[1.0, 0.0, 0.0]]))[0]
    world = world_of({"crate": Box((EDGE, EDGE, 0.5 * EDGE), (*(up * 0.25 * EDGE), 0.0, angle, 0.0), 5.0, FRICTION),
                      "slope": Box((80.0, 10.0, 2.0), (*(-1.0 * up), 0.0, angle, 0.0), None, FRICTION)}, setting)
    start, t, path, speed = world.state.position_w[0].copy(), [0.0], [0.0], [0.0]
    for time in advance(world, seconds):
        t.append(time)
        path.append(float((world.state.position_w[0] - start) @ down))
        speed.append(float(world.state.velocity_w[0] @ down))
    series = thinned({"time_s": t, "path_m": path, "speed_m_s": speed})
    if part < 1.0:
        return Outcome((Criterion("creep", 1000.0 * max(map(abs, path)), 1.0, "mm"),), series)
    expected = G * (math.sin(angle) - FRICTION * math.cos(angle))
    found = float(np.polyfit(t, speed, 1)[0])
    series["expected_m_s2"] = np.array([expected])
    return Outcome((Criterion("acceleration error", 100.0 * abs(found / expected - 1.0), 1.0, "%"),), series)


def corner(setting: Setting, seconds: float = 60.0, model: str = "direct", speed: float = 8.0) -> Outcome:
    """A drone with a constant command of `speed` m/s along x and y, into the corner of two walls."""
    world = world_of({"drone": Box((0.5, 0.5, 0.16), (0.0, 0.0, 1.5), 1.4, 0.5,
                                   extra=f"flight: {{model: {model}, cmd_vel: cmd_vel}}"),
                      "ahead": Box((1.0, 8.0, 6.0), (2.5, 0.0, 1.0)), "left": Box((8.0, 1.0, 6.0), (0.0, 2.5, 1.0))},
                     setting, floor=-2.0)
    t, depths, speeds = [0.0], [0.0], [0.0]
    for _ in range(round(seconds / world.dt)):
        world.step({"drone": (speed, speed, 0.0, 0.0)})
        t.append(world.time)
        depths.append(1000.0 * depth(world))
        speeds.append(100.0 * highest_speed(world))
    late = np.array(t) > 10.0
    return Outcome((Criterion("penetration", max(depths), 1.0, "mm"),
                    Criterion("speed after 10 s", float(np.array(speeds)[late].max()), 1.0, "cm/s"),
                    Criterion("distance from the corner", 1000.0 * _from_corner(world), 300.0, "mm")),
                   thinned({"time_s": t, "depth_mm": depths, "speed_cm_s": speeds}))


def _from_corner(world: World) -> float:
    """Gap between the drone and the farther of the two walls, m."""
    return float((2.0 - 0.25 - world.state.position_w[0, :2]).max())


def inside(setting: Setting, seconds: float = 3.0) -> Outcome:
    """Pairs of crates that overlap by half at the start, in many relative poses, without gravity."""
    rng, boxes = np.random.default_rng(4), {}
    for i in range(24):
        direction = np.eye(3)[i % 3] if i < 6 else rng.normal(size=3)
        shift = 0.5 * EDGE * direction / np.abs(direction).max() + [50.0 * i, 0.0, 0.0]
        rotation = np.zeros(3) if i < 6 else rng.uniform(-math.pi, math.pi, 3)
        boxes[f"one_{i}"] = Box((EDGE,) * 3, (50.0 * i, 0.0, 0.0), 5.0)
        boxes[f"other_{i}"] = Box((EDGE,) * 3, (*shift, *rotation), 5.0 * (1 + i % 2))
    world = world_of(boxes, setting, effects="")
    t, speed = [0.0], [0.0]
    for time in advance(world, seconds):
        t.append(time)
        speed.append(highest_speed(world))
    return Outcome((Criterion("speed", max(speed), 1.0, "m/s"),
                    Criterion("remaining overlap", 1000.0 * depth(world), 1.0, "mm")),
                   thinned({"time_s": t, "speed_m_s": speed}))
