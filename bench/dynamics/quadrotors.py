"""Steps per second of one quadrotor and of a thousand, by World and by Fleet: dt = 1/240 s, one thread.

    python -m bench.dynamics.quadrotors

The drone of the island with the default integrator: flight controller, mixing, four rotors with motor lag, air drag.
Each measurement checks its result: the drones fly at the commanded velocity, and those of a fleet like a single one.
"""

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from bench.report.clock import Times, side_by_side
from bench.report.results import Row, report
from drone_engine import Scene, load
from drone_engine.arrays import Floats
from drone_engine.fleet import Fleet
from drone_engine.world import World

RATE = 240  # Hz
SCENE = f"""version: 1
rates: {{physics: {RATE}}}
dynamics: {{substeps: 1}}
effects: {{gravity: {{}}, drag: {{}}, motor_lag: {{}}}}
objects:
  drone: {{model: drone, pose: [0, 0, 1], mass: 1.4, flight: {{model: quadrotor}}}}
  front_left: {{model: drone_rotor_cw, parent: drone, pose: [0.19, 0.19, 0.066], rotor: {{direction: -1}}}}
  front_right: {{model: drone_rotor_ccw, parent: drone, pose: [0.19, -0.19, 0.066], rotor: {{direction: 1}}}}
  rear_left: {{model: drone_rotor_ccw, parent: drone, pose: [-0.19, 0.19, 0.066], rotor: {{direction: 1}}}}
  rear_right: {{model: drone_rotor_cw, parent: drone, pose: [-0.19, -0.19, 0.066], rotor: {{direction: -1}}}}
"""
COMMAND = (2.0, 0.0, 0.0, 0.0)
MANY = 1000


def scene() -> Scene:
    """The scene that is timed."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "quadrotor.yaml"
        path.write_text(SCENE)
        return load(path)


def commands() -> Floats:
    """A different command for each drone, (MANY, 4)."""
    velocities = np.random.default_rng(1).uniform(-3.0, 3.0, (MANY, 4))
    velocities[:, 3] *= 0.1  # fast yaw would turn the velocity
    return velocities


def check() -> None:
    """Raises AssertionError unless drones fly as commanded, and bit for bit the same in a World and in a Fleet."""
    alone, velocities = World(scene()), commands()
    fleet = Fleet(alone.scene, MANY)
    assert fleet.in_blocks, fleet.why_not
    for _ in range(8):
        alone.command("drone", tuple(velocities[7]))
        alone.run(100)
        fleet.run(100, velocities)
    np.testing.assert_array_equal(fleet.state.position_w[7], alone.state.position_w[0])
    np.testing.assert_array_equal(fleet.state.velocity_w[7], alone.state.velocity_w[0])
    speed, commanded = np.linalg.norm(fleet.state.velocity_w, axis=1), np.linalg.norm(velocities[:, :3], axis=1)
    assert np.abs(speed / commanded - 1.0).max() < 0.05, "the drones do not fly at the commanded velocity"


def rows(rounds: int = 15) -> list[Row]:
    """All measurements of one drone and of many, by World and by Fleet."""
    check()
    world, one, many = World(scene()), Fleet(scene(), 1), Fleet(scene(), MANY)
    command, velocities, single = {"drone": COMMAND}, commands(), np.array(COMMAND)

    def batch() -> None:
        world.command("drone", COMMAND)
        world.run(100)

    times = side_by_side({
        "step": lambda: world.step(command), "step of a fleet": lambda: one.run(1, single),
        "batch": batch, "batch of a fleet": lambda: one.run(100, single),
        "many": lambda: many.run(100, velocities), "many, a step": lambda: many.run(1, velocities)}, rounds)
    return [
        _row("one quadrotor with controller, a step per call", times["step"], 1, 300_000),
        _row("the same, as a fleet of one", times["step of a fleet"], 1, 300_000),
        _row("one quadrotor, 100 steps per call", times["batch of a fleet"], 100, 4_000_000),
        _row("the same, as a World", times["batch"], 100, None),
        _row(f"{MANY:,} quadrotors, 100 steps per call", times["many"], 100 * MANY, 12_000_000),
        _row(f"{MANY:,} quadrotors, a step and new commands per call", times["many, a step"], MANY, None)]


def _row(work: str, taken: Times, steps: int, asked: int | None) -> Row:
    """A row of drone steps per second; steps: per call."""
    return Row(work, "steps/s", steps / taken.wall, f">= {asked:,}" if asked else "",
               steps / taken.cpu >= asked if asked else None, cpu={"ours": steps / taken.cpu},
               best={"ours": steps / taken.best})


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer rounds")
    report("quadrotors", {"dt": 1 / RATE, "substeps": 1, "effects": "gravity, drag, motor_lag", "threads": 1},
           rows(5 if parser.parse_args().quick else 15))
