"""The debug view shows boxes and spheres of bodies, red where they touch one another, and their contacts."""

from collections.abc import Callable

import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from visualization_msgs.msg import Marker, MarkerArray

from drone_engine.collision_level import OBB
from drone_engine.math.poses import rotate_all
from drone_engine.world import World
from drone_sim.wire.markers import CONTACT, LENGTH, LEVELS, TOUCHING, Markers

SCENE = """floor: {model: floor, static: true, collision: {level: floor}}
crate: {model: crate, mass: 5, poses: [[0, 0, 0], [5, 0, 3]]}"""
Shown = dict[tuple[str, str], Marker]  # by namespace and frame


def read(world: World, depth: int = 3) -> Shown:
    data = Markers(world).message(1_500_000_000, depth)
    array = deserialize_message(data, MarkerArray)
    assert len(data) == len(serialize_message(array))
    assert len({(marker.ns, marker.id) for marker in array.markers}) == len(array.markers)
    return {(marker.ns, marker.header.frame_id): marker for marker in array.markers}


def corners(world: World, marker: Marker) -> np.ndarray:
    """Its points (n, 3) in the world."""
    points = np.array([(point.x, point.y, point.z) for point in marker.points]).reshape(-1, 3)
    at, turn = marker.pose.position, marker.pose.orientation
    assert (turn.x, turn.y, turn.z, turn.w) == (0, 0, 0, 1)
    points += (at.x, at.y, at.z)
    if marker.header.frame_id == "world":
        return points
    pose = world.pose(marker.header.frame_id)
    return pose[:3] + rotate_all(np.tile(pose[3:], (len(points), 1)), points)


def arrows(world: World, shown: Shown) -> tuple[np.ndarray, np.ndarray]:
    """Where the contacts' arrows start, (n, 3), and their ways, (n, 3)."""
    lines = np.concatenate([np.empty((0, 13, 2, 3)), *(
        corners(world, marker).reshape(-1, 13, 2, 3) for (ns, _), marker in shown.items() if ns == "contacts")])
    return lines[:, 8, 0], lines[:, 8, 1] - lines[:, 8, 0]


def color(marker: Marker) -> tuple[float, ...]:
    assert not marker.colors
    return tuple(round(float(part), 3) for part in (marker.color.r, marker.color.g, marker.color.b))


def test_boxes_contacts_and_sectors(world: Callable[..., World]) -> None:
    scene = world(SCENE)
    for _ in range(10):
        scene.step()
    shown = read(scene)
    box = shown["boxes", "crate_0"]
    assert (box.header.stamp.sec, box.header.stamp.nanosec, box.type) == (1, 500_000_000, Marker.LINE_LIST)
    assert (box.action, box.frame_locked, len(box.points)) == (Marker.ADD, True, 24)
    np.testing.assert_allclose(corners(scene, box).min(0), [-0.3, -0.3, 0.0], atol=0.002)
    np.testing.assert_allclose(corners(scene, shown["boxes", "crate_1"]).max(0)[:2], [5.3, 0.3], atol=0.002)

    start, way = arrows(scene, shown)
    assert len(start) == 4
    np.testing.assert_allclose(np.sort(start[:, 0]), [-0.3, -0.3, 0.3, 0.3], atol=0.002)
    np.testing.assert_allclose(start[:, 2], 0, atol=0.002)
    np.testing.assert_allclose(way, [[0, 0, LENGTH]] * 4, atol=1e-6)
    assert color(shown["contacts", "crate_0"]) == pytest.approx(CONTACT[:3])
    sectors = corners(scene, shown["sectors", "world"]).reshape(-1, 24, 3)
    low, high = sectors.min(axis=1), sectors.max(axis=1)
    assert len(np.unique(low, axis=0)) == len(low)
    for place in (scene.pose(name)[:3] + np.array([0, 0, 0.3]) for name in ("crate_0", "crate_1")):
        assert ((low <= place) & (place <= high)).all(axis=1).any()
    assert not ((low <= [2.5, 0, 0.3]) & (high >= [2.5, 0, 0.3])).all(axis=1).any()


def test_what_stands_on_something_static_is_not_red_and_what_hits_it_is(world: Callable[..., World]) -> None:
    scene = world("""floor: {model: floor, static: true, collision: {level: floor}}
base: {model: crate, static: true, pose: [10, 0, 0]}
wall: {model: crate, static: true, pose: [20, 0, 0]}
alone: {model: crate, mass: 5, pose: [0, 0, 0]}
above: {model: crate, mass: 5, pose: [10, 0, 0.6]}
beside: {model: crate, mass: 5, pose: [20.599, 0, 0]}
under: {model: crate, mass: 5, pose: [5, 0, 0]}
top: {model: crate, mass: 5, pose: [5, 0, 0.6]}
flying: {model: crate, mass: 5, pose: [0, 0, 9]}""")
    scene.step()
    shown = read(scene)
    red = {frame for (ns, frame), marker in shown.items() if ns == "boxes" and color(marker) == TOUCHING}
    assert red == {"under", "top", "wall", "beside"}
    assert color(shown["boxes", "alone"]) == color(shown["boxes", "flying"]) == LEVELS[OBB]
    assert {frame for ns, frame in shown if ns == "contacts"} == {"alone", "above", "beside", "under"}


