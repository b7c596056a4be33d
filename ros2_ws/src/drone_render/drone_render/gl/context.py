"""Creates off-screen OpenGL contexts through EGL."""

import ctypes
from collections.abc import Callable

import moderngl

HINT = "apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri"
Context = moderngl.Context
Framebuffer = moderngl.Framebuffer


class ContextError(RuntimeError):
    """There is no OpenGL to draw with; one line that names the packages to install."""


def create() -> Context:
    """Creates a context without a window. Raises ContextError if there is no driver."""
    try:
        return moderngl.create_context(require=430, standalone=True, backend="egl")  # type: ignore[arg-type]
    except Exception as error:  # glcontext and moderngl raise plain Exception
        reason = (str(error).splitlines() or ["no reason given"])[0]
        raise ContextError(f"no OpenGL through EGL ({reason}); type: sudo {HINT}") from None


def device_name(context: Context) -> str:
    """The driver's name of the device, such as 'llvmpipe (LLVM 15.0.6, 256 bits)'."""
    return str(context.info["GL_RENDERER"])


def finisher() -> Callable[[], None]:
    """glFinish: waits until all is drawn. Other threads run meanwhile, which moderngl's own calls do not allow."""
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    egl.eglGetProcAddress.argtypes = [ctypes.c_char_p]
    return ctypes.CFUNCTYPE(None)(egl.eglGetProcAddress(b"glFinish"))
