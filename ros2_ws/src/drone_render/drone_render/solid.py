"""Solid things: which of them are seen, by which lights, how finely, and in which order they are drawn."""

from collections.abc import Mapping
from typing import NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from drone_render import view
from drone_render.context import Device, packed, write
from drone_render.edges import marks
from drone_render.frame import Frame
from drone_render.hierarchy import LIGHTS, Lighting
from drone_render.ranges import RangePass
from drone_render.shaders import Variant
from drone_render.surface import Level, Maps, Surfaces
from drone_render.view import Array
from drone_sim.look import Render
from drone_sim.mesh import Model

TOLERANCE = 1.25  # pixels that a level of detail may be off by


class Seen(NamedTuple):
    """Pieces in the order in which they are drawn: their numbers, centres (m, 3) in the world, transposed matrices
    (m, 4, 4), levels of detail."""

    pieces: npt.NDArray[np.intp]
    centres: Array
    matrices: npt.NDArray[np.float32]
    levels: list[Level]


class SolidPass:
    """All that is neither water nor sky; models by their object's row in the scene. Equal models are there once.

    tolerance: pixels that levels of detail may be off by; 0 draws every triangle.
    """

    def __init__(
        self, device: Device, render: Render, models: Mapping[int, Model], lighting: Lighting,
        tolerance: float = TOLERANCE,
    ) -> None:  # fmt: skip
        self._ambient = render.ambient
        self._lighting = lighting
        self._tolerance = tolerance
        surfaces = Surfaces(device, render, lighting)
        pairs = [(row, piece) for row, model in models.items() for piece in surfaces.pieces(model)]
        self._pieces = [piece for _, piece in pairs]
        self._rows = np.array([row for row, _ in pairs], dtype=np.intp)
        smooth = render.antialiasing is not None
        self._marks = marks([(row, id(piece.surface)) for row, piece in pairs]) if smooth else []
        self._centres = np.array([piece.centre for piece in self._pieces]).reshape(-1, 3)
        self._radii = np.array([piece.radius for piece in self._pieces])

    def warm_up(self) -> None:
        """Draws with every program that can occur: the driver compiles each at its first use, which takes a while."""
        parallel = self._lighting.parallel is not None
        seen: set[Variant] = set()
        for piece, row in zip(self._pieces, self._rows, strict=True):
            for count in range(min(int(self._lighting.lit[row].sum()) - parallel, LIGHTS) + 1):
                variant = piece.surface.variant(count)
                if variant not in seen:
                    seen.add(variant)
                    array = piece.surface.array(count)
                    write(array.program, view_projection=np.eye(4), model=np.eye(4))
                    piece.surface.maps.use(array.program)
                    array.render()

    def _seen(self, frame: Frame, world: Array) -> Seen:
        """What the camera sees of the objects at their matrices (n, 4, 4)."""
        places = world[self._rows]
        centres = np.einsum("nij,nj->ni", places[:, :3, :3], self._centres) + places[:, :3, 3]
        planes = view.frustum(frame.view_projection)
        seen = np.flatnonzero((centres @ planes[:, :3].T + planes[:, 3] > -self._radii[:, None]).all(axis=1))
        # What is near hides what is far, and is drawn first; what reaches far, such as the ground, comes late.
        away = np.linalg.norm(centres[seen] - frame.eye, axis=1)
        order = np.argsort(away + self._radii[seen], kind="stable")
        seen, away = seen[order], away[order]
        allowed = self._tolerance * frame.pixel * np.maximum(away - self._radii[seen], 0.0)
        matrices = np.ascontiguousarray(places[seen].transpose(0, 2, 1), dtype=np.float32)
        levels = [self._pieces[i].level(most) for i, most in zip(seen.tolist(), allowed.tolist(), strict=True)]
        return Seen(seen, centres[seen], matrices, levels)

    def measure(self, frame: Frame, world: Array, ranges: RangePass) -> None:
        """Draws the shapes that the camera sees, for their distances."""
        index, _, matrices, levels = self._seen(frame, world)
        for i, matrix, level in zip(index.tolist(), matrices, levels, strict=True):
            ranges.place(matrix, int(self._rows[i]))
            self._pieces[i].surface.shape(ranges.program).render(vertices=level.corners, first=level.first)

    def draw(self, frame: Frame, world: Array) -> None:
        """Draws what the camera sees of the objects at their matrices (n, 4, 4)."""
        seen, centres, matrices, levels = self._seen(frame, world)
        lighting = self._lighting
        lamps = lighting.places(world)
        lights = lighting.uniforms(lamps)
        chosen = lighting.strongest(lamps, self._rows[seen], centres, self._radii[seen])
        shared: dict[str, npt.ArrayLike] = {"ambient": self._ambient, "eye": frame.eye, **frame.sun_uniforms()}
        shared["view_projection"] = frame.view_projection.T
        uniforms = {name: packed(value) for name, value in shared.items()}
        begun: set[moderngl.Program] = set()
        used: tuple[moderngl.Program, Maps] | None = None
        for i, matrix, numbers, level in zip(seen.tolist(), matrices, chosen, levels, strict=True):
            piece = self._pieces[i]
            surface = piece.surface
            array = surface.array(len(numbers))
            program = array.program
            if program not in begun:
                begun.add(program)
                write(program, **uniforms)
            if used != (program, surface.maps):
                used = program, surface.maps
                surface.maps.use(program)
            program["model"].write(matrix)
            if self._marks:
                program["mark"].write(self._marks[i])
            if numbers:
                program["lights"].write(lights[list(numbers)])
            array.render(vertices=level.corners, first=level.first)
