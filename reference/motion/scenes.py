"""Hard cases of motion in whole scenes: shots at a plate, a million steps, repeated runs, a stalled clock."""

from collections.abc import Iterator

import numpy as np

from drone_engine import load
from drone_engine.arrays import Floats
from drone_engine.world import Command, World
from drone_sim.node.pacing import Pacer
from reference.box_world import Box, Setting, with_dynamics, world_of
from reference.motion.outcome import Criterion, Outcome, thinned

CUBE, PLATE = 0.05, (2.0, 2.0, 0.01)  # m
PLATES = 50  # cubes per world, each in front of its own plate
STEPS = 24  # per shot; the slowest cube needs 20
SPACING = 1000.0  # m between plates: more than the fastest cube travels in a shot
FAR = 1.0  # m, reported for cubes that are never above their plate
SLOWEST, FASTEST = 1.0, 1000.0  # m/s
SETTLED = 10.0  # s until all objects on the island are at rest


def plate(setting: Setting, shots: int = 10_000) -> Outcome:
    """Shoots cubes at thin plates from random directions, with random speeds and angular velocities; none may pass."""
    boxes = {f"cube_{i}": Box((CUBE,) * 3, (SPACING * i, 0.0, 1.0), 0.125, 0.5, 0.2) for i in range(PLATES)}
    boxes |= {f"plate_{i}": Box(PLATE, (SPACING * i, 0.0, 0.0), None, 0.5, 0.2) for i in range(PLATES)}
    world, rng, through = world_of(boxes, setting, effects=""), np.random.default_rng(0), 0
    speeds: list[float] = []
    nearest: list[float] = []
    for _ in range(shots // PLATES):
        world.reset()
        speed = _aim(world, rng)
        passed, before = np.zeros(PLATES, bool), _from_plates(world)
        side = np.sign(before[:, 2])
        near = np.full(PLATES, np.inf)  # m from the plate, negative behind it
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
    return Outcome((Criterion(f"through the plate, of {shots // PLATES * PLATES}", float(through), 0.0),),
                   thinned({"speed_m_s": speeds, "nearest_m": nearest}))


def _from_plates(world: World) -> Floats:
    """Positions of the cubes relative to the centers of their plates, (PLATES, 3) m."""
    return np.asarray(world.state.position_w[:PLATES] - world.state.position_w[PLATES:])


def _aim(world: World, rng: np.random.Generator) -> Floats:
    """Places the cubes in front of their plates, moving toward them; returns their speeds, (PLATES,) m/s."""
    n, s = PLATES, world.state
    direction = rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    direction[:, 2] = np.copysign(np.maximum(np.abs(direction[:, 2]), 0.1), direction[:, 2])
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    speed, quaternions = SLOWEST * (FASTEST / SLOWEST) ** rng.uniform(0, 1, n), rng.normal(size=(n, 4))
    axis = rng.normal(size=(n, 3))
    clear = 0.06 / np.abs(direction[:, 2]) + speed * world.dt * rng.uniform(0, 2, n)
    aim = s.position_w[n:] + np.column_stack([rng.uniform(-0.8, 0.8, (n, 2)), np.zeros(n)])
    s.position_w[:n] = aim - direction * clear[:, None]
    s.orientation_w[:n] = quaternions / np.linalg.norm(quaternions, axis=1)[:, None]
    s.velocity_w[:n] = direction * speed[:, None]
    s.angular_velocity_w[:n] = axis / np.linalg.norm(axis, axis=1)[:, None] * 10 ** rng.uniform(-1, 3, (n, 1))
    return speed


def island(setting: Setting, steps: int = 1_000_000) -> Outcome:
    """The island without any command: the drone hovers, and all other objects stay where they are."""
    world = World(with_dynamics(load("island"), setting))
    moving = world.model.bodies.movable
    names = [name for name, moves in zip(world.model.bodies.names, moving, strict=True) if moves]
    world.run(round(SETTLED / world.dt))
    start, finite, t = world.state.position_w[moving].copy(), True, [0.0]
    drift: list[list[float]] = [[0.0] * len(names)]
    for _ in range(0, steps, 1000):
        world.run(1000)
        s = world.state
        finite &= all(bool(np.isfinite(a[moving]).all()) for a in
                      (s.position_w, s.orientation_w, s.velocity_w, s.angular_velocity_w))
        t.append(world.time - SETTLED)
        drift.append((1000.0 * np.linalg.norm(s.position_w[moving] - start, axis=1)).tolist())
    series = thinned({"time_s": t, **{f"{name}_mm": row for name, row in zip(names, zip(*drift, strict=True),
                                                                             strict=True)}})
    return Outcome((Criterion("non-finite numbers", 0.0 if finite else 1.0, 0.0),
                    Criterion("drift at rest", float(np.max(drift)), 1.0, "mm")), series)


def repeats(setting: Setting, steps: int = 600) -> Outcome:
    """Two worlds of the same scene with the same commands, compared by state hash; then a third run after a reset."""
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
    return Outcome((Criterion("steps with a different state", float(different), 0.0),),
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
    """Commands per step of a drone that flies into the heap and out again."""
    for step in range(steps):
        yield {} if step % 3 else {"drone": (3.0 if step < steps // 2 else -3.0, 0.2, 0.0, 0.3)}


def stall(setting: Setting, seconds: float = 5.0) -> Outcome:
    """The wall clock jumps by some seconds during a fall: simulated time has to continue without a jump."""
    smooth, stalled = heap(setting), heap(setting)
    pacer, wall, most_due, clock, t, lag = Pacer(setting.rate, 1.0), 0.0, 0, [0.0], [0.0], [0.0]
    while stalled.time < 4.0:
        wall += pacer.period * 1.001 + (seconds if stalled.time > 2.0 and not pacer.lag else 0.0)
        due = pacer.due(wall)
        for _ in range(due):
            stalled.step()
        most_due = max(most_due, due)
        clock.append(wall)
        t.append(stalled.time)
        lag.append(pacer.lag)
    while smooth.time < stalled.time:
        smooth.step()
    missing = wall - stalled.time - pacer.lag
    return Outcome((Criterion("steps at once", float(most_due), 5.0),
                    Criterion("state differs from a run without stall",
                              float(smooth.state.hash() != stalled.state.hash()), 0.0),
                    Criterion("unreported loss of time, in steps", abs(missing) / pacer.period, 1.5)),
                   thinned({"wall_s": clock, "time_s": t, "lag_s": lag}))
