"""Smooth edges at the price of three fetches a pixel: each surface leaves a mark in the picture's alpha."""

from collections.abc import Hashable, Sequence

import moderngl
import numpy as np

from drone_render.context import Device
from drone_render.shaders import Variant
from drone_render.view import Array

SKY_MARK, WATER_MARK = 0.0, 1.0
MARKS = 254  # for solid surfaces; alpha has eight bits
STRIDE = 97  # coprime to MARKS: what follows each other in the scene gets marks far apart


def marks(surfaces: Sequence[Hashable]) -> Array:
    """The mark of each, (n,): equal ones have the same, others most probably have not."""
    number = {surface: i for i, surface in enumerate(dict.fromkeys(surfaces))}
    return np.array([(1 + number[surface] * STRIDE % MARKS) / 255 for surface in surfaces])


class EdgePass:
    """Draws the finished picture once more, with its edges smoothed."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._program = device.program(Variant("edges"))
        self._array = device.vertex_array(self._program)
        self._textures: dict[tuple[int, int], moderngl.Texture] = {}
        self._smooth: dict[tuple[int, int], moderngl.Framebuffer] = {}

    def target(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        """Where to draw a picture of that size."""
        target, self._textures[size] = self._device.textured_target(size)
        self._smooth[size] = self._device.target(size)
        return target

    def draw(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        """Smooths what was drawn; returns where it is."""
        target = self._smooth[size]
        target.use()
        self._device.context.enable_only(moderngl.NOTHING)
        self._textures[size].use(0)
        self._array.render(vertices=3)
        return target
