"""More than colour: how far away each pixel is, and which object it shows."""

import math

import moderngl
import numpy as np

from drone_render.context import Device
from drone_render.image import Picture
from drone_render.shaders import Variant

NOTHING = (math.inf, 0.0)  # where no object is: too far away to be measured (REP-118), and no number


class RangePass:
    """Draws shapes with their distance and number instead of their colours."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self.program = device.program(Variant("range"))
        self._targets: dict[tuple[int, int], moderngl.Framebuffer] = {}

    def begin(self, size: tuple[int, int], view_projection: bytes) -> None:
        """Starts a picture of that size."""
        if size not in self._targets:
            self._targets[size] = self._device.target(size, components=2, dtype="f4")
        self._device.begin(self._targets[size], NOTHING)
        self.program["view_projection"].write(view_projection)  # type: ignore[union-attr]

    def read(self, depth: Picture, labels: Picture) -> None:
        """Puts distances (32FC1, m) and numbers (16UC1, from 1 in the scene's order) into two images."""
        target = self._targets[depth.width, depth.height]
        pixels = np.frombuffer(target.read(components=2, dtype="f4"), np.float32).reshape(-1, 2)
        for picture, values in ((depth, pixels[:, 0]), (labels, pixels[:, 1].astype(np.uint16))):
            np.frombuffer(picture.buffer, np.uint8)[picture.offset :] = np.ascontiguousarray(values).view(np.uint8)
