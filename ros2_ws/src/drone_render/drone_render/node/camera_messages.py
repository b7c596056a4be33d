"""Image, CameraInfo and TFMessage of a camera as serialized bytes, laid out once and then only filled in."""

import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Floats
from drone_engine.scene.picture import Camera
from drone_render.frame.view import intrinsics
from drone_sim.wire import layouts
from drone_sim.wire.cdr import SECOND, Layout, Message

STAMP = 4  # offset of the header's stamp, behind the four bytes of the encoding
PIXELS: dict[str, tuple[type[Any], tuple[int, ...]]] = {  # type and shape of a pixel, by encoding
    "rgb8": (np.uint8, (3,)), "32FC1": (np.float32, ()), "16UC1": (np.uint16, ())}


class ImageMessage:
    """A sensor_msgs/Image whose pixels are drawn in place.

    size: width and height in pixels; frame: frame_id; encoding: a key of PIXELS.
    """

    def __init__(self, size: tuple[int, int], frame: str, encoding: str = "rgb8") -> None:
        self.size = width, height = size
        dtype, shape = PIXELS[encoding]
        step = int(np.prod(shape, dtype=int)) * np.dtype(dtype).itemsize * width
        layout = Layout().header(frame).uint32(height).uint32(width)
        layout.string(encoding).uint8(0).uint32(step).uint32(step * height)
        head = bytes(layout.message())
        self._buffer = bytearray(head + bytes(step * height))
        self.pixels: NDArray[Any] = np.frombuffer(self._buffer, dtype, offset=len(head)).reshape(height, width, *shape)
        """(height, width) or (height, width, 3), the top row first; a view into the message."""

    def message(self, time_ns: int) -> bytes:
        """The finished message with its stamp, in ns of simulated time."""
        struct.pack_into("<iI", self._buffer, STAMP, *divmod(time_ns, SECOND))
        return bytes(self._buffer)


def camera_info(camera: Camera, frame: str) -> Message:
    """A sensor_msgs/CameraInfo of a pinhole camera without distortion, complete but for the stamp."""
    width, height = camera.size
    layout = Layout().header(frame).uint32(height).uint32(width).string("plumb_bob")
    layout.uint32(5).float64("d", 5).float64("k", 9).float64("r", 9).float64("p", 12)
    layout.uint32(0).uint32(0)  # binning
    layout.uint32(0).uint32(0).uint32(0).uint32(0).uint8(0)  # region of interest: the whole picture
    message = layout.message()
    k = intrinsics(camera)
    message.write("k", k.ravel())
    message.write("r", np.eye(3).ravel())
    message.write("p", np.hstack([k, np.zeros((3, 1))]).ravel())
    return message


def transforms(links: Sequence[tuple[str, str, Floats]]) -> Message:
    """A tf2_msgs/TFMessage of (parent, child, pose (7,)); the stamp and 'pose' (n, 7) can be changed later."""
    message = layouts.transforms([parent for parent, _, _ in links], [child for _, child, _ in links])
    if links:
        message.write("pose", np.array([pose for _, _, pose in links]))
    return message
