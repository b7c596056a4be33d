"""A plain loop in bench.render: all triangles, trilinear textures, tangent frames and pow() in each pixel.

A first renderer in moderngl would look like this; its pictures are the full-detail reference for ours.
"""

from collections.abc import Callable

import moderngl
import numpy as np

from bench.render import scene as scenery
from bench.render.scene import Bytes
from drone_engine.arrays import Floats
from drone_render.gl import context
from drone_render.gl.uniforms import write

VERTEX = """#version 330
uniform mat4 clip; uniform mat4 model;
in vec3 p; in vec3 n; in vec2 t; in vec3 tangent;
out vec3 world; out vec3 normal; out vec3 tangent_w; out vec2 uv;
void main() {
    vec4 w = model * vec4(p, 1);
    world = w.xyz; normal = mat3(model) * n; tangent_w = mat3(model) * tangent; uv = t;
    gl_Position = clip * w;
}"""
FRAGMENT = """#version 330
uniform sampler2D colors; uniform sampler2D bumps;
uniform vec3 sun; uniform vec3 lamps[3]; uniform vec3 eye;
uniform float ambient; uniform vec2 shares; uniform float reach; uniform float specular; uniform float shininess;
in vec3 world; in vec3 normal; in vec3 tangent_w; in vec2 uv;
out vec3 pixel;
void main() {
    vec3 n = normalize(normal);
    vec3 t = normalize(tangent_w - n * dot(n, tangent_w));
    vec3 bump = texture(bumps, uv).xyz * 2 - 1;
    n = normalize(mat3(t, cross(n, t), n) * bump);
    vec3 v = normalize(eye - world);
    float diffuse = ambient * (0.75 + 0.25 * n.z) + shares.x * max(dot(n, sun), 0);
    float gloss = shares.x * pow(max(dot(n, normalize(v + sun)), 0), shininess);
    for (int i = 0; i < 3; ++i) {
        vec3 to_lamp = lamps[i] - world;
        float share = shares.y / (1 + dot(to_lamp, to_lamp) / (reach * reach));
        vec3 l = normalize(to_lamp);
        diffuse += share * max(dot(n, l), 0);
        gloss += share * pow(max(dot(n, normalize(v + l)), 0), shininess);
    }
    pixel = texture(colors, uv).rgb * diffuse + specular * gloss;
}"""


class Drawer:
    """Forty-one draw calls, the hill first."""

    about = "per pixel, 4 lights, normal maps, every triangle"

    def __init__(self) -> None:
        self._context = context.create()
        self._program = self._context.program(VERTEX, FRAGMENT)
        for name, value in {
            "sun": tuple(scenery.SUN), "lamps": scenery.LAMPS, "ambient": scenery.AMBIENT, "bumps": 1,
            "shares": (scenery.SUN_SHARE, scenery.LAMP_SHARE), "reach": scenery.REACH,
            "specular": scenery.SPECULAR, "shininess": scenery.SHININESS,
        }.items():
            self._program[name] = value
        hill, ball = scenery.hill(), scenery.ball()
        self._items = [(self._upload(hill, np.tile([1.0, 0, 0], (len(hill.vertices), 1))), self._maps(None), np.eye(4))]
        tangents = np.column_stack([-ball.vertices[:, 1], ball.vertices[:, 0], np.zeros(len(ball.vertices))])
        tangents[np.abs(tangents).sum(axis=1) < 1e-9] = (0, 1, 0)
        array = self._upload(ball, tangents)
        for k, (position, scale) in enumerate(scenery.balls()):
            model = np.diag([scale, scale, scale, 1.0])
            model[:3, 3] = position
            self._items.append((array, self._maps(k), model))

    def _upload(self, mesh: scenery.Mesh, tangent: Floats) -> moderngl.VertexArray:
        columns = np.hstack([mesh.vertices, mesh.normals, mesh.uv, tangent]).astype("f4")
        buffer, index = self._context.buffer(columns.tobytes()), self._context.buffer(mesh.faces.astype("i4").tobytes())
        return self._context.vertex_array(self._program, [(buffer, "3f 3f 2f 3f", "p", "n", "t", "tangent")], index)

    def _maps(self, number: int | None) -> list[moderngl.Texture]:
        textures = []
        for image in (scenery.colors(number), scenery.bumps(number)):
            texture = self._context.texture(image.shape[1::-1], 3, np.ascontiguousarray(image[::-1]).tobytes())
            texture.build_mipmaps()
            texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
            textures.append(texture)
        return textures

    def size(self, width: int, height: int) -> Callable[[float], Bytes]:
        """Prepares for pictures of this size; returns the function that draws picture k, (height, width, 3)."""
        gl, program = self._context, self._program
        target = gl.framebuffer([gl.renderbuffer((width, height), 4)], gl.depth_renderbuffer((width, height)))
        focal = 1 / np.tan(np.radians(scenery.HEIGHT_OF_VIEW) / 2)
        near, far = scenery.NEAR, scenery.FAR
        projection = np.array([[focal * height / width, 0, 0, 0], [0, focal, 0, 0],
                               [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)], [0, 0, -1, 0]])
        rows = np.empty((height, width, 3), np.uint8)

        def frame(number: float) -> Bytes:
            target.use()
            gl.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
            target.clear(*scenery.BACKGROUND)
            write(program, clip=(projection @ np.linalg.inv(scenery.camera(number))).T, eye=scenery.eye(number))
            for array, maps, model in self._items:
                write(program, model=model.T)
                for unit, texture in enumerate(maps):
                    texture.use(unit)
                array.render()
            target.read_into(rows, components=3, alignment=1)
            return rows[::-1]

        return frame
