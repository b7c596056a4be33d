"""A render pass: the trail of an object, a ribbon that fades with age."""

import moderngl
import numpy as np
from pydantic import PositiveFloat

from drone_engine.scene.fields import Color, Name, Strict
from drone_render import Frame, PassContext, RenderPass

VERTEX = """#version 330 core
uniform mat4 view_projection;
in vec3 position;
in float age;  // from 0, now, to 1, the end of the trail
out float opacity;
void main() {
    opacity = 1.0 - age;
    gl_Position = view_projection * vec4(position, 1.0);
}"""
FRAGMENT = """#version 330 core
uniform vec3 color;
in float opacity;
out vec4 pixel;
void main() { pixel = vec4(color, opacity); }"""
MAX_POINTS = 4096


class Parameters(Strict):
    """In the scene file: `my_passes.trail: {object: drone, seconds: 5}`."""

    object: Name
    seconds: PositiveFloat = 3.0  # of simulated time until the trail has faded
    width: PositiveFloat = 0.1  # m
    color: Color = (1.0, 0.5, 0.1)


class Trail(RenderPass):
    """Remembers where the object was in each picture; the ribbon is as wide as it is high."""

    def __init__(self, parameters: Parameters, context: PassContext) -> None:
        if parameters.object not in context.scene.objects:
            raise ValueError(f"object: no object is called '{parameters.object}'")
        self._parameters, self._hierarchy = parameters, context.hierarchy
        self._points: list[tuple[float, np.ndarray]] = []  # time in s and position (3,), the oldest first
        self._program = context.device.compile("trail", VERTEX, FRAGMENT)
        self._program["color"] = parameters.color
        self._buffer = context.device.buffer(np.zeros((2 * MAX_POINTS, 4), np.float32))
        self._array = context.device.vertex_array(self._program, [(self._buffer, "3f 1f", "position", "age")])

    def draw_blended(self, frame: Frame) -> None:
        """Adds the object's position, and draws the ribbon as a strip of triangles."""
        position = self._hierarchy.matrix(frame.world, self._parameters.object)[:3, 3]
        if not self._points or frame.time > self._points[-1][0]:
            self._points.append((frame.time, position))
        oldest = frame.time - self._parameters.seconds
        self._points = [point for point in self._points if oldest <= point[0] <= frame.time][-MAX_POINTS:]
        age = np.array([(frame.time - time) / self._parameters.seconds for time, _ in self._points])
        places = np.array([place for _, place in self._points])
        half = np.array([0.0, 0.0, self._parameters.width / 2])
        rows = np.stack([np.column_stack([places - half, age]), np.column_stack([places + half, age])], axis=1)
        self._buffer.write(rows.astype(np.float32).tobytes())
        self._program["view_projection"].write(frame.view_projection.T.astype(np.float32).tobytes())
        self._array.render(moderngl.TRIANGLE_STRIP, vertices=2 * len(rows))


def build(parameters: Parameters, context: PassContext) -> Trail:
    """The pass that a scene names."""
    return Trail(parameters, context)
