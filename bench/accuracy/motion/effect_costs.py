"""CPU time per step of each effect, and its influence on the end of a reference flight."""

import statistics
from collections.abc import Callable
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from rich.progress import Progress

from drone_engine import parse
from drone_engine.effects import EFFECTS
from drone_engine.world import World
from reference.box_world import Box, Setting, world_of

SETTING = Setting(rate=240.0, substeps=1)
BLOCK = 0.5  # s of simulated time between commands
MIN_TIME = 0.05  # s of CPU time per timing
STEPS = 100  # between commands, during timing
ROTORS = (("front_left", 0.19, 0.19, "cw", -1), ("front_right", 0.19, -0.19, "ccw", 1),
          ("rear_left", -0.19, 0.19, "ccw", 1), ("rear_right", -0.19, -0.19, "cw", -1))
COMMAND = (1.5, 0.0, 0.0, 0.2)  # m/s, rad/s


class Flight(NamedTuple):
    """A reference flight: start(effects) creates its world.

    base: the other effects, as YAML; parameters: those of the effect, as YAML.
    """

    start: Callable[[str], World]
    base: str
    seconds: float
    description: str
    parameters: str = "{}"


def thrown_crate(effects: str) -> World:
    """A crate thrown from a tower."""
    world = world_of({"crate": Box((0.6,) * 3, (0.0, 0.0, 200.0), 20.0)}, SETTING, effects)
    world.state.velocity_w[0] = (15.0, 0.0, 10.0)
    world.state.angular_velocity_w[0] = (0.3, 0.5, 0.1)
    return world


def hovering_quadrotors(effects: str) -> World:
    """Two quadrotors close to the ground, one above the other."""
    lines = [f"version: 1\n{SETTING.yaml()}effects: {{{effects}}}\nobjects:",
             "  floor: {model: hangar_floor, static: true, collision: {level: floor}}"]
    for drone, height in (("lower", 0.3), ("upper", 1.5)):
        lines.append(f"  {drone}: {{model: drone, pose: [0, 0, {height}], mass: 1.5, "
                     "flight: {model: quadrotor, cmd_vel: cmd_vel}}")
        lines += [f"  {drone}_{rotor}: {{model: drone_rotor_{rotation}, parent: {drone}, pose: [{x}, {y}, 0.066], "
                  f"rotor: {{direction: {direction}}}}}" for rotor, x, y, rotation, direction in ROTORS]
    return World(parse("\n".join(lines), Path("scenes/effects.yaml")))


def dropped_crate(effects: str) -> World:
    """A crate that falls into water."""
    return world_of({"crate": Box((0.6,) * 3, (0.0, 0.0, 1.0, 0.3, 0.2, 0.1), 60.0)}, SETTING, effects)


FLIGHTS = {
    "gravity": Flight(thrown_crate, "", 5.0, "a crate, thrown"),
    "drag": Flight(thrown_crate, "gravity: {}", 5.0, "a crate, thrown"),
    "linear_drag": Flight(hovering_quadrotors, "gravity: {}", 10.0, "two quadrotors, one above the other"),
    "wind": Flight(thrown_crate, "gravity: {}, drag: {}", 5.0, "a crate, thrown"),
    "gusts": Flight(hovering_quadrotors, "gravity: {}, drag: {}", 10.0, "two quadrotors, one above the other"),
    "ground_effect": Flight(hovering_quadrotors, "gravity: {}", 10.0, "two quadrotors, one above the other"),
    "downwash": Flight(hovering_quadrotors, "gravity: {}, drag: {}", 10.0, "two quadrotors, one above the other"),
    "motor_lag": Flight(hovering_quadrotors, "gravity: {}", 10.0, "two quadrotors, one above the other"),
    "water": Flight(dropped_crate, "gravity: {}", 5.0, "a crate, dropped"),
}


def measure(rounds: int, progress: Progress) -> dict[str, dict[str, Any]]:
    """Costs and distances by effect. Raises KeyError for an effect without a reference flight."""
    found = {}
    for effect in progress.track(EFFECTS, description="effects"):
        flight = FLIGHTS[effect]
        without = flight.start(flight.base)
        with_effect = flight.start(", ".join(filter(None, [flight.base, f"{effect}: {flight.parameters}"])))
        worlds = (with_effect, without)
        for world in worlds:
            advance(world, flight.seconds)
        movable = without.model.bodies.movable
        off = np.linalg.norm((with_effect.state.position_w - without.state.position_w)[movable], axis=1)
        found[effect] = {"us": cost(worlds, rounds), "off_m": float(off.max()), "seconds": flight.seconds,
                         "flight": flight.description, "bodies": int(movable.sum())}
    return found


def advance(world: World, seconds: float) -> None:
    """Runs the world, with a command to its drones every BLOCK s."""
    for _ in range(round(seconds / BLOCK)):
        command(world)
        world.run(round(BLOCK / world.dt))


def command(world: World) -> None:
    """Sends COMMAND to all drones."""
    for body in world.model.drones.body:
        world.command(world.model.bodies.names[body], COMMAND)


def cost(worlds: tuple[World, World], rounds: int) -> float:
    """CPU time in us per step by which the first world exceeds the second: median difference over the rounds."""
    differences = []
    states = [world.state.copy() for world in worlds]
    steps = [_steps(world) for world in worlds]
    for _ in range(rounds):
        taken = []
        for world, state, blocks in zip(worlds, states, steps, strict=True):
            world.state.assign(state)
            begin = process_time()
            for _ in range(blocks):
                command(world)
                world.run(STEPS)
            taken.append((process_time() - begin) / (blocks * STEPS))
        differences.append(1e6 * (taken[0] - taken[1]))
    return statistics.median(differences)


def _steps(world: World) -> int:
    """Number of repetitions of STEPS that take MIN_TIME."""
    begin = process_time()
    world.run(STEPS)
    return max(1, int(MIN_TIME / (process_time() - begin)))
