"""Collision levels in a running scene: which one applies, and that bodies rest on meshes."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drone_engine import SceneError, parse
from drone_engine.collision.policy import look_up
from drone_engine.geometry.mesh import MeshError
from drone_engine.world import World

ON_A_WALL = """crate: {model: crate, pose: [0, 0.3, 4.001, 0, 0, 0.4], mass: 5}
wall: {model: wall, static: true}
"""
LEVELS = ("sphere", "obb", "octree", "triangle")


def settings(level: str, more: str = "") -> str:
    """The sections of a scene that set gravity and the collision level."""
    return f"effects: {{gravity: {{}}}}\ncollision: {{level: {level}{more}}}"


@pytest.mark.parametrize("level", ["obb", "octree", "triangle"])
def test_a_crate_rests_on_a_wall(world: Callable[..., World], level: str) -> None:
    w = world(ON_A_WALL, settings(level))
    for _ in range(30):
        w.step()
    before = w.pose("crate")
    for _ in range(60):
        w.step()
    assert w.contact_counts()[level] == 1
    assert [(event.level, event.phase) for event in w.events] == [(LEVELS.index(level), 1)]
    np.testing.assert_allclose(w.pose("crate")[:3], before[:3], atol=2e-4)
    assert w.pose("crate")[2] == pytest.approx(4.0, abs=1e-3)
    manifolds = w.detection.manifolds
    assert manifolds.points[0] >= 4
    np.testing.assert_allclose(manifolds.normal_w[0], [0, 0, -1], atol=1e-6)  # from the crate to the wall


@pytest.mark.parametrize("yaw", [0.0, 0.4])
@pytest.mark.parametrize("level", ["obb", "octree", "triangle"])
def test_a_crate_may_hang_over_an_edge(world: Callable[..., World], level: str, yaw: float) -> None:
    """A third of it, so that its centre of mass is a tenth of a metre inside."""
    w = world(f"crate: {{model: crate, pose: [0.4, 0, 4.001, 0, 0, {yaw}], mass: 5, friction: 0.8}}\n"
              "wall: {model: wall, static: true}", settings(level))
    w.run(300)
    assert w.pose("crate")[:3] == pytest.approx([0.4, 0.0, 4.0], abs=2e-3)


@pytest.mark.parametrize("level", LEVELS)
def test_a_crate_rests_on_a_floor(world: Callable[..., World], level: str) -> None:
    w = world("crate: {model: crate, pose: [0, 0, 0.3], mass: 5}\n"
              "floor: {model: floor, static: true, collision: {level: floor}}", settings(level))
    for _ in range(60):
        w.step()
    lowest = 0.3 - 0.3 * np.sqrt(3.0) if level == "sphere" else 0.0
    assert w.pose("crate")[2] == pytest.approx(-lowest, abs=2e-3)


@pytest.mark.parametrize("level", LEVELS[1:])
def test_a_crate_slides_into_a_corner_and_stays(world: Callable[..., World], level: str) -> None:
    w = world("crate: {model: crate, pose: [1.2, 0.2, 0, 0, 0, 0.2], mass: 5, friction: 0.1}\n"
              "wall: {model: wall, static: true}\nfloor: {model: floor, static: true, collision: {level: floor}}",
              settings(level))
    w.state.velocity_w[0] = (-3.0, 0.0, 0.0)
    for _ in range(90):
        w.step()
    assert w.pose("crate")[0] > 0.7
    assert abs(w.state.velocity_w[0, 0]) < 1.0


def test_the_finer_of_two_overrides_applies_and_one_of_the_pair_precedes(world: Callable[..., World]) -> None:
    things = """a: {model: crate, mass: 1, collision: {level: sphere}}
