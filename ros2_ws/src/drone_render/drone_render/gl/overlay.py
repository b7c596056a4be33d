"""Lines and spheres over the picture, faint where surfaces hide them: the debug view."""

import moderngl
import numpy as np

from drone_engine.arrays import Floats
from drone_render.arrays import Float32s, Indices
from drone_render.frame.frame import Frame
from drone_render.frame.lines import Lines
from drone_render.gl.device import Device
from drone_render.gl.uniforms import write
from drone_render.gl.variant import Variant

HIDDEN = 0.25  # factor of a line's opacity where a surface hides it
BOLD = 4  # pixels; lines of at least this width have a dark rim and stay visible behind surfaces
RIM_WIDTH, RIM_OPACITY = 3, 0.7  # extra width of a rim in pixels, and factor of the line's opacity
BOLD_HIDDEN = 0.6  # factor of a bold line's opacity where a surface hides it
DEPTH_BIAS = 0.004  # of the distance, by which lines are moved towards the eye to avoid z-fighting
OUTLINE_WIDTH = 2  # pixels, of a sphere's outline
OUTLINE_EXPONENT = 1 / 3  # of a sphere's opacity: a translucent sphere has a more opaque outline
_ANGLE = 2 * np.pi * (np.arange(48)[:, None] + [0, 1]) / 48
CIRCLE = np.stack([np.cos(_ANGLE), np.sin(_ANGLE)], axis=-1)  # (lines, ends, 2)


class LinePass:
    """Lines on the device. They are blended over the colors, and leave the marks of antialiasing as they are."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._strokes: dict[tuple[int, bool], _Stroke] = {}  # by width, and whether they are rims
        self._program = device.program(Variant("lines"))
        self._outlines = _Stroke(device, self._program, OUTLINE_WIDTH)
        self._spheres: tuple[Float32s, Float32s, Float32s] | None = None

    def show(self, lines: Lines) -> None:
        """Replaces the lines and spheres to draw."""
        self._spheres = lines.centers, lines.radii, lines.sphere_colors
        for stroke in self._strokes.values():
            stroke.count = 0
        for width in np.unique(lines.widths).tolist():
            chosen = lines.widths == width
            ends, colors = lines.ends[chosen], lines.colors[chosen]
            self._stroke(width, False).fill(ends, colors)
            if width >= BOLD:
                self._stroke(width, True).fill(ends, colors * np.array((0.0, 0.0, 0.0, RIM_OPACITY), np.float32))

    def _stroke(self, width: int, rim: bool) -> "_Stroke":
        if (width, rim) not in self._strokes:
            self._strokes[width, rim] = _Stroke(self._device, self._program, width + RIM_WIDTH if rim else width)
        return self._strokes[width, rim]

    def draw(self, frame: Frame) -> None:
        """Draws the lines, bold ones last; of each kind, first the parts that surfaces hide."""
        if self._spheres is None:
            return
        view_projection = frame.view_projection
        eye = np.linalg.inv(view_projection)[:, 2]  # the eye is the one point that has no projection
        centers, radii, colors = self._spheres
        eye = eye[:3] / eye[3]
        visible, ends = outlines(centers, radii, eye)
        outline_colors = colors[visible] ** (1.0, 1.0, 1.0, OUTLINE_EXPONENT)
        self._outlines.fill(ends, np.repeat(outline_colors, len(CIRCLE), axis=0))
        gl = self._device.context
        self._device.set_blended_state()
        gl.fbo.depth_mask = False
        nearer = (1 - DEPTH_BIAS) * np.eye(4)
        nearer[:3, 3], nearer[3, 3] = DEPTH_BIAS * eye, 1.0
        matrix = (view_projection @ nearer).T.astype(np.float32)
        bold = [stroke for (width, _), stroke in sorted(self._strokes.items(), key=_order) if width >= BOLD]
        plain = [self._outlines, *(stroke for (width, _), stroke in sorted(self._strokes.items()) if width < BOLD)]
        for strokes, hidden in ((plain, HIDDEN), (bold, BOLD_HIDDEN)):
            for test, opacity in ((">", hidden), ("<=", 1.0)):
                gl.depth_func = test
                for stroke in strokes:
                    stroke.draw(matrix, frame.size, frame.near, opacity)
        gl.depth_func = "<="
        gl.fbo.depth_mask = True


def _order(item: tuple[tuple[int, bool], "_Stroke"]) -> tuple[int, bool]:
    """Sort key: thin lines first, and rims before their lines."""
    (width, rim), _ = item
    return width, not rim


class _Stroke:
    """Lines of one width in pixels."""

    def __init__(self, device: Device, program: moderngl.Program, width: int) -> None:
        self._device, self._program, self._width = device, program, width
        self._buffer: moderngl.Buffer | None = None
        self._array: moderngl.VertexArray | None = None
        self.count = 0

    def fill(self, ends: Float32s | Floats, colors: Float32s) -> None:
        """Replaces the lines: ends (n, 2, 3) in m, colors (n, 4)."""
        rows = np.hstack([ends.reshape(-1, 6), colors]).astype(np.float32)
        self.count = len(rows)
        if not self.count:
            return
        if self._buffer is None or self._buffer.size < rows.nbytes:
            # Buffers only grow; the old one is freed with the device.
            self._buffer = self._device.buffer(np.zeros(max(2 * rows.nbytes, 4096), np.uint8))
            attributes = [(self._buffer, "3f 3f 4f/i", "start", "end", "color")]
            self._array = self._device.instances(self._program, attributes)
        self._buffer.write(rows.tobytes())

    def draw(self, matrix: Float32s, size: tuple[int, int], near: float, opacity: float) -> None:
        """Draws the lines with a factor of their opacity; matrix: from the world to clip space, column by column."""
        if self._array is None or not self.count:
            return
        write(self._program, view_projection=matrix, size=size, near=near, opacity=opacity, width=self._width)
        self._array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=self.count)


def outlines(centers: Float32s, radii: Float32s, eye: Floats) -> tuple[Indices, Floats]:
    """Outlines of spheres, centers (k, 3) and radii (k,), seen from the eye (3,).

    Returns the indices of the spheres that do not contain the eye, and for each the lines, (n, 2, 3) in all, of the
    circle where rays from the eye touch the sphere.
    """
    to_eye = eye - centers.astype(np.float64)
    square = np.einsum("ki,ki->k", to_eye, to_eye)
    visible = np.flatnonzero(square > np.square(radii))
    to_eye, square, radius = to_eye[visible], square[visible], radii[visible].astype(np.float64)
    fraction = np.square(radius) / square
    middle = centers[visible] + fraction[:, None] * to_eye
    other = np.where(np.abs(to_eye[:, 2:]) < 0.9 * np.sqrt(square)[:, None], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    first = np.cross(to_eye, other)
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(to_eye, first) / np.sqrt(square)[:, None]
    axes = np.stack([first, second], axis=1) * (radius * np.sqrt(1 - fraction))[:, None, None]
    ends = middle[:, None, None] + np.einsum("lec,kci->klei", CIRCLE, axes)
    return visible, ends.reshape(-1, 2, 3)