def test_contacts_of_sleepers_stay(world: Callable[..., World]) -> None:
    scene = world(SCENE)
    before = []
    for _ in range(150):
        scene.step()
        before.append(len(arrows(scene, read(scene))[0]))
    assert not scene.state.is_awake.any() and scene.detection.manifolds.count == 0
    shown = read(scene)
    start, way = arrows(scene, shown)
    assert len(start) == 8
    assert min(before[1:]) == 4 and max(before) == 8  # neither twice nor not at all while one crate falls asleep
    np.testing.assert_allclose(way, [[0, 0, LENGTH]] * 8, atol=1e-3)
    np.testing.assert_allclose(start[:, 2], 0, atol=0.002)
    scene.sleep.wake(np.flatnonzero(scene.model.bodies.movable))
    scene.step()
    assert len(arrows(scene, read(scene))[0]) == 8


def test_contacts_go_with_a_body_that_slides(world: Callable[..., World]) -> None:
    """Those of a step are found as it starts, and drawn where the body is when it ends."""
    scene = world(SCENE.replace("mass: 5", "mass: 5, friction: 0.0"))
    scene.step()
    scene.state.velocity_w[0, 0] = scene.state.velocity_w[1, 0] = 6.0
    scene.step()
    scene.step()
    start, _ = arrows(scene, read(scene))
    x = scene.pose("crate_0")[0]
    assert x > 0.3
    np.testing.assert_allclose(np.sort(start[:, 0]), [x - 0.3, x - 0.3, x + 0.3, x + 0.3], atol=0.002)


def test_an_empty_scene_has_no_markers_but_an_empty_list_of_sectors(world: Callable[..., World]) -> None:
    empty = world("floor: {model: floor, static: true, collision: {level: floor}}")
    empty.step()
    assert [(ns, len(marker.points)) for (ns, _), marker in read(empty).items()] == [("sectors", 0)]


LEVEL_SCENE = """ball: {model: crate, mass: 5, pose: [0, 0, 3], collision: {level: sphere}}
box: {model: crate, mass: 5, pose: [5, 0, 3, 0, 0, 1], collision: {level: obb}}
tree: {model: crate, mass: 5, pose: [10, 0, 3], collision: {level: octree}}
fine: {model: crate, mass: 5, pose: [15, 0, 3], collision: {level: triangle}}
post: {model: crate, static: true, pose: [20, 0, 3], collision: {level: octree}}"""


def test_each_level_has_its_shape_and_color(world: Callable[..., World]) -> None:
    scene = world(LEVEL_SCENE)
    scene.step()
    shown = read(scene)
    for name in ("ball", "box", "tree", "fine"):  # all that moves has a bounding sphere, in the color of that level
        ball = shown["spheres", name]
        size, at = ball.scale, ball.pose.position
        assert ball.type == Marker.SPHERE and (size.x, size.y, size.z) == pytest.approx([0.6 * np.sqrt(3)] * 3)
        assert (at.x, at.y, at.z) == pytest.approx((0, 0, 0.3), abs=1e-4)
        assert color(ball) == color(shown["boxes", "ball"])
    assert ("spheres", "post") not in shown
    assert shown["spheres", "ball"].color.a > shown["spheres", "box"].color.a
    assert len({color(shown["boxes", name]) for name in ("ball", "box", "tree", "fine")}) == 4
    assert {frame for ns, frame in shown if ns == "octrees"} == {"tree", "fine"}
    for name in ("tree", "fine"):
        nodes = corners(scene, shown["octrees", name])
        assert len(nodes) % 24 == 0 and len(nodes) > 4 * 24
        np.testing.assert_allclose(np.ptp(nodes, axis=0), 0.6, atol=1e-4)


def test_octrees_are_as_deep_as_asked(world: Callable[..., World]) -> None:
    scene = world(LEVEL_SCENE)
    scene.step()
    markers = Markers(scene)  # one, so that what it has laid out for another depth must not stay

    def nodes(depth: int) -> int:
        array = deserialize_message(markers.message(0, depth), MarkerArray)
        return sum(len(m.points) // 24 for m in array.markers if (m.ns, m.header.frame_id) == ("octrees", "tree"))

    assert nodes(0) == 1
    assert nodes(1) == 6
    assert nodes(0) == 1
