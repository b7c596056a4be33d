"""Motion with contact: no sinking, creep, jitter or gain of energy. Cases: reference/motion/cases.py"""

from collections.abc import Callable

import pytest

from reference.box_world import Setting
from reference.motion.cases import CASES

Hold = Callable[..., None]


@pytest.mark.parametrize("setting", CASES["stack"].settings, ids=str)
def test_a_stack_of_ten_boxes_stands_for_a_minute(setting: Setting, hold: Hold) -> None:
    hold("stack", setting)


@pytest.mark.parametrize("setting", CASES["mass_ratio"].settings, ids=str)
def test_a_heavy_box_stands_on_a_light_one(setting: Setting, hold: Hold) -> None:
    hold("mass_ratio", setting)


@pytest.mark.parametrize("setting", CASES["bounce"].settings, ids=str)
def test_ten_bounces_keep_the_energy(setting: Setting, hold: Hold) -> None:
    hold("bounce", setting)


@pytest.mark.parametrize("setting", CASES["corner"].settings, ids=str)
def test_a_command_cannot_push_a_drone_into_a_corner(setting: Setting, hold: Hold) -> None:
    hold("corner", setting)


@pytest.mark.parametrize("setting", CASES["corner_quadrotor"].settings, ids=str)
def test_the_thrust_of_a_quadrotor_cannot_push_it_into_a_corner(setting: Setting, hold: Hold) -> None:
    hold("corner_quadrotor", setting)


@pytest.mark.parametrize("setting", CASES["inside"].settings, ids=str)
def test_overlapping_bodies_separate_slowly(setting: Setting, hold: Hold) -> None:
    hold("inside", setting)


@pytest.mark.parametrize("setting", CASES["sticks"].settings, ids=str)
def test_just_below_the_friction_angle_a_crate_sticks(setting: Setting, hold: Hold) -> None:
    hold("sticks", setting)


@pytest.mark.parametrize("setting", CASES["slides"].settings, ids=str)
def test_just_above_the_friction_angle_it_slides_with_coulomb_friction(setting: Setting, hold: Hold) -> None:
    hold("slides", setting)
