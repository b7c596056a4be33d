"""More than colour: how far away each pixel is, and which object it shows."""

import math

import moderngl
import numpy as np

from drone_render.context import Device
from drone_render.image import Picture
from drone_render.instances import Instances
from drone_render.shaders import Variant
from drone_render.view import Array

NOTHING = (math.inf, 0.0)  # where no object is: too far away to be measured (REP-118), and no number


class RangePass:
    """Draws shapes with their distance and number instead of their colours."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self.program = device.program(Variant("range"))
        self.single = Instances(device)
        """For what is drawn by itself."""
        self._targets: dict[tuple[int, int], moderngl.Framebuffer] = {}

    def begin(self, size: tuple[int, int], view_projection: bytes) -> None:
        """Starts a picture of that size."""
        if size not in self._targets:
            self._targets[size] = self._device.target(size, components=2, dtype="f4")
        self._device.context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._targets[size].use()
        self._targets[size].clear(*NOTHING)
        self.program["view_projection"].write(view_projection)  # type: ignore[union-attr]

    def place(self, model: Array, row: int) -> None:
        """What is drawn by itself next: the matrix (4, 4) of an object, and its row in the scene."""
        self.single.fill(model[None], np.array([row + 1.0]), [])

    def read(self, depth: Picture, labels: Picture) -> None:
        """Puts distances (32FC1, m) and numbers (16UC1, from 1 in the scene's order) into two images."""
        target = self._targets[depth.width, depth.height]
        pixels = np.frombuffer(target.read(components=2, dtype="f4"), np.float32).reshape(-1, 2)
        for picture, values in ((depth, pixels[:, 0]), (labels, pixels[:, 1].astype(np.uint16))):
            np.frombuffer(picture.buffer, np.uint8)[picture.offset :] = np.ascontiguousarray(values).view(np.uint8)
