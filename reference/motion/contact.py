"""Hard cases of motion with contact: stacks, bounces, slopes, corners, and bodies that start inside each other."""

import math

import numpy as np

from drone_engine.math.rotation import from_rpy, rotate_all
from drone_engine.world import World
from reference.box_world import Box, G, Setting, advance, depth, energy, fastest, world_of
from reference.motion.outcome import Outcome, Reached, thinned

EDGE = 0.6  # m, of a crate
FRICTION = 0.5
STICKS, SLIDES = 0.99, 1.01  # of the friction angle
SETTLED = 1.0  # s after which a thing that was put down or flown into a corner has to be at rest


def stack(setting: Setting, seconds: float = 60.0) -> Outcome:
    """Ten boxes on each other."""
    world = world_of({f"box_{i}": Box((EDGE,) * 3, (0.0, 0.0, EDGE * (i + 0.5)), 5.0) for i in range(10)}, setting,
                     floor=0.0)
    start, first = world.state.position_w[9].copy(), energy(world)
    t, moved, gained, lowest, rise = [0.0], [0.0], [0.0], first, 0.0
    for now in advance(world, seconds):
        left = energy(world)
        rise, lowest = max(rise, left - lowest), min(lowest, left)
        t.append(now)
        moved.append(1000.0 * float(np.linalg.norm(world.state.position_w[9] - start)))
        gained.append(1000.0 * (left - first))
    return Outcome((Reached("top box moved", max(moved), 1.0, "mm"),
                    Reached("energy above the start", max(0.0, *gained), 0.0, "mJ"),
                    Reached("energy rose again by", 1000.0 * rise, 1e-6 * 1000.0 * first, "mJ")),
                   thinned({"time_s": t, "moved_mm": moved, "energy_mJ": gained}))


def mass_ratio(setting: Setting, seconds: float = 10.0) -> Outcome:
    """A ton on a kilogram: two boxes of one size."""
    world = world_of({"light": Box((EDGE,) * 3, (0.0, 0.0, 0.5 * EDGE), 1.0),
                      "heavy": Box((EDGE,) * 3, (0.0, 0.0, 1.5 * EDGE), 1000.0)}, setting, floor=0.0)
    t, deep = [0.0], [0.0]
    for now in advance(world, seconds):
        light, heavy = world.state.position_w[:2, 2]
        t.append(now)
        deep.append(100.0 * max(depth(world), 0.5 * EDGE - light, EDGE - (heavy - light)) / EDGE)
    return Outcome((Reached("penetration, of the smaller box", max(deep), 1.0, "%"),),
                   thinned({"time_s": t, "depth_percent": deep}))


def bounce(setting: Setting, bounces: int = 10) -> Outcome:
    """A box falls flat from a metre, with restitution 1, and comes back again and again."""
    world = world_of({"box": Box((EDGE,) * 3, (0.0, 0.0, 1.0 + 0.5 * EDGE), 5.0, 0.6, 1.0)}, setting, floor=0.0,
                     restitution=1.0)
    rest = world.model.bodies.mass[0] * G * 0.5 * EDGE  # J, where it would lie still
    first, t, heights, kept, turns, rising = energy(world) - rest, [0.0], [1.0], [0.0], 0, False
    for now in advance(world, 1.5 * bounces):
        up = bool(world.state.velocity_w[0, 2] > 0.0)
        turns, rising = turns + (up and not rising), up
        t.append(now)
        heights.append(float(world.state.position_w[0, 2]) - 0.5 * EDGE)
        kept.append(100.0 * ((energy(world) - rest) / first - 1.0))
        if turns == bounces and not rising:
            break
    return Outcome((Reached("bounces missing", float(bounces - turns), 0.0),
                    Reached("energy off", float(np.abs(kept).max()), 1.0, "%")),
                   thinned({"time_s": t, "height_m": heights, "energy_percent": kept}))


