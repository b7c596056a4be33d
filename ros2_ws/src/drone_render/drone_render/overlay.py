"""The debug view: lines over the picture, faint where something stands before them."""

import moderngl
import numpy as np

from drone_render.context import Device, write
from drone_render.lines import Lines
from drone_render.shaders import Variant
from drone_render.view import Array

WIDTH = 2  # pixels
HIDDEN = 0.25  # of a line's opacity that is left behind things


class LinePass:
    """Lines on the device. They are blended over the colours and leave the marks of edges alone."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._program = device.program(Variant.of("lines", WIDTH=WIDTH))
        self._buffer: moderngl.Buffer | None = None
        self._array: moderngl.VertexArray | None = None
        self._count = 0

    def show(self, lines: Lines) -> None:
        """Takes the lines to draw from now on."""
        rows = np.hstack([lines.ends.reshape(-1, 6), lines.colours]).astype(np.float32)
        self._count = len(rows)
        if self._buffer is None or self._buffer.size < rows.nbytes:
            # The old one is given back with the device: buffers only ever grow.
            self._buffer = self._device.buffer(np.zeros(max(2 * rows.nbytes, 4096), np.uint8))
            attributes = [(self._buffer, "3f 3f 4f/i", "start", "end", "colour")]
            self._array = self._device.instances(self._program, attributes)
        self._buffer.write(rows.tobytes())

    def draw(self, view_projection: Array, size: tuple[int, int], near: float) -> None:
        """Draws them: first what is hidden, then what is not."""
        if self._array is None or not self._count:
            return
        gl = self._device.context
        write(self._program, view_projection=view_projection.T, size=size, near=near)
        gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        # Marks of edges, in alpha, stay as they are.
        gl.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA, moderngl.ZERO, moderngl.ONE  # type: ignore[assignment]
        gl.fbo.depth_mask = False
        for test, share in ((">", HIDDEN), ("<=", 1.0)):
            gl.depth_func = test
            write(self._program, share=share)
            self._array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self._count)
        gl.depth_func = "<="
        gl.fbo.depth_mask = True
