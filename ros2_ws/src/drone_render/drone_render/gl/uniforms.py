"""Sets the uniforms of programs. Uniforms that a variant of a program does not have are skipped."""

from collections.abc import Callable

import moderngl
import numpy as np
import numpy.typing as npt


def packed(numbers: npt.ArrayLike) -> bytes:
    """Numbers as the float32 bytes that uniforms and buffers take."""
    return np.asarray(numbers, dtype=np.float32).tobytes()


def set_samplers(program: moderngl.Program, **units: int) -> None:
    """Assigns texture units to the program's samplers, by name."""
    for name, unit in units.items():
        if program.get(name, None) is not None:
            program[name] = unit


def setter(program: moderngl.Program, name: str) -> Callable[[bytes], object] | None:
    """The function that sets a uniform, or a member of the uniform struct `given`, to packed numbers; None if the
    program has neither."""
    uniform = program.get(name, None) or program.get(f"given.{name}", None)
    return uniform.write if isinstance(uniform, moderngl.Uniform) else None


def write(program: moderngl.Program, **uniforms: npt.ArrayLike) -> None:
    """Sets uniforms by name, to numbers or packed numbers. Matrices are taken column by column: pass the transpose."""
    for name, value in uniforms.items():
        if (put := setter(program, name)) is not None:
            put(value if isinstance(value, bytes) else packed(value))
