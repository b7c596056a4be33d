"""What each effect costs a step, and how far a reference flight ends from where it does without it."""

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
BLOCK = 0.5  # s of simulated time between commands, and in one timing
LEAST = 0.05  # s of CPU time in one timing
STEPS = 100  # between commands, while timing
ROTORS = (("front_left", 0.19, 0.19, "cw", -1), ("front_right", 0.19, -0.19, "ccw", 1),
          ("rear_left", -0.19, 0.19, "ccw", 1), ("rear_right", -0.19, -0.19, "cw", -1))
COMMAND = (1.5, 0.0, 0.0, 0.2)  # m/s, rad/s


class Flight(NamedTuple):
    """What an effect is shown on: the world with these effects, and with them and the one."""

    start: Callable[[str], World]
    base: str  # effects, as YAML
    seconds: float
    says: str
    words: str = "{}"  # what the scene says of the effect


def throw(effects: str) -> World:
    """A crate, thrown from a tower."""
    world = world_of({"crate": Box((0.6,) * 3, (0.0, 0.0, 200.0), 20.0)}, SETTING, effects)
    world.state.velocity_w[0] = (15.0, 0.0, 10.0)
    world.state.angular_velocity_w[0] = (0.3, 0.5, 0.1)
    return world


def fly(effects: str) -> World:
    """Two quadrotors close over the ground, one above the other."""
    lines = [f"version: 1\n{SETTING.yaml()}effects: {{{effects}}}\nobjects:",
             "  floor: {model: hangar_floor, static: true, collision: {level: floor}}"]
    for drone, height in (("lower", 0.3), ("upper", 1.5)):
        lines.append(f"  {drone}: {{model: drone, pose: [0, 0, {height}], mass: 1.5, "
                     "flight: {model: quadrotor, cmd_vel: cmd_vel}}")
        lines += [f"  {drone}_{place}: {{model: drone_rotor_{turns}, parent: {drone}, pose: [{x}, {y}, 0.066], "
                  f"rotor: {{direction: {direction}}}}}" for place, x, y, turns, direction in ROTORS]
    return World(parse("\n".join(lines), Path("scenes/effects.yaml")))


def dip(effects: str) -> World:
    """A crate that falls into water."""
    return world_of({"crate": Box((0.6,) * 3, (0.0, 0.0, 1.0, 0.3, 0.2, 0.1), 60.0)}, SETTING, effects)


FLIGHTS = {
    "gravity": Flight(throw, "", 5.0, "a crate, thrown"),
    "drag": Flight(throw, "gravity: {}", 5.0, "a crate, thrown"),
    "linear_drag": Flight(fly, "gravity: {}", 10.0, "two quadrotors, one above the other"),
    "wind": Flight(throw, "gravity: {}, drag: {}", 5.0, "a crate, thrown"),
    "gusts": Flight(fly, "gravity: {}, drag: {}", 10.0, "two quadrotors, one above the other"),
    "ground_effect": Flight(fly, "gravity: {}", 10.0, "two quadrotors, one above the other"),
    "downwash": Flight(fly, "gravity: {}, drag: {}", 10.0, "two quadrotors, one above the other"),
    "motor_lag": Flight(fly, "gravity: {}", 10.0, "two quadrotors, one above the other"),
    "water": Flight(dip, "gravity: {}", 5.0, "a crate, dropped"),
}


def measure(rounds: int, progress: Progress) -> dict[str, dict[str, Any]]:
    """By effect. Raises KeyError for one that has no reference flight."""
    found = {}
    for effect in progress.track(EFFECTS, description="effects"):
        flight = FLIGHTS[effect]
        plain = flight.start(flight.base)
        full = flight.start(", ".join(filter(None, [flight.base, f"{effect}: {flight.words}"])))
        worlds = (full, plain)
        for world in worlds:
            advance(world, flight.seconds)
        moving = plain.model.bodies.movable
        off = np.linalg.norm((full.state.position_w - plain.state.position_w)[moving], axis=1)
        found[effect] = {"us": cost(worlds, rounds), "off_m": float(off.max()), "seconds": flight.seconds,
                         "flight": flight.says, "bodies": int(moving.sum())}
    return found


def advance(world: World, seconds: float) -> None:
    for _ in range(round(seconds / BLOCK)):
        command(world)
        world.run(round(BLOCK / world.dt))


def command(world: World) -> None:
    for body in world.model.drones.body:
        world.command(world.model.bodies.names[body], COMMAND)


def cost(worlds: tuple[World, World], rounds: int) -> float:
    """us of CPU time a step that the first world takes longer than the second, the median of the differences."""
    differences = []
    states = [world.state.copy() for world in worlds]
    steps = [_steps(world) for world in worlds]
    for _ in range(rounds):
        taken = []
        for world, state, many in zip(worlds, states, steps, strict=True):
            world.state.assign(state)
            begin = process_time()
            for _ in range(many):
                command(world)
                world.run(STEPS)
            taken.append((process_time() - begin) / (many * STEPS))
        differences.append(1e6 * (taken[0] - taken[1]))
    return statistics.median(differences)


def _steps(world: World) -> int:
    """How many times STEPS take LEAST s."""
    begin = process_time()
    world.run(STEPS)
    return max(1, int(LEAST / (process_time() - begin)))
