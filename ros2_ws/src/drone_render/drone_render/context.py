"""Where OpenGL comes from: an off-screen context through EGL, and what is shared on its device."""

import ctypes
from collections.abc import Callable, Iterable
from pathlib import Path

import moderngl
import numpy as np
import numpy.typing as npt

from drone_render.geometry import PackedMap, pixels
from drone_render.shaders import Variant

HINT = "apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri"


class ContextError(RuntimeError):
    """There is no OpenGL to draw with; one line, with what to type."""


def create() -> moderngl.Context:
    """A context without a window. Raises ContextError."""
    try:
        return moderngl.create_context(require=430, standalone=True, backend="egl")  # type: ignore[arg-type]
    except Exception as error:  # glcontext and moderngl raise plain Exception
        reason = (str(error).splitlines() or ["no reason given"])[0]
        raise ContextError(f"no OpenGL through EGL ({reason}); type: sudo {HINT}") from None


def device_name(context: moderngl.Context) -> str:
    """What draws, as the driver calls itself: 'llvmpipe (LLVM 15.0.6, 256 bits)'."""
    return str(context.info["GL_RENDERER"])


def waiter() -> Callable[[], None]:
    """What waits until all is drawn, and lets other threads run meanwhile, which moderngl does not."""
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    egl.eglGetProcAddress.argtypes = [ctypes.c_char_p]
    return ctypes.CFUNCTYPE(None)(egl.eglGetProcAddress(b"glFinish"))


def packed(numbers: npt.ArrayLike) -> bytes:
    """Numbers as a uniform or a buffer takes them."""
    return np.asarray(numbers, dtype=np.float32).tobytes()


Attribute = tuple[moderngl.Buffer, str, str]
"""Numbers for each vertex or instance: where they are, their format, and what programs call them."""


class Device:
    """Programs, textures and buffers of a scene: each is made once and shared, `release` gives all back."""

    def __init__(self, context: moderngl.Context) -> None:
        self.context = context
        self.programs: dict[Variant, moderngl.Program] = {}
        self._textures: dict[Path, moderngl.Texture] = {}
        self._releases: list[Callable[[], object]] = []

    def program(self, variant: Variant) -> moderngl.Program:
        """The program of a variant. Raises ValueError where the driver has no room for it."""
        if variant not in self.programs:
            vertex, fragment = variant.sources()
            try:
                program = self.context.program(vertex_shader=vertex, fragment_shader=fragment)
            except moderngl.Error as error:
                raise ValueError(f"the driver refuses the program '{variant.name}': {_last_line(error)}") from None
            self._releases.append(program.release)
            self.programs[variant] = program
        return self.programs[variant]

    def texture(self, path: Path) -> moderngl.Texture:
        """An image file as a repeating texture with mip maps."""
        if path not in self._textures:
            self._textures[path] = self._mip_mapped(*pixels(path))
        return self._textures[path]

    def packed_texture(self, packed: PackedMap) -> moderngl.Texture:
        """Two maps in one, as a repeating texture with mip maps."""
        return self._mip_mapped(packed.size, packed.data)

    def _mip_mapped(self, size: tuple[int, int], data: bytes) -> moderngl.Texture:
        texture = self.context.texture(size, 4, data)
        texture.build_mipmaps()
        # Between texels, not between mip maps: half of the price on a software rasteriser, and hardly seen.
        texture.filter = moderngl.LINEAR_MIPMAP_NEAREST, moderngl.LINEAR
        self._releases.append(texture.release)
        return texture

    def plain_texture(self, size: tuple[int, int], values: npt.NDArray[np.uint8]) -> moderngl.Texture:
        """A texture of one number or colour a pixel, without repetition and mip maps; the bottom row comes first."""
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
        """What a program draws; attributes that it does not have are left out."""
        used = [attribute for attribute in attributes if program.get(attribute[2], None) is not None]
        array = self.context.vertex_array(program, used, index_buffer=index, index_element_size=4)
        self._releases.append(array.release)
        return array

    def instances(
        self, program: moderngl.Program, attributes: Iterable[tuple[moderngl.Buffer, str, str, str, str]]
    ) -> moderngl.VertexArray:
        """What a program draws once for each row of the buffers; attributes as moderngl has them."""
        array = self.context.vertex_array(program, list(attributes))
        self._releases.append(array.release)
        return array

    def target(self, size: tuple[int, int], components: int = 4, dtype: str = "f1") -> moderngl.Framebuffer:
        """Colour and depth of a picture."""
        colour, depth = self.context.renderbuffer(size, components, dtype=dtype), self.context.depth_renderbuffer(size)
        target = self.context.framebuffer([colour], depth)
        self._releases += [colour.release, depth.release, target.release]
        return target

    def textured_target(self, size: tuple[int, int]) -> tuple[moderngl.Framebuffer, moderngl.Texture]:
        """Colour and depth of a picture whose colours, with alpha, a program will read pixel by pixel."""
        texture, depth = self.context.texture(size, 4), self.context.depth_renderbuffer(size)
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
        target = self.context.framebuffer([texture], depth)
        self._releases += [texture.release, depth.release, target.release]
        return target, texture

    def begin(self, target: moderngl.Framebuffer, background: tuple[float, ...]) -> None:
        """Starts a picture of solid things in a target, all of it background."""
        self.context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self.context.front_face = "cw"  # the projection turns y over, and triangles with it
        self.context.depth_func = "<="  # the sky lies at the far end of it
        target.use()
        target.clear(*background)  # type: ignore[arg-type]

    def release(self) -> None:
        """Gives back everything, the youngest first."""
        self.context.detect_framebuffer(0).use()  # or the next target would be made beside one that is gone
        while self._releases:
            self._releases.pop()()
        self.programs.clear()
        self._textures.clear()


def _last_line(error: Exception) -> str:
    return next((line.strip() for line in reversed(str(error).splitlines()) if line.strip()), "no reason given")


def samplers(program: moderngl.Program, **units: int) -> None:
    """Tells the program, as far as it has such samplers, where its textures are."""
    for name, unit in units.items():
        if program.get(name, None) is not None:
            program[name] = unit


def setter(program: moderngl.Program, name: str) -> Callable[[bytes], object] | None:
    """What sets a uniform of the program, or a member of the facet that it is given; None if it has no such thing."""
    uniform = program.get(name, None) or program.get(f"given.{name}", None)
    return uniform.write if isinstance(uniform, moderngl.Uniform) else None


def write(program: moderngl.Program, **uniforms: npt.ArrayLike) -> None:
    """Sets the uniforms, numbers or packed already, that the program has. What a variant does not use is not in it."""
    for name, value in uniforms.items():
        if (put := setter(program, name)) is not None:
            put(value if isinstance(value, bytes) else packed(value))
