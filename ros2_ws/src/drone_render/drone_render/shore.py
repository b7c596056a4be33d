"""How deep the water is, surveyed once from above, so that it is clear and foams where land is near."""

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
import numpy.typing as npt

from drone_engine.geometry.mesh import Model
from drone_render.context import Device, write
from drone_render.shaders import Variant
from drone_render.view import Array

SIDE = 512  # pixels of the survey
NO_LAND = -1000.0  # m
CLEAR = 1.0  # m of water that take 1 - 1/e of the light
DIM = 0.2  # the share of it that is left where the ground is not seen any more


@dataclass(frozen=True)
class Shore:
    """A square of the world, its middle and half its side in m, and how clear the water is in it, 0 to 1."""

    square: tuple[float, float, float]
    texture: moderngl.Texture


def survey(device: Device, land: Sequence[tuple[Model, Array]], level: float) -> Shore | None:
    """Looks at models, each at its matrix (4, 4), from above; level: of the water, m. None without any land."""
    if not land:
        return None
    centres = np.array([matrix[:2, 3] for _, matrix in land])
    reach = np.array([[np.abs([model.low, model.high]).max()] for model, _ in land])
    low, high = (centres - reach).min(axis=0), (centres + reach).max(axis=0)
    middle, half = (low + high) / 2, float((high - low).max()) / 2
    square = float(middle[0]), float(middle[1]), half
    heights = _heights(device, land, square, level)
    clear = np.exp(-np.maximum(level - heights, 0.0) / CLEAR)
    clear = np.maximum(clear - DIM, 0.0) / (1 - DIM)
    clear[[0, -1]] = clear[:, [0, -1]] = 0.0  # what is beyond repeats the edge
    texture = device.plain_texture((SIDE, SIDE), np.round(255 * clear).astype(np.uint8))
    return Shore(square, texture)


def _heights(
    device: Device, land: Sequence[tuple[Model, Array]], square: tuple[float, float, float], level: float
) -> npt.NDArray[np.float32]:  # fmt: skip
    """The highest land, (SIDE, SIDE) in m, at every pixel of the square, within 1000 m of the water's level."""
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
