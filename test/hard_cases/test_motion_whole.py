"""Whole scenes: fast shots, long runs, repeated runs, a stalled clock. Cases: reference/motion/cases.py

`make hard-cases` has the large counts: 10,000 shots and a million steps.
"""

import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from reference.box_world import Setting
from reference.motion import scenes
from reference.motion.cases import CASES

Hold = Callable[..., None]

ROOT = Path(__file__).parents[2]
SHOTS, STEPS = 1000, 20_000


@pytest.mark.parametrize("setting", CASES["plate"].settings, ids=str)
def test_no_shot_passes_through_a_thin_plate(setting: Setting, hold: Hold) -> None:
    hold("plate", setting, partial(scenes.plate, shots=SHOTS))


@pytest.mark.parametrize("setting", CASES["island"].settings, ids=str)
def test_nothing_at_rest_in_the_island_drifts(setting: Setting, hold: Hold) -> None:
    hold("island", setting, partial(scenes.island, steps=STEPS))


@pytest.mark.parametrize("setting", CASES["repeats"].settings, ids=str)
def test_the_same_commands_give_the_same_states_bit_for_bit(setting: Setting, hold: Hold) -> None:
    hold("repeats", setting)


@pytest.mark.parametrize("setting", CASES["repeats"].settings, ids=str)
def test_another_process_reaches_the_same_state(setting: Setting) -> None:
    world = scenes.heap(setting)
    for commands in scenes.flight(200):
        world.step(commands)
    program = ("from reference.motion import scenes\nfrom reference.box_world import Setting\n"
               f"world = scenes.heap({setting!r})\n"
               "for commands in scenes.flight(200): world.step(commands)\n"
               "print(world.state.hash())")
    other = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert other.stdout.strip() == world.state.hash()


@pytest.mark.parametrize("setting", CASES["stall"].settings, ids=str)
def test_a_stalled_clock_causes_no_jump(setting: Setting, hold: Hold) -> None:
    hold("stall", setting)
