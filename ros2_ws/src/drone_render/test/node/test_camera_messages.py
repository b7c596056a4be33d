"""Image and CameraInfo as bytes, against the real message types."""

import numpy as np
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CameraInfo, Image

from drone_engine.scene.picture import Camera
from drone_render.frame.view import OPTICAL, intrinsics
from drone_render.node.camera_messages import ImageMessage, camera_info, transforms
from drone_sim.wire.cdr import read_transforms

STAMP = 12_000_000_345  # ns


def test_a_picture_is_an_image_message() -> None:
    picture = ImageMessage((5, 3), "chase_optical")
    pixels = np.arange(45, dtype=np.uint8)
    picture.pixels[:] = pixels.reshape(3, 5, 3)
    image = deserialize_message(picture.message(STAMP), Image)
    assert (image.header.stamp.sec, image.header.stamp.nanosec) == (12, 345)
    assert (image.header.frame_id, image.encoding, image.is_bigendian) == ("chase_optical", "rgb8", 0)
    assert (image.height, image.width, image.step) == (3, 5, 15)
    assert bytes(image.data) == pixels.tobytes() == picture.pixels.tobytes()


def test_camera_info_is_a_camera_info_message() -> None:
    camera = Camera(size=(320, 240), fov=1.0)
    message = camera_info(camera, "chase_optical")
    message.stamp(STAMP)
    info = deserialize_message(bytes(message), CameraInfo)
    k = intrinsics(camera)
    assert (info.header.stamp.sec, info.header.stamp.nanosec, info.header.frame_id) == (12, 345, "chase_optical")
    assert (info.height, info.width, info.distortion_model, list(info.d)) == (240, 320, "plumb_bob", [0.0] * 5)
    np.testing.assert_array_equal(info.k, k.ravel())
    np.testing.assert_array_equal(info.r, np.eye(3).ravel())
    np.testing.assert_array_equal(np.reshape(info.p, (3, 4)), np.hstack([k, np.zeros((3, 1))]))
    assert (info.binning_x, info.roi.width, info.roi.do_rectify) == (0, 0, False)


def test_transforms_are_a_tf_message() -> None:
    read = read_transforms(bytes(transforms([("world", "chase", OPTICAL), ("chase", "chase_optical", OPTICAL)])))
    assert (read.parents, read.children) == (("world", "chase"), ("chase", "chase_optical"))
    np.testing.assert_array_equal(read.poses, [OPTICAL, OPTICAL])
