"""Depth and segmentation: the distance of each pixel, and the object that it shows."""

import math

import moderngl
import numpy as np

from drone_render.arrays import Float32s, Labels
from drone_render.gl.device import Device
from drone_render.gl.uniforms import write
from drone_render.gl.variant import Variant

BACKGROUND = (math.inf, 0.0)  # where there is no object: depth out of range (REP-118), and label 0


class DepthPass:
    """Draws shapes with their depth and label instead of their color."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self.program = device.program(Variant("depth"))
        self._targets: dict[tuple[int, int], moderngl.Framebuffer] = {}

    def begin(self, size: tuple[int, int], view_projection: bytes) -> None:
        """Starts a picture of a size; view_projection: packed, column by column."""
        if size not in self._targets:
            self._targets[size] = self._device.target(size, components=2, dtype="f4")
        self._device.begin(self._targets[size], BACKGROUND)
        write(self.program, view_projection=view_projection)

    def read(self, size: tuple[int, int], depth: Float32s, labels: Labels) -> None:
        """Reads the depth in m and the label of each pixel into two arrays (height, width), the top row first."""
        target = self._targets[size]
        pixels = np.frombuffer(target.read(components=2, dtype="f4"), np.float32).reshape(*depth.shape, 2)
        depth[:] = pixels[..., 0]
        labels[:] = pixels[..., 1]