b: {model: crate, mass: 1, pose: [5, 0, 0], collision: {level: triangle}}
c: {model: crate, mass: 1, pose: [9, 0, 0]}
d_0: {model: crate, mass: 1, pose: [15, 0, 0]}
d_1: {model: crate, mass: 1, pose: [19, 0, 0]}
"""
    w = world(things, settings("obb", ", pairs: [{between: [a, c], level: octree}, {between: [d, c], level: none}]"))
    levels, all_contacts = np.empty((2, 6), np.int64)
    look_up(6, np.array([0, 0, 1, 2, 2, 0]), np.array([1, 2, 2, 3, 4, 3]), *w.detection.levels.tables(), levels,
            all_contacts)
    assert levels.tolist() == [3, 2, 3, -1, -1, 0]


def test_levels_change_while_running_until_the_scene_is_reset(world: Callable[..., World]) -> None:
    w = world(ON_A_WALL, settings("obb"))
    for level, a, b in (("triangle", "", ""), ("octree", "crate", ""), ("obb", "wall", "crate"),
                        ("sphere", "crate", "wall")):
        w.set_collision_level(level, a, b)
        w.step()
        assert {name for name, count in w.contact_counts().items() if count} == {level}
    w.set_collision_level("triangle", "wall", "crate")
    w.reset()
    w.step()
    assert w.contact_counts()["obb"] == 1


@pytest.mark.parametrize(("arguments", "error"), [
    (("box",), "level: expected one of sphere, obb, octree, triangle, got 'box'"),
    (("obb", "plane"), "a: no body is called 'plane'; there are crate, wall"),
    (("obb", "", "wall"), "a: expected an object where b names one"),
    (("obb", "wall", "wall"), "b: expected another object than 'wall'"),
])
def test_an_invalid_level_is_rejected(world: Callable[..., World], arguments: tuple[str, ...], error: str) -> None:
    w = world(ON_A_WALL, settings("obb"))
    with pytest.raises(ValueError, match=error):
        w.set_collision_level(*arguments)


def test_the_first_contact_alone(world: Callable[..., World]) -> None:
    for level in ("obb", "triangle"):
        w = world(ON_A_WALL, settings(level, ", contacts: first"))
        w.step()
        assert w.detection.manifolds.points[: w.detection.manifolds.count].tolist() == [1]


def test_a_pair_of_unknown_objects_is_an_error(world: Callable[..., World]) -> None:
    with pytest.raises(SceneError, match=r"collision.pairs.0.between: no object is called 'tree'"):
        world(ON_A_WALL, settings("obb", ", pairs: [{between: [crate, tree], level: none}]"))


def test_a_pair_with_a_part_of_an_object_is_an_error(world: Callable[..., World]) -> None:
    with pytest.raises(SceneError, match=r"collision.pairs.0.between: 'lid' is part of another object; name that one"):
        world(ON_A_WALL + "lid: {model: crate, parent: crate}",
              settings("obb", ", pairs: [{between: [wall, lid], level: none}]"))


def test_two_runs_at_the_finest_level_are_equal_bit_for_bit(world: Callable[..., World]) -> None:
    hashes = []
    for _ in range(2):
        w = world(ON_A_WALL.replace("4.001", "4.3"), settings("triangle"))
        for _ in range(60):
            w.step()
        hashes.append(w.state.hash())
    assert hashes[0] == hashes[1]


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("speed", [30.0, 300.0, 1000.0])
def test_a_crate_is_never_shot_through_a_wall(world: Callable[..., World], level: str, speed: float) -> None:
    w = world("crate: {model: crate, pose: [14, 0.2, 1.5, 0.3, 0.2, 0.1], mass: 5}\nwall: {model: wall, static: true}",
              settings(level).replace("gravity: {}", ""))
    w.state.velocity_w[0] = (-speed, 0.0, 0.0)
    w.state.angular_velocity_w[0] = (3.0, 5.0, 2.0)
    nearest, met = [], False
    for _ in range(60):
        w.step()
        nearest.append(w.state.position_w[0, 0])
        met = met or w.state.velocity_w[0, 0] > 0.0  # bounced within the step, from any distance
    assert min(nearest) > 0.75
    assert met


def test_a_level_that_cannot_be_applied_changes_nothing(tmp_path: Path) -> None:
    box = "".join(f"v {x} {y} {z}\n" for x in (-1, 1) for y in (-1, 1) for z in (-1, 1))
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "points.obj").write_text(box)
    w = World(parse("version: 1\neffects: {gravity: {}}\nobjects:\n"
                    "  a: {model: points, mass: 1, pose: [0, 0, 3]}\n  b: {model: points, static: true}\n",
                    tmp_path / "scenes" / "two.yaml"))
    w.run(60)
    with pytest.raises(MeshError, match="has no faces"):
        w.set_collision_level("triangle")
    w.run(60)
    assert w.pose("a")[2] == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize("sleep", ["true", "false"])
def test_a_change_of_level_leaves_contacts_as_they_are(world: Callable[..., World], sleep: str) -> None:
    """Contacts persist; they do not begin again."""
    w = world(ON_A_WALL, settings("obb") + f"\ndynamics: {{sleep: {sleep}}}")
    w.run(60)
    w.set_collision_level("triangle")
    w.step()
    assert [event.phase for event in w.events] == [1]


def test_nothing_is_detected_where_nothing_can_touch(world: Callable[..., World]) -> None:
    w = world("crate: {model: crate, mass: 1}")
    w.detect()
    assert w.events == []
