"""Many things of one shape, drawn at once: where each is, and its mark, come from buffers with a row for each."""

from typing import NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from drone_render.context import Attribute, Device
from drone_render.view import Array


class Batch(NamedTuple):
    """What is drawn at once: corners of an index from `first` on, for `rows` of the buffers from `start` on."""

    first: int
    corners: int
    start: int
    rows: int


class Instances:
    """The rows of one picture: programs take them as `model`, a matrix, and `mark`, a number."""

    def __init__(self, device: Device) -> None:
        self._models, self._marks, self._commands = (device.buffer(np.zeros(16, np.float32)) for _ in range(3))
        self.attributes: list[Attribute] = [(self._models, "16f/i", "model"), (self._marks, "1f/i", "mark")]

    def fill(self, models: Array, marks: npt.NDArray[np.floating], batches: list[Batch]) -> None:
        """Takes matrices (n, 4, 4) and marks (n,) of all that is drawn, and what is drawn by which of them."""
        commands = np.zeros((len(batches), 5), np.uint32)  # OpenGL's DrawElementsIndirectCommand
        commands[:, [2, 0, 4, 1]] = np.array(batches, np.uint32).reshape(-1, 4)
        _refill(self._models, models.transpose(0, 2, 1).astype(np.float32))
        _refill(self._marks, marks.astype(np.float32))
        _refill(self._commands, commands)

    def draw(self, array: moderngl.VertexArray, batch: int) -> None:
        """Draws one of the batches; the array has the attributes."""
        array.render_indirect(self._commands, count=1, first=batch)


def _refill(buffer: moderngl.Buffer, rows: npt.NDArray[np.generic]) -> None:
    if rows.size:
        buffer.orphan(rows.nbytes)  # what is still being drawn from it stays as it is
        buffer.write(rows.tobytes())
