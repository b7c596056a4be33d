"""The memory of a camera without subscribers."""

import tracemalloc
from collections.abc import Iterator

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node

from drone_engine.scene.picture import Camera
from drone_render.node.camera_publisher import CameraPublisher


@pytest.fixture
def node() -> Iterator[Node]:
    context = Context()
    rclpy.init(context=context)
    made = rclpy.create_node("cameras", context=context)
    yield made
    made.destroy_node()
    rclpy.shutdown(context=context)


def test_a_camera_that_nobody_looks_through_has_no_pictures(node: Node) -> None:
    camera = Camera(size=(4096, 4096))
    tracemalloc.start()
    publisher = CameraPublisher(node, "wide", camera)
    assert tracemalloc.get_traced_memory()[0] < 1_000_000
    for picture, pixel in ((publisher.picture, 3), (publisher.depth, 4), (publisher.labels, 2)):
        assert picture.pixels.nbytes == 4096 * 4096 * pixel
    tracemalloc.stop()
    assert publisher.depth is publisher.depth
    publisher.close()
