"""Antialiasing of the edges between surfaces: each surface leaves a mark in alpha, and one more pass blends there.

It costs three texel fetches a pixel. Textures stay sharp, and so do edges within a surface.
"""

from collections.abc import Hashable, Sequence

import moderngl
import numpy as np

from drone_engine.arrays import Floats
from drone_render.gl.device import Device
from drone_render.gl.variant import Variant

SKY_MARK, WATER_MARK = 0.0, 1.0
SOLID_MARKS = 254  # marks for solid surfaces; alpha has eight bits
STRIDE = 97  # coprime to SOLID_MARKS: consecutive surfaces get marks far apart


def marks(surfaces: Sequence[Hashable]) -> Floats:
    """Marks (n,) of n surfaces: equal surfaces have equal marks, different ones usually different marks."""
    number = {surface: i for i, surface in enumerate(dict.fromkeys(surfaces))}
    return np.array([(1 + number[surface] * STRIDE % SOLID_MARKS) / 255 for surface in surfaces])


class EdgePass:
    """Copies the finished picture with its edges smoothed."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._program = device.program(Variant("edges"))
        self._array = device.vertex_array(self._program)
        self._textures: dict[tuple[int, int], moderngl.Texture] = {}
        self._smooth: dict[tuple[int, int], moderngl.Framebuffer] = {}

    def target(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        """Creates the framebuffer to draw pictures of a size into."""
        target, self._textures[size] = self._device.textured_target(size)
        self._smooth[size] = self._device.target(size)
        return target

    def draw(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        """Smooths the picture that was drawn; returns the framebuffer with the result."""
        target = self._smooth[size]
        target.use()
        self._device.context.enable_only(moderngl.NOTHING)
        self._textures[size].use(0)
        self._array.render(vertices=3)
        return target
