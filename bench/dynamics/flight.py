"""Benchmark rows with flight models: quadrotors, and the island as a whole."""

from collections.abc import Iterator
from functools import partial
from unittest.mock import patch

import numpy as np

from bench.dynamics import flight_libraries, quadrotors
from bench.report.clock import Times, side_by_side
from bench.report.results import Row
from drone_engine import effects, load
from drone_engine.arrays import Floats
from drone_engine.fleet import Fleet
from drone_engine.world import World

COMMAND = (1.0, 0.0, 0.0, 0.2)  # m/s, rad/s
TARGET = {"step": 300e3, "hundred": 4e6, "thousand": 12e6}
ISLAND_TARGET = 500.0
UNUSED_STEPS = 1000
ISLAND_SECONDS, OFTEN = 20.0, 10  # simulated time; steps between commands


def quadrotor_rows(rounds: int) -> Iterator[Row]:
    """Rows of the island's quadrotor: one step per call, a hundred per call, and a thousand drones."""
    scene = quadrotors.scene()
    world, alone, many = World(scene), Fleet(scene, 1), Fleet(scene, flight_libraries.MANY)
    commands = np.tile(np.array(COMMAND), (flight_libraries.MANY, 1))

    batch, number = flight_libraries.BATCH, flight_libraries.MANY
    for name, work, calls, steps, published in (
            ("step", "one quadrotor with its controller, a step a call",
             {"ours": lambda: world.step({"drone": COMMAND}), "crazyflow": flight_libraries.crazyflow(1, 1),
              "RotorPy": flight_libraries.rotorpy()}, 1, flight_libraries.PUBLISHED),
            ("hundred", f"one quadrotor, {batch} steps a call",
             {"ours": lambda: alone.run(batch, commands[:1]), "crazyflow": flight_libraries.crazyflow(1, batch)},
             batch, {}),
            ("thousand", f"{number:,} quadrotors, {batch} steps a call, drone-steps",
             {"ours": lambda: many.run(batch, commands), "crazyflow": flight_libraries.crazyflow(number, batch)},
             number * batch, {})):
        for call in calls.values():  # twice, since JAX compiles twice
            call()
            call()
        yield _row(work, side_by_side(calls, rounds, 0.2), steps, published, TARGET[name])
    _check(world.state.velocity_w[0])
    for fleet in (alone, many):
        for velocity in fleet.state.velocity_w:
            _check(velocity)


def _row(work: str, times: dict[str, Times], steps: int, given: dict[str, float], asked: float) -> Row:
    """A row of drone steps per second; steps: per call."""
    cpu, best = {n: steps / t.cpu for n, t in times.items()}, {n: steps / t.best for n, t in times.items()}
    peers = {name: rate for name, rate in cpu.items() if name != "ours"} | given
    return Row(work, "steps/s", cpu["ours"], f"{asked:,.0f}", cpu["ours"] >= asked, peers,
               cpu["ours"] / max(peers.values()), best=best)


def _check(velocity_w: Floats) -> None:
    """Raises SystemExit unless the drone flies at the commanded speed."""
    speed = float(np.linalg.norm(velocity_w))
    if abs(speed - COMMAND[0]) > 0.05:
        raise SystemExit(f"a quadrotor flies at {speed:.3g} m/s, expected the commanded {COMMAND[0]:g} m/s")


def island_row(rounds: int) -> Row:
    """Simulated seconds per second of CPU time while the drone flies through the village."""
    world = World(load("island"))
    steps = round(ISLAND_SECONDS / world.dt)

    def fly() -> None:
        world.reset()
        for _ in range(0, steps, OFTEN):
            world.command("user_drone", (1.0, 0.0, 0.0, 0.3))
            world.run(OFTEN)

    times = side_by_side({"ours": fly}, rounds)["ours"]
    if not np.isfinite(world.state.position_w).all() or np.linalg.norm(world.pose("user_drone")[:2]) < 0.1:
        raise SystemExit("the drone has not flown through the island")
    factor = ISLAND_SECONDS / times.cpu
    return Row("the island, headless, at its default rates: real-time factor", "", factor, f"{ISLAND_TARGET:g}",
               factor >= ISLAND_TARGET, best={"ours": ISLAND_SECONDS / times.best})


def unused_effects_row(rounds: int) -> Row:
    """Cost of the effects that a scene does not use, in % of CPU time: against a build without these effects."""
    scene = load("hangar")
    kept = {name: effects.EFFECTS[name] for name in effects.EFFECTS if name in scene.effects}
    with patch.object(effects, "EFFECTS", kept):
        without = World(scene)
    worlds = {"ours": World(scene), "without": without}
    times = side_by_side({name: partial(world.run, UNUSED_STEPS) for name, world in worlds.items()}, 5 * rounds)
    if [stage.name for stage in worlds["ours"].program.stages] != [stage.name for stage in without.program.stages]:
        raise SystemExit("effects that the hangar does not use are in its step")
    cost = 100.0 * (times["ours"].best / times["without"].best - 1.0)
    return Row(f"the hangar: {len(effects.EFFECTS) - len(kept)} effects that it does not use", "% of a step", cost,
               "under 2", cost < 2.0)
