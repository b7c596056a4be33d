"""The debug view: lines over the picture, faint where something stands before them."""

import moderngl
import numpy as np
import numpy.typing as npt

from drone_render.context import Device, write
from drone_render.lines import Floats, Lines
from drone_render.shaders import Variant
from drone_render.view import Array

HIDDEN = 0.25  # of a line's opacity that is left behind things
BOLD = 4  # pixels from which on a line has a dark rim, and is seen through things
RIM, DARK = 3, 0.7  # pixels that a rim is wider by, and its opacity
SEEN = 0.6  # of a bold line's opacity that is left behind things
BEFORE = 0.004  # of a line's distance that it is before what it lies on: the same pixels, but no flicker
OUTLINE = 2  # pixels, the width of a ball's outline
FIRMER = 1 / 3  # power of a ball's opacity that its outline has: of a veil that one sees through, it is a thin line
_ANGLE = 2 * np.pi * (np.arange(48)[:, None] + [0, 1]) / 48
CIRCLE = np.stack([np.cos(_ANGLE), np.sin(_ANGLE)], axis=-1)  # (lines, ends, 2)


class LinePass:
    """Lines on the device. They are blended over the colours and leave the marks of edges alone."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._strokes: dict[tuple[int, bool], _Stroke] = {}  # by width, and whether they are rims
        self._program = device.program(Variant("lines"))
        self._outlines = _Stroke(device, self._program, OUTLINE)
        self._balls: tuple[Floats, Floats, Floats] | None = None

    def show(self, lines: Lines) -> None:
        """Takes what to draw from now on."""
        self._balls = lines.centres, lines.radii, lines.ball_colours
        for stroke in self._strokes.values():
            stroke.count = 0
        for width in np.unique(lines.widths).tolist():
            chosen = lines.widths == width
            ends, colours = lines.ends[chosen], lines.colours[chosen]
            self._stroke(width, False).fill(ends, colours)
            if width >= BOLD:
                self._stroke(width, True).fill(ends, colours * np.array((0.0, 0.0, 0.0, DARK), np.float32))

    def _stroke(self, width: int, rim: bool) -> "_Stroke":
        if (width, rim) not in self._strokes:
            self._strokes[width, rim] = _Stroke(self._device, self._program, width + RIM if rim else width)
        return self._strokes[width, rim]

    def draw(self, view_projection: Array, size: tuple[int, int], near: float) -> None:
        """Draws them, the bold ones last; of what is not bold first all that is hidden."""
        if self._balls is None:
            return
        eye = np.linalg.inv(view_projection)[:, 2]  # the only point that is projected to no place at all
        centres, radii, colours = self._balls
        eye = eye[:3] / eye[3]
        seen, ends = outlines(centres, radii, eye)
        self._outlines.fill(ends, np.repeat(colours[seen] ** (1.0, 1.0, 1.0, FIRMER), len(CIRCLE), axis=0))
        gl = self._device.context
        gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        # Marks of edges, in alpha, stay as they are.
        gl.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA, moderngl.ZERO, moderngl.ONE  # type: ignore[assignment]
        gl.fbo.depth_mask = False
        nearer = (1 - BEFORE) * np.eye(4)
        nearer[:3, 3], nearer[3, 3] = BEFORE * eye, 1.0
        matrix = (view_projection @ nearer).T.astype(np.float32)
        bold = [stroke for (width, _), stroke in sorted(self._strokes.items(), key=_order) if width >= BOLD]
        plain = [self._outlines, *(stroke for (width, _), stroke in sorted(self._strokes.items()) if width < BOLD)]
        for strokes, hidden in ((plain, HIDDEN), (bold, SEEN)):
            for test, share in ((">", hidden), ("<=", 1.0)):
                gl.depth_func = test
                for stroke in strokes:
                    stroke.draw(matrix, size, near, share)
        gl.depth_func = "<="
        gl.fbo.depth_mask = True


def _order(item: tuple[tuple[int, bool], "_Stroke"]) -> tuple[int, bool]:
    """Thin ones first, and rims before what they are of."""
    (width, rim), _ = item
    return width, not rim


class _Stroke:
    """Lines of one width in pixels."""

    def __init__(self, device: Device, program: moderngl.Program, width: int) -> None:
        self._device, self._program, self._width = device, program, width
        self._buffer: moderngl.Buffer | None = None
        self._array: moderngl.VertexArray | None = None
        self.count = 0

    def fill(self, ends: Floats | Array, colours: Floats) -> None:
        """Takes the lines: ends (n, 2, 3), colours (n, 4)."""
        rows = np.hstack([ends.reshape(-1, 6), colours]).astype(np.float32)
        self.count = len(rows)
        if not self.count:
            return
        if self._buffer is None or self._buffer.size < rows.nbytes:
            # The old one is given back with the device: buffers only ever grow.
            self._buffer = self._device.buffer(np.zeros(max(2 * rows.nbytes, 4096), np.uint8))
            attributes = [(self._buffer, "3f 3f 4f/i", "start", "end", "colour")]
            self._array = self._device.instances(self._program, attributes)
        self._buffer.write(rows.tobytes())

    def draw(self, matrix: Floats, size: tuple[int, int], near: float, share: float) -> None:
        """Draws them with a share of their opacity; matrix: to the picture, its columns one after the other."""
        if self._array is None or not self.count:
            return
        write(self._program, view_projection=matrix, size=size, near=near, share=share, width=self._width)
        self._array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self.count)


def outlines(centres: Floats, radii: Floats, eye: Array) -> tuple[npt.NDArray[np.intp], Array]:
    """Which balls (k,) have an outline, the eye not being within; and the ends (n, 2, 3) of the circles at which the
    rays from the eye touch them."""
    way = eye - centres.astype(np.float64)
    square = np.einsum("ki,ki->k", way, way)
    seen = np.flatnonzero(square > np.square(radii))
    way, square, radius = way[seen], square[seen], radii[seen].astype(np.float64)
    share = np.square(radius) / square
    middle = centres[seen] + share[:, None] * way
    other = np.where(np.abs(way[:, 2:]) < 0.9 * np.sqrt(square)[:, None], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    first = np.cross(way, other)
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(way, first) / np.sqrt(square)[:, None]
    across = np.stack([first, second], axis=1) * (radius * np.sqrt(1 - share))[:, None, None]
    ends = middle[:, None, None] + np.einsum("lec,kci->klei", CIRCLE, across)
    return seen, ends.reshape(-1, 2, 3)
