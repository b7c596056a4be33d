"""The stages of a step: their page is what the program prints, and they write only what they are said to write."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from drone_engine.explain import step
from drone_engine.program import access, binding
from drone_engine.program.program import Program
from drone_engine.program.stage import Stage
from drone_engine.scene.loading import load
from drone_engine.world import World

PAGE = Path(__file__).parents[5] / "docs" / "step.md"
CHANGED_BY_INNER_PROGRAMS = ("force", "torque", "air_velocity", "thrust")  # within the stage 'motion'


def test_the_page_is_what_the_program_prints() -> None:
    text = PAGE.read_text()
    assert step.with_page(text, step.everything()) == text, "write it: python -m drone_engine step --page docs/step.md"


def arrays_of(stage: Stage) -> Iterator[tuple[str, np.ndarray]]:
    """The arrays that a stage takes, by their names."""
    for name, value in zip(binding.parameters(stage), binding.arguments(stage), strict=True):
        for path, leaf in binding.leaves(value, name):
            if isinstance(leaf, np.ndarray):
                yield path, leaf


def written(program: Program, stage: Stage) -> set[str]:
    """Runs one stage; the names of the arrays that it takes and that have other contents afterwards."""
    before = {path: array.copy() for path, array in arrays_of(stage)}
    program.run_through(stage, stage)
    return {path for path, array in arrays_of(stage)
            if array.shape == before[path].shape and array.tobytes() != before[path].tobytes()}


@pytest.mark.parametrize("scene", ["everything", "hangar"])
def test_stages_write_what_they_declare_and_nothing_else(scene: str) -> None:
    world = step.everything() if scene == "everything" else World(load(scene))
    world.compile()
    drones = [world.model.bodies.names[i] for i in world.model.drones.body]
    for k in range(40):
        for drone in drones:
            world.command(drone, (2.0, 0.5, -1.0, 0.3) if k % 20 < 10 else (-2.0, 0.0, 1.0, 0.0))
        for program in (world.substep_program, world.force_program, world.program):
            for stage in program.stages:
                if stage.kernel is not None:
                    undeclared = written(program, stage) - access.of_stage(stage).writes
                    if stage is world.motion.stage:
                        undeclared = {path for path in undeclared
                                      if path.removeprefix("forces.") not in (*CHANGED_BY_INNER_PROGRAMS,
                                                                              "inverse_mass", "inertia")}
                    assert not undeclared, f"stage '{stage.name}' writes {undeclared}"


def test_a_stage_that_writes_an_array_by_a_row_is_found_out() -> None:
    world = step.everything()
    writes = {row.stage: set(row.writes) for row in step.rows(world.program, world)}
    assert {"wanted", "hold", "landed"} == writes["pilot"]
    assert {"pairs.level", "pairs.all_contacts"} <= writes["broad phase"]  # through a tuple of arrays
    moved = {f"states.{name}" for name in ("position", "orientation", "velocity", "angular_velocity")}
    assert {*moved, "contacts.total"} <= writes["motion"]
    assert {"contacts.impulse", "contacts.friction_impulse"} == writes["warm start"]
