"""Image and CameraInfo as serialized bytes, laid out once per camera; the pixels are drawn into their place."""

import struct
from collections.abc import Sequence

import numpy as np

from drone_engine.scene.picture import Camera
from drone_render.view import Array, intrinsics
from drone_sim.wire import layouts
from drone_sim.wire.cdr import SECOND, Layout, Message

STAMP = 4  # where the header's stamp starts, behind the name of the encoding


BYTES = {"rgb8": 3, "32FC1": 4, "16UC1": 2}  # of a pixel, by its encoding


class Picture:
    """The bytes of a sensor_msgs/Image, first row on top. `buffer[offset:]` are its pixels."""

    def __init__(self, size: tuple[int, int], frame: str, encoding: str = "rgb8") -> None:
        self.width, self.height = size
        step = BYTES[encoding] * self.width
        length = step * self.height
        layout = Layout().header(frame).uint32(self.height).uint32(self.width)
        layout.string(encoding).uint8(0).uint32(step).uint32(length)
        head = bytes(layout.message())
        self.offset = len(head)
        self.buffer = bytearray(head + bytes(length))

    def message(self, time_ns: int) -> bytes:
        """The finished message with its stamp."""
        struct.pack_into("<iI", self.buffer, STAMP, *divmod(time_ns, SECOND))
        return bytes(self.buffer)

    def pixels(self) -> bytes:
        """The pixels alone: rows from the top."""
        return bytes(memoryview(self.buffer)[self.offset :])


def camera_info(camera: Camera, frame: str) -> Message:
    """A sensor_msgs/CameraInfo of a pinhole camera without distortion; only the stamp is left to set."""
    width, height = camera.size
    layout = Layout().header(frame).uint32(height).uint32(width).string("plumb_bob")
    layout.uint32(5).float64("d", 5).float64("k", 9).float64("r", 9).float64("p", 12)
    layout.uint32(0).uint32(0)  # binning
    layout.uint32(0).uint32(0).uint32(0).uint32(0).uint8(0)  # region of interest: all
    message = layout.message()
    k = intrinsics(camera)
    message.write("k", k.ravel())
    message.write("r", np.eye(3).ravel())
    message.write("p", np.hstack([k, np.zeros((3, 1))]).ravel())
    return message


def transforms(links: Sequence[tuple[str, str, Array]]) -> Message:
    """A tf2_msgs/TFMessage of (parent, child, pose (7,)); stamp and 'pose' (n, 7) can be set again."""
    message = layouts.transforms([parent for parent, _, _ in links], [child for _, child, _ in links])
    if links:
        message.write("pose", np.array([pose for _, _, pose in links]))
    return message
