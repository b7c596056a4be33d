"""Motion with contact: nothing sinks, creeps, jitters or gains energy. Cases: bench/motion_cases.py"""

import pytest
from box_world import Setting
from motion_cases import CASES


@pytest.mark.parametrize("setting", CASES["stack"].settings, ids=str)
def test_a_stack_of_ten_boxes_stands_for_a_minute(setting: Setting) -> None:
    assert CASES["stack"].run(setting).failures == []


@pytest.mark.parametrize("setting", CASES["mass_ratio"].settings, ids=str)
def test_a_ton_stands_on_a_kilogram(setting: Setting) -> None:
    assert CASES["mass_ratio"].run(setting).failures == []


@pytest.mark.parametrize("setting", CASES["bounce"].settings, ids=str)
def test_ten_bounces_keep_the_energy(setting: Setting) -> None:
    assert CASES["bounce"].run(setting).failures == []


@pytest.mark.parametrize("setting", CASES["corner"].settings, ids=str)
def test_a_command_does_not_beat_the_contact_in_a_corner(setting: Setting) -> None:
    assert CASES["corner"].run(setting).failures == []


@pytest.mark.parametrize("setting", CASES["inside"].settings, ids=str)
def test_bodies_that_start_inside_each_other_part_slowly(setting: Setting) -> None:
    assert CASES["inside"].run(setting).failures == []


@pytest.mark.parametrize("setting", CASES["sticks"].settings, ids=str)
def test_just_below_the_friction_angle_a_crate_sticks(setting: Setting) -> None:
    assert CASES["sticks"].run(setting).failures == []


@pytest.mark.parametrize("setting", CASES["slides"].settings, ids=str)
def test_just_above_the_friction_angle_it_slides_as_coulomb_says(setting: Setting) -> None:
    assert CASES["slides"].run(setting).failures == []
