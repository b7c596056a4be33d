"""The debug view shows boxes where they are, red where they touch, and the contacts between them."""

from collections.abc import Callable

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message
from visualization_msgs.msg import Marker, MarkerArray

from drone_sim.markers import markers
from drone_sim.world import World

SCENE = """floor: {model: floor, static: true, collision: {level: floor}}
crate: {model: crate, mass: 5, poses: [[0, 0, 0], [5, 0, 3]]}"""


def read(world: World) -> dict[str, Marker]:
    data = markers(world, 1_500_000_000)
    array = deserialize_message(data, MarkerArray)
    assert len(data) == len(serialize_message(array))
    return {marker.ns: marker for marker in array.markers}


def corners(marker: Marker) -> np.ndarray:
    return np.array([(point.x, point.y, point.z) for point in marker.points])


def test_boxes_contacts_and_sectors(world: Callable[..., World]) -> None:
    scene = world(SCENE)
    for _ in range(10):
        scene.step()
    shown = read(scene)
    boxes = shown["boxes"]
    assert (boxes.header.frame_id, boxes.header.stamp.sec, boxes.type) == ("world", 1, Marker.LINE_LIST)
    assert len(boxes.points) == len(boxes.colors) == 2 * 24
    np.testing.assert_allclose(corners(boxes)[:24].min(0), [-0.3, -0.3, 0.0], atol=0.002)
    np.testing.assert_allclose(corners(boxes)[24:].max(0)[:2], [5.3, 0.3], atol=0.002)
    assert boxes.colors[0].r == 1.0  # the one on the floor touches
    assert boxes.colors[24].g > boxes.colors[24].r  # the falling one does not

    contacts = corners(shown["contacts"]).reshape(-1, 2, 3)
    assert len(contacts) == 4
    np.testing.assert_allclose(contacts[:, 1] - contacts[:, 0], [[0, 0, 0.3]] * 4, atol=1e-12)
    sectors = corners(shown["sectors"])
    assert sectors.min() < -0.3
    assert sectors.max() > 5.3


def test_an_empty_scene_has_empty_markers(world: Callable[..., World]) -> None:
    empty = world("floor: {model: floor, static: true, collision: {level: floor}}")
    empty.step()
    assert [len(marker.points) for marker in read(empty).values()] == [0, 0, 0, 0, 0]


def test_each_level_has_its_shape_and_colour(world: Callable[..., World]) -> None:
    scene = world("""ball: {model: crate, mass: 5, pose: [0, 0, 3], collision: {level: sphere}}
box: {model: crate, mass: 5, pose: [5, 0, 3], collision: {level: obb}}
tree: {model: crate, mass: 5, pose: [10, 0, 3], collision: {level: octree}}
fine: {model: crate, mass: 5, pose: [15, 0, 3], collision: {level: triangle}}""")
    scene.step()
    shown = read(scene)
    ball = corners(shown["spheres"])
    middle = [0, 0, ball[:, 2].mean()]
    np.testing.assert_allclose(np.linalg.norm(ball - middle, axis=1), 0.3 * np.sqrt(3), atol=1e-6)
    colours = {(colour.r, colour.g, colour.b) for colour in [*shown["boxes"].colors, *shown["spheres"].colors]}
    assert len(shown["boxes"].points) == 3 * 24 and len(colours) == 4
    nodes = corners(shown["octrees"])
    assert len(nodes) % 24 == 0 and len(nodes) > 4 * 24
    for left in (0, 5, 10, 15):  # boxes that meet none have octrees, too, as what is fine may come along
        own = nodes[np.abs(nodes[:, 0] - left) < 1]
        np.testing.assert_allclose(np.ptp(own, axis=0), 0.6, atol=1e-4)
