"""A map of the water's depth, drawn once from above: shallow water is clear, and foams at the shore."""

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from drone_engine.arrays import Floats
from drone_engine.geometry.mesh import Model
from drone_render.arrays import Float32s
from drone_render.gl.device import Device
from drone_render.gl.uniforms import write
from drone_render.gl.variant import Variant

SIDE = 512  # pixels of the map
NO_LAND = -1000.0  # m
CLEAR_DEPTH = 1.0  # m of water that absorb 1 - 1/e of the light
OPAQUE_BELOW = 0.2  # transmitted share of the light at which the ground becomes invisible


@dataclass(frozen=True)
class Shore:
    """Clearness of the water, 0 to 1, in a square of the world."""

    square: tuple[float, float, float]  # x and y of the center, and half the side, m
    texture: moderngl.Texture


def survey(device: Device, land: Sequence[tuple[Model, Floats]], level: float) -> Shore | None:
    """The map around models, each at its matrix (4, 4) in the world; None without any.

    level: height of the water's surface, m.
    """
    if not land:
        return None
    centers = np.array([matrix[:2, 3] for _, matrix in land])
    reach = np.array([[np.abs([model.low, model.high]).max()] for model, _ in land])
    low, high = (centers - reach).min(axis=0), (centers + reach).max(axis=0)
    middle, half = (low + high) / 2, float((high - low).max()) / 2
    square = float(middle[0]), float(middle[1]), half
    heights = _heights(device, land, square, level)
    clear = np.exp(-np.maximum(level - heights, 0.0) / CLEAR_DEPTH)
    clear = np.maximum(clear - OPAQUE_BELOW, 0.0) / (1 - OPAQUE_BELOW)
    clear[[0, -1]] = clear[:, [0, -1]] = 0.0  # outside the square the texture repeats its edge
    texture = device.plain_texture((SIDE, SIDE), np.round(255 * clear).astype(np.uint8))
    return Shore(square, texture)


def _heights(
    device: Device, land: Sequence[tuple[Model, Floats]], square: tuple[float, float, float], level: float
) -> Float32s:  # fmt: skip
    """Height of the highest land, (SIDE, SIDE) in m, at every pixel; land within 1000 m of the water's level counts."""
    context, scratch = device.context, Device(device.context)
    try:
        target = scratch.target((SIDE, SIDE), components=1, dtype="f4")
        program = scratch.program(Variant("height"))
        write(program, square=square, level=level)
        context.enable_only(moderngl.DEPTH_TEST)
        context.depth_func = "<"
        target.use()
        target.clear(NO_LAND)
        for model, matrix in land:
            write(program, model=matrix.T)
            for part in model.parts:
                attributes = [(scratch.buffer(part.vertices), "3f", "position")]
                scratch.vertex_array(program, attributes, scratch.buffer(part.faces)).render()
        return np.frombuffer(target.read(components=1, dtype="f4"), np.float32).reshape(SIDE, SIDE)
    finally:
        scratch.release()
