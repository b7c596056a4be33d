"""Hard cases of motion in whole scenes: shots at a plate, a million steps, runs that repeat, a clock that stalls."""

from collections.abc import Iterator

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.scene.schema import load
from drone_engine.world import Command, World
from drone_sim.node.pacing import Pacer
from reference.box_world import Box, Setting, with_dynamics, world_of
from reference.motion.outcome import Outcome, Reached, thinned

CUBE, PLATE = 0.05, (2.0, 2.0, 0.01)  # m
AT_ONCE = 50  # cubes in one world, each in front of a plate of its own
STEPS = 24  # that a cube is watched; the slowest needs 20
APART = 1000.0  # m between plates: further than the fastest cube flies meanwhile
FAR = 1.0  # m, of those that no step has found over their plate
SLOWEST, FASTEST = 1.0, 1000.0  # m/s
SETTLED = 10.0  # s after which what lies about in the island has come to rest


def plate(setting: Setting, shots: int = 10_000) -> Outcome:
    """Cubes are shot at thin plates, from any side, at any speed and spin: none may get through."""
    boxes = {f"cube_{i}": Box((CUBE,) * 3, (APART * i, 0.0, 1.0), 0.125, 0.5, 0.2) for i in range(AT_ONCE)}
    boxes |= {f"plate_{i}": Box(PLATE, (APART * i, 0.0, 0.0), None, 0.5, 0.2) for i in range(AT_ONCE)}
    world, rng, through = world_of(boxes, setting, effects=""), np.random.default_rng(0), 0
    speeds: list[float] = []
    nearest: list[float] = []
    for _ in range(shots // AT_ONCE):
        world.reset()
        speed = _aim(world, rng)
        passed, before = np.zeros(AT_ONCE, bool), _from_plates(world)
        side = np.sign(before[:, 2])
        near = np.full(AT_ONCE, np.inf)  # m, in front of the plate, behind it if negative
        for _ in range(STEPS):
            world.run(1)
            now = _from_plates(world)
            crossed = np.sign(now[:, 2]) != np.sign(before[:, 2])
            part = before[:, 2] / np.where(crossed, before[:, 2] - now[:, 2], 1.0)
            at = before[:, :2] + part[:, None] * (now - before)[:, :2]
            passed |= crossed & (np.abs(at) < 0.5 * PLATE[0]).all(axis=1)
            over = (np.abs(now[:, :2]) < 0.5 * PLATE[0]).all(axis=1)
            near = np.where(over | passed, np.minimum(near, side * now[:, 2]), near)
            before = now
        through += int(passed.sum())
        speeds += speed.tolist()
        nearest += np.where(np.isfinite(near), near, FAR).tolist()
    return Outcome((Reached(f"through the plate, of {shots // AT_ONCE * AT_ONCE}", float(through), 0.0),),
                   thinned({"speed_m_s": speeds, "nearest_m": nearest}))


def _from_plates(world: World) -> Floats:
    """Where the cubes are from the middles of their plates, (AT_ONCE, 3) m."""
    return np.asarray(world.state.position_w[:AT_ONCE] - world.state.position_w[AT_ONCE:])


def _aim(world: World, rng: np.random.Generator) -> Floats:
    """Puts the cubes in front of their plates, on their way; their speeds, m/s."""
    n, s = AT_ONCE, world.state
    way = rng.normal(size=(n, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    way[:, 2] = np.copysign(np.maximum(np.abs(way[:, 2]), 0.1), way[:, 2])
    way /= np.linalg.norm(way, axis=1)[:, None]
    speed, turns = SLOWEST * (FASTEST / SLOWEST) ** rng.uniform(0, 1, n), rng.normal(size=(n, 4))
    spin = rng.normal(size=(n, 3))
    clear = 0.06 / np.abs(way[:, 2]) + speed * world.dt * rng.uniform(0, 2, n)
    aim = s.position_w[n:] + np.column_stack([rng.uniform(-0.8, 0.8, (n, 2)), np.zeros(n)])
    s.position_w[:n] = aim - way * clear[:, None]
    s.orientation_w[:n] = turns / np.linalg.norm(turns, axis=1)[:, None]
    s.velocity_w[:n] = way * speed[:, None]
    s.angular_velocity_w[:n] = spin / np.linalg.norm(spin, axis=1)[:, None] * 10 ** rng.uniform(-1, 3, (n, 1))
    return speed


def island(setting: Setting, steps: int = 1_000_000) -> Outcome:
    """The island, left alone: its drone hovers, all else stands where it was put."""
    world = World(with_dynamics(load("island"), setting))
    moving = world.model.bodies.movable
    names = [name for name, moves in zip(world.model.bodies.names, moving, strict=True) if moves]
    world.run(round(SETTLED / world.dt))
    start, finite, t = world.state.position_w[moving].copy(), True, [0.0]
    away: list[list[float]] = [[0.0] * len(names)]
    for _ in range(0, steps, 1000):
        world.run(1000)
        s = world.state
        finite &= all(bool(np.isfinite(a[moving]).all()) for a in
                      (s.position_w, s.orientation_w, s.velocity_w, s.angular_velocity_w))
        t.append(world.time - SETTLED)
        away.append((1000.0 * np.linalg.norm(s.position_w[moving] - start, axis=1)).tolist())
    series = thinned({"time_s": t, **{f"{name}_mm": row for name, row in zip(names, zip(*away, strict=True),
                                                                             strict=True)}})
    return Outcome((Reached("numbers not finite", 0.0 if finite else 1.0, 0.0),
                    Reached("at rest, yet moved", float(np.max(away)), 1.0, "mm")), series)


def repeats(setting: Setting, steps: int = 600) -> Outcome:
    """Two worlds of one scene with the same commands, hash beside hash: a heap of crates, and a drone that flies in."""
    different, hashes, t = 0, [], []
    worlds = [heap(setting), heap(setting)]
    heights: tuple[list[Floats], list[Floats]] = [], []
    for commands in flight(steps):
        for world, z in zip(worlds, heights, strict=True):
            world.step(commands)
            z.append(world.state.position_w[:25:3, 2].copy())
        first, second = (world.state.hash() for world in worlds)
        different += first != second
        hashes.append(first)
        t.append(worlds[0].time)
    worlds[0].reset()
    for commands, expected in zip(flight(steps), hashes, strict=True):
        worlds[0].step(commands)
        different += worlds[0].state.hash() != expected
    return Outcome((Reached("steps with another state", float(different), 0.0),),
                   thinned({"time_s": t[:150], "first_m": heights[0][:150], "second_m": heights[1][:150]}))


def heap(setting: Setting) -> World:
    """24 crates that fall on each other, and a drone."""
    rng = np.random.default_rng(3)
    boxes = {f"crate_{i}": Box(tuple(rng.uniform(0.3, 0.7, 3).tolist()),
                               (*rng.uniform(-1, 1, 2), 0.5 + 0.5 * i, *rng.uniform(-3, 3, 3)), 5.0, 0.5, 0.2)
             for i in range(24)}
    boxes["drone"] = Box((0.5, 0.5, 0.16), (-6.0, 0.0, 1.0), 1.4, 0.5, 0.2, "flight: {cmd_vel: cmd_vel}")
    return world_of(boxes, setting, "gravity: {}, drag: {}", floor=0.0)


def flight(steps: int) -> Iterator[dict[str, Command]]:
    """Commands of a drone that flies into the heap and out of it again, a step each."""
    for step in range(steps):
        yield {} if step % 3 else {"drone": (3.0 if step < steps // 2 else -3.0, 0.2, 0.0, 0.3)}


def stall(setting: Setting, seconds: float = 5.0) -> Outcome:
    """The wall clock stands still for so long in the middle of a fall: simulated time goes on where it was."""
    smooth, stalled = heap(setting), heap(setting)
    pacer, wall, most, clock, t, lag = Pacer(setting.rate, 1.0), 0.0, 0, [0.0], [0.0], [0.0]
    while stalled.time < 4.0:
        wall += pacer.period * 1.001 + (seconds if stalled.time > 2.0 and not pacer.lag else 0.0)
        due = pacer.due(wall)
        for _ in range(due):
            stalled.step()
        most = max(most, due)
        clock.append(wall)
        t.append(stalled.time)
        lag.append(pacer.lag)
    while smooth.time < stalled.time:
        smooth.step()
    missing = wall - stalled.time - pacer.lag
    return Outcome((Reached("steps at once", float(most), 5.0),
                    Reached("another state than without the stall", float(smooth.state.hash() != stalled.state.hash()),
                            0.0),
                    Reached("time lost and not reported, in steps", abs(missing) / pacer.period, 1.5)),
                   thinned({"wall_s": clock, "time_s": t, "lag_s": lag}))
