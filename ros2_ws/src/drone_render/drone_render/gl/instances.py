"""Instanced drawing: objects of one shape in one draw call, with a matrix and a mark per instance."""

from typing import NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from drone_engine.arrays import Floats
from drone_render.gl.device import Attribute, Device


class Batch(NamedTuple):
    """One draw call: so many indices from `first` on, for `instances` rows of the buffers from `first_instance` on."""

    first: int
    indices: int
    first_instance: int
    instances: int


class Instances:
    """Buffers with a row per instance of a picture: `model`, a matrix, and `mark`, a number."""

    def __init__(self, device: Device) -> None:
        self._models, self._marks, self._commands = (device.buffer(np.zeros(16, np.float32)) for _ in range(3))
        self.attributes: list[Attribute] = [(self._models, "16f/i", "model"), (self._marks, "1f/i", "mark")]

    def fill(self, models: Floats, marks: npt.NDArray[np.floating], batches: list[Batch]) -> None:
        """Writes matrices (n, 4, 4) and marks (n,) of n instances, and the draw calls."""
        commands = np.zeros((len(batches), 5), np.uint32)  # OpenGL's DrawElementsIndirectCommand
        commands[:, [2, 0, 4, 1]] = np.array(batches, np.uint32).reshape(-1, 4)
        _refill(self._models, models.transpose(0, 2, 1).astype(np.float32))
        _refill(self._marks, marks.astype(np.float32))
        _refill(self._commands, commands)

    def draw(self, array: moderngl.VertexArray, batch: int) -> None:
        """Draws one of the batches with a vertex array that has `attributes`."""
        array.render_indirect(self._commands, count=1, first=batch)


def _refill(buffer: moderngl.Buffer, rows: npt.NDArray[np.generic]) -> None:
    if rows.size:
        buffer.orphan(rows.nbytes)  # draw calls still in progress keep the old contents
        buffer.write(rows.tobytes())
