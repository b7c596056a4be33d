"""Poses of objects: of parents and children, and from the states that a renderer accepts."""

import numpy as np
import pytest

from drone_engine.world import World
from drone_render.frame.hierarchy import Hierarchy

from ..drawing import Make


def test_children_move_with_their_parents(make_scene: Make) -> None:
    scene = make_scene("""
objects:
  tip: {model: lamp, parent: arm, pose: [1, 0, 0]}
  arm: {model: lamp, parent: body, pose: [0, 0, 1, 0, 0, 1.5707963267948966]}
  body: {model: ball, pose: [5, 0, 0, 0, 0, 1.5707963267948966], mass: 1}
""")
    hierarchy = Hierarchy(scene)
    world = hierarchy.world(hierarchy.start)
    np.testing.assert_allclose(hierarchy.matrix(world, "tip")[:3, 3], [4, 0, 1], atol=1e-9)


SCENE = """
objects:
  rotor: {model: lamp, parent: drone, pose: [0.2, 0, 0.1], rotor: {direction: 1}}
  drone: {model: ball, pose: [0, 0, 5], mass: 1, flight: {cmd_vel: cmd_vel}}
  tree: {model: ball, pose: [9, 0, 0], static: true, collision: {level: none}}
"""


def test_a_world_gives_bodies_and_rotors_their_poses(make_scene: Make) -> None:
    scene = make_scene("effects: {gravity: {}}" + SCENE)
    world, hierarchy = World(scene), Hierarchy(scene)
    world.run(7)
    rotor, drone, tree = hierarchy.poses(world)
    np.testing.assert_array_equal(drone, world.pose("drone"))
    np.testing.assert_array_equal(tree, hierarchy.start[2])
    angle = float(world.state.rotor_angle[0])
    np.testing.assert_allclose(rotor, [0.2, 0, 0.1, 0, 0, np.sin(angle / 2), np.cos(angle / 2)], atol=1e-12)
    assert angle > 0.1


def test_poses_by_name_leave_the_others_at_the_start(make_scene: Make) -> None:
    hierarchy = Hierarchy(make_scene(SCENE))
    moved = np.array([1.0, 2, 3, 0, 0, 0, 1])
    poses = hierarchy.poses({"drone": moved})
    np.testing.assert_array_equal(poses[1], moved)
    np.testing.assert_array_equal(poses[[0, 2]], hierarchy.start[[0, 2]])
    np.testing.assert_array_equal(hierarchy.poses(None), hierarchy.start)
    np.testing.assert_array_equal(hierarchy.poses(poses), poses)


@pytest.mark.parametrize(("state", "message"), [
    (np.zeros((2, 7)), r"expected an array of shape \(3, 7\), got \(2, 7\)"),
    ({"house": np.zeros(7)}, "no object is called 'house' in the scene 'test'"),
    ({"drone": np.zeros(3)}, r"'drone': expected 7 numbers.*got an array of shape \(3,\)"),
])
def test_a_state_that_does_not_fit_is_an_error(make_scene: Make, state: object, message: str) -> None:
    with pytest.raises(ValueError, match=f"^poses: .*{message}$"):
        Hierarchy(make_scene(SCENE)).poses(state)  # type: ignore[arg-type]
