"""`drone_engine step SCENE`: the stages of a step in order, their kernels, and the arrays that each reads and writes.

Everything is taken from the world that runs: nothing of it is written twice by hand. `--page FILE` writes the part of
docs/step.md between its two markers, for a scene that has every stage.
"""

import argparse
import inspect
import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drone_engine.assets import ASSETS
from drone_engine.program import access
from drone_engine.program.program import Program
from drone_engine.program.stage import Stage
from drone_engine.scene.errors import SceneError
from drone_engine.scene.loading import load, parse
from drone_engine.world import World

EVERYTHING = """
version: 1
description: A scene with every stage
collision: {level: octree}
effects: {wind: {}, gusts: {}, downwash: {}, gravity: {}, drag: {}, linear_drag: {}, ground_effect: {}, water: {},
          motor_lag: {}}
objects:
  user_drone: {model: drone, pose: [0, 0, 2], mass: 1.4, flight: {cmd_vel: cmd_vel}}
  user_drone_rotor: {model: drone_rotor_cw, parent: user_drone, pose: [0.19, 0.19, 0.066], rotor: {direction: -1}}
  quadrotor:
    model: drone
    pose: [4, 0, 2]
    mass: 1.4
    flight: {model: quadrotor, cmd_vel: quadrotor/cmd_vel, quadrotor: {rotor_drag: 8.06428e-5}}
  quadrotor_front_left: {model: drone_rotor_cw, parent: quadrotor, pose: [0.19, 0.19, 0.066], rotor: {direction: -1}}
  quadrotor_front_right: {model: drone_rotor_ccw, parent: quadrotor, pose: [0.19, -0.19, 0.066], rotor: {direction: 1}}
  quadrotor_rear_left: {model: drone_rotor_ccw, parent: quadrotor, pose: [-0.19, 0.19, 0.066], rotor: {direction: 1}}
  quadrotor_rear_right: {model: drone_rotor_cw, parent: quadrotor, pose: [-0.19, -0.19, 0.066], rotor: {direction: -1}}
  island: {model: island, static: true, collision: {level: ground}}
"""
BEGIN = "<!-- written by `python -m drone_engine step --page docs/step.md` -->"
END = "<!-- end of what is written -->"
SOURCES = "ros2_ws/src/"  # of the packages, from the root of the repository
RECORD_FIELDS = 12  # of a record that are listed by name


class Row(NamedTuple):
    """A stage, as the page shows it."""

    stage: str
    kernel: str  # module.function; '' for a stage in Python
    source: str  # file:line, from the folder of the packages
    purpose: str  # first sentence of the kernel's docstring
    reads: tuple[str, ...]
    writes: tuple[str, ...]


def everything() -> World:
    """A world that has every stage but those of sleep, which gusts do not allow."""
    return World(parse(EVERYTHING, ASSETS / "scenes" / "everything.yaml"))


def rows(program: Program, world: World) -> list[Row]:
    """The stages of a program of a world, in order."""
    every = (stage for _, _, other in programs(world) for stage in other.stages)
    uses = Counter(id(value) for stage in every for value in stage.given.values() if isinstance(value, np.ndarray))
    passed_on = {array for array, stages in uses.items() if stages > 1}
    return [_row(stage, passed_on) for stage in program.stages if not stage.timer]


def _row(stage: Stage, passed_on: set[int]) -> Row:
    found = access.of_stage(stage)
    reads, writes = (tuple(sorted(name for name in names if _visible(stage, name, passed_on))) for names in found)
    if stage.kernel is None:
        return Row(stage.name, "", "", "Runs in Python.", reads, writes)
    function = stage.kernel.py_func
    package = Path(inspect.getfile(sys.modules[function.__module__.partition(".")[0]])).parents[1]
    source = Path(inspect.getfile(function)).relative_to(package.parent)
    text = inspect.getdoc(function) or ""
    purpose = re.split(r"(?<=[.:;])\s|\n\n", text.replace("\n", " "))[0].rstrip(".:;")
    return Row(stage.name, f"{function.__module__}.{function.__name__}", str(source), purpose + ".", reads, writes)


def _visible(stage: Stage, name: str, passed_on: set[int]) -> bool:
    """Whether other stages may see an array; the rest is scratch and parameters."""
    root = name.partition(".")[0]
    return root in stage.scope or id(stage.given.get(root)) in passed_on


def programs(world: World) -> Iterator[tuple[str, str, Program]]:
    """The programs of a world with their headings and what they are."""
    yield "Step", "once per step, in this order", world.program
    yield "Sub-step", "at the beginning of every sub-step, from within the stage 'motion'", world.substep_program
    yield "Force", "for every evaluation of forces, from within the stage 'motion'", world.force_program


def page(world: World) -> str:
    """The stages as Markdown."""
    parts = []
    for heading, when, program in programs(world):
        found = rows(program, world)
        parts.append(f"## {heading} stages\n\nThey run {when}.\n")
        parts.append("| stage | kernel | purpose |\n|---|---|---|")
        parts += [f"| {row.stage} | {_link(row)} | {row.purpose.replace('|', '/')} |" for row in found]
        parts.append("")
        for row in found:
            parts.append(f"### {heading}: {row.stage}\n\n- reads {_names(row.reads)}\n- writes {_names(row.writes)}\n")
    return "\n".join(parts)


def _link(row: Row) -> str:
    name = row.kernel.removeprefix("drone_engine.")
    return f"[`{name}`](../{SOURCES}{row.source})" if row.kernel else "in Python"


def _names(names: tuple[str, ...]) -> str:
    """The names, with the fields of one record together."""
    records: dict[str, list[str]] = {}
    for name in names:
        record, _, field = name.partition(".")
        records.setdefault(record, []).append(field)
    shown = []
    for record, fields in records.items():
        if fields == [""]:
            shown.append(f"`{record}`")
        elif len(fields) > RECORD_FIELDS:
            shown.append(f"`{record}` ({len(fields)} arrays)")
        else:
            shown.append(f"`{record}.`{{{', '.join(fields)}}}")
    return ", ".join(shown) or "nothing that other stages see"


def with_page(text: str, world: World) -> str:
    """The text of docs/step.md with the part between the markers written from the program."""
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n\n{page(world)}\n{END}{after}"


def main(arguments: list[str] | None = None) -> int:
    """The command; returns its exit status."""
    parser = argparse.ArgumentParser(prog="drone_engine step", description="Lists the stages of a step.")
    parser.add_argument("scene", nargs="?", help="name or file of a scene; without it: a scene with every stage")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write the stages into this Markdown page")
    options = parser.parse_args(arguments)
    try:
        world = World(load(options.scene)) if options.scene else everything()
    except SceneError as error:
        print(f"drone_engine step: {error}", file=sys.stderr)
        return 2
    if options.page:
        options.page.write_text(with_page(options.page.read_text(), world))
        return 0
    for heading, when, program in programs(world):
        print(f"{heading} stages, {when}:")
        for row in rows(program, world):
            print(f"  {row.stage:16} {row.kernel or 'in Python'}\n    {row.purpose}")
            print(f"    reads  {', '.join(row.reads) or '-'}\n    writes {', '.join(row.writes) or '-'}")
    return 0
