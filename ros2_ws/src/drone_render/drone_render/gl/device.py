"""Programs, textures, buffers and framebuffers of one scene on the graphics device."""

from collections.abc import Callable, Iterable
from pathlib import Path

import moderngl
import numpy as np
import numpy.typing as npt

from drone_render.arrays import Bytes
from drone_render.gl.variant import Variant
from drone_render.models.textures import PackedMap, pixels

Attribute = tuple[moderngl.Buffer, str, str]
"""A vertex or instance attribute: buffer, format, and its name in the shaders."""


class Device:
    """Creates graphics resources, each once, shared by all users; `release` frees them all."""

    def __init__(self, context: moderngl.Context) -> None:
        self.context = context
        self.programs: dict[Variant, moderngl.Program] = {}
        self._textures: dict[Path, moderngl.Texture] = {}
        self._releases: list[Callable[[], object]] = []

    def program(self, variant: Variant) -> moderngl.Program:
        """The program of a variant. Raises ValueError if the driver refuses it."""
        if variant not in self.programs:
            vertex, fragment = variant.sources()
            self.programs[variant] = self.compile(variant.name, vertex, fragment)
        return self.programs[variant]

    def compile(self, name: str, vertex: str, fragment: str) -> moderngl.Program:
        """Compiles a program from GLSL text; `name` is for the error. Raises ValueError if the driver refuses it."""
        try:
            program = self.context.program(vertex_shader=vertex, fragment_shader=fragment)
        except moderngl.Error as error:
            raise ValueError(f"the driver refuses the program '{name}': {_last_line(error)}") from None
        self._releases.append(program.release)
        return program

    def texture(self, path: Path) -> moderngl.Texture:
        """An image file as a repeating texture with mip maps."""
        if path not in self._textures:
            self._textures[path] = self._mip_mapped(*pixels(path))
        return self._textures[path]

    def packed_texture(self, packed: PackedMap) -> moderngl.Texture:
        """A packed color and normal map as a repeating texture with mip maps."""
        return self._mip_mapped(packed.size, packed.data)

    def _mip_mapped(self, size: tuple[int, int], data: bytes) -> moderngl.Texture:
        texture = self.context.texture(size, 4, data)
        texture.build_mipmaps()
        # Not between mip maps: that would double the cost on a software rasterizer, and is barely visible.
        texture.filter = moderngl.LINEAR_MIPMAP_NEAREST, moderngl.LINEAR
        self._releases.append(texture.release)
        return texture

    def plain_texture(self, size: tuple[int, int], values: Bytes) -> moderngl.Texture:
        """A texture without repetition or mip maps; values: one number or color per pixel, the bottom row first."""
        texture = self.context.texture(size, values.size // (size[0] * size[1]), values.tobytes(), alignment=1)
        texture.filter = moderngl.LINEAR, moderngl.LINEAR
        texture.repeat_x = texture.repeat_y = False
        self._releases.append(texture.release)
        return texture

    def buffer(self, array: npt.NDArray[np.generic]) -> moderngl.Buffer:
        """A vertex or index buffer with the array's bytes."""
        buffer = self.context.buffer(array.tobytes())
        self._releases.append(buffer.release)
        return buffer

    def vertex_array(
        self, program: moderngl.Program, attributes: Iterable[Attribute] = (),
        index: moderngl.Buffer | None = None,
    ) -> moderngl.VertexArray:  # fmt: skip
        """A vertex array for a program; attributes that the program does not use are left out."""
        used = [attribute for attribute in attributes if program.get(attribute[2], None) is not None]
        array = self.context.vertex_array(program, used, index_buffer=index, index_element_size=4)
        self._releases.append(array.release)
        return array

    def instances(
        self, program: moderngl.Program, attributes: Iterable[tuple[moderngl.Buffer, str, str, str, str]]
    ) -> moderngl.VertexArray:
        """A vertex array that is drawn once for each row of the buffers; attributes in moderngl's format."""
        array = self.context.vertex_array(program, list(attributes))
        self._releases.append(array.release)
        return array

    def target(self, size: tuple[int, int], components: int = 4, dtype: str = "f1") -> moderngl.Framebuffer:
        """A framebuffer with color and depth."""
        color, depth = self.context.renderbuffer(size, components, dtype=dtype), self.context.depth_renderbuffer(size)
        target = self.context.framebuffer([color], depth)
        self._releases += [color.release, depth.release, target.release]
        return target

    def textured_target(self, size: tuple[int, int]) -> tuple[moderngl.Framebuffer, moderngl.Texture]:
        """A framebuffer with depth, and the RGBA texture that holds its color, for programs to read pixel by pixel."""
        texture, depth = self.context.texture(size, 4), self.context.depth_renderbuffer(size)
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
        target = self.context.framebuffer([texture], depth)
        self._releases += [texture.release, depth.release, target.release]
        return target, texture

    def begin(self, target: moderngl.Framebuffer, background: tuple[float, ...]) -> None:
        """Selects a target, clears it to the background, and sets the state for opaque surfaces."""
        self.set_opaque_state()
        target.use()
        target.clear(*background)  # type: ignore[arg-type]

    def set_opaque_state(self) -> None:
        """Depth test and back-face culling, no blending."""
        self.context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self.context.front_face = "cw"  # the projection negates y, which reverses the winding of triangles
        self.context.depth_func = "<="  # the sky is drawn at the far plane

    def set_blended_state(self) -> None:
        """Depth test, and blending by alpha that leaves alpha, which holds the marks of antialiasing, as it is."""
        self.context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self.context.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA, moderngl.ZERO, moderngl.ONE  # type: ignore[assignment]
        self.context.depth_func = "<="

    def release(self) -> None:
        """Frees all resources, the newest first."""
        self.context.detect_framebuffer(0).use()  # so that no deleted framebuffer stays bound
        while self._releases:
            self._releases.pop()()
        self.programs.clear()
        self._textures.clear()


def _last_line(error: Exception) -> str:
    return next((line.strip() for line in reversed(str(error).splitlines()) if line.strip()), "no reason given")