def slope(setting: Setting, part: float, seconds: float = 10.0) -> Outcome:
    """A crate on a slope at a part of the friction angle: it sticks, or slides as Coulomb says."""
    angle = part * math.atan(FRICTION)
    lean = from_rpy(0.0, angle, 0.0)
    up = rotate_all(np.array([lean]), np.array([[0.0, 0.0, 1.0]]))[0]
    down = rotate_all(np.array([lean]), np.array([[1.0, 0.0, 0.0]]))[0]
    world = world_of({"crate": Box((EDGE, EDGE, 0.5 * EDGE), (*(up * 0.25 * EDGE), 0.0, angle, 0.0), 5.0, FRICTION),
                      "slope": Box((80.0, 10.0, 2.0), (*(-1.0 * up), 0.0, angle, 0.0), None, FRICTION)}, setting)
    start, t, path, speed = world.state.position_w[0].copy(), [0.0], [0.0], [0.0]
    for now in advance(world, seconds):
        t.append(now)
        path.append(float((world.state.position_w[0] - start) @ down))
        speed.append(float(world.state.velocity_w[0] @ down))
    series = thinned({"time_s": t, "path_m": path, "speed_m_s": speed})
    if part < 1.0:
        return Outcome((Reached("crept", 1000.0 * max(map(abs, path)), 1.0, "mm"),), series)
    expected = G * (math.sin(angle) - FRICTION * math.cos(angle))
    found = float(np.polyfit(t, speed, 1)[0])
    series["expected_m_s2"] = np.array([expected])
    return Outcome((Reached("acceleration off", 100.0 * abs(found / expected - 1.0), 1.0, "%"),), series)


def corner(setting: Setting, seconds: float = 60.0, model: str = "direct", speed: float = 8.0) -> Outcome:
    """A drone is told to fly at so many m/s into the corner of two walls, and keeps being told."""
    world = world_of({"drone": Box((0.5, 0.5, 0.16), (0.0, 0.0, 1.5), 1.4, 0.5,
                                   extra=f"flight: {{model: {model}, cmd_vel: cmd_vel}}"),
                      "ahead": Box((1.0, 8.0, 6.0), (2.5, 0.0, 1.0)), "left": Box((8.0, 1.0, 6.0), (0.0, 2.5, 1.0))},
                     setting, floor=-2.0)
    t, deep, fast = [0.0], [0.0], [0.0]
    for _ in range(round(seconds / world.dt)):
        world.step({"drone": (speed, speed, 0.0, 0.0)})
        t.append(world.time)
        deep.append(1000.0 * depth(world))
        fast.append(100.0 * fastest(world))
    late = np.array(t) > 10.0
    return Outcome((Reached("penetration", max(deep), 1.0, "mm"),
                    Reached("speed after 10 s", float(np.array(fast)[late].max()), 1.0, "cm/s"),
                    Reached("not in the corner, off by", 1000.0 * _from_corner(world), 300.0, "mm")),
                   thinned({"time_s": t, "depth_mm": deep, "speed_cm_s": fast}))


def _from_corner(world: World) -> float:
    """How much further the drone is from the two walls than its own half size, m."""
    return float((2.0 - 0.25 - world.state.position_w[0, :2]).max())


def inside(setting: Setting, seconds: float = 3.0) -> Outcome:
    """Pairs of crates that start half inside each other, shifted and turned in many ways, without weight."""
    rng, boxes = np.random.default_rng(4), {}
    for i in range(24):
        way = np.eye(3)[i % 3] if i < 6 else rng.normal(size=3)
        shift = 0.5 * EDGE * way / np.abs(way).max() + [50.0 * i, 0.0, 0.0]
        turn = np.zeros(3) if i < 6 else rng.uniform(-math.pi, math.pi, 3)
        boxes[f"one_{i}"] = Box((EDGE,) * 3, (50.0 * i, 0.0, 0.0), 5.0)
        boxes[f"other_{i}"] = Box((EDGE,) * 3, (*shift, *turn), 5.0 * (1 + i % 2))
    world = world_of(boxes, setting, effects="")
    t, speed = [0.0], [0.0]
    for now in advance(world, seconds):
        t.append(now)
        speed.append(fastest(world))
    return Outcome((Reached("speed", max(speed), 1.0, "m/s"),
                    Reached("still overlapping by", 1000.0 * depth(world), 1.0, "mm")),
                   thinned({"time_s": t, "speed_m_s": speed}))
