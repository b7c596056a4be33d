"""Solid things: which of them are seen, by which lights, how finely, and in which order they are drawn."""

from collections.abc import Callable, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from drone_engine.geometry.mesh import Model
from drone_engine.scene.picture import Render
from drone_render import view
from drone_render.context import Device, packed, setter, write
from drone_render.edges import marks
from drone_render.frame import Frame
from drone_render.hierarchy import LIGHTS, Lighting
from drone_render.instances import Batch, Instances
from drone_render.ranges import RangePass
from drone_render.shaders import Variant
from drone_render.surface import Maps, Surface, Surfaces
from drone_render.view import Array

TOLERANCE = 1.4  # pixels that a level of detail may be off by


class Seen(NamedTuple):
    """Pieces, the nearest first: their numbers, matrices (m, 4, 4) of their boxes in the world, levels of detail."""

    pieces: npt.NDArray[np.intp]
    boxes: Array
    levels: list[int]


class SolidPass:
    """All that is neither water nor sky; models by their object's row in the scene. Equal models are there once.

    tolerance: pixels that levels of detail may be off by; at 0 only those are drawn that lose nothing.
    """

    def __init__(
        self, device: Device, render: Render, models: Mapping[int, Model], lighting: Lighting,
        tolerance: float = TOLERANCE,
    ) -> None:  # fmt: skip
        self._ambient = render.ambient
        self._lighting = lighting
        self._tolerance = tolerance
        self._instances = Instances(device)
        surfaces = Surfaces(device, render, lighting, self._instances)
        pairs = [(row, piece) for row, model in models.items() for piece in surfaces.pieces(model)]
        self._pieces = [piece for _, piece in pairs]
        self._rows = np.array([row for row, _ in pairs], dtype=np.intp)
        smooth = render.antialiasing is not None
        self._marks = marks([(row, id(piece.surface)) for row, piece in pairs]) if smooth else np.zeros(len(pairs))
        self._middles = np.array([piece.middle for piece in self._pieces]).reshape(-1, 3)
        self._halves = np.array([piece.half for piece in self._pieces]).reshape(-1, 3)
        self._radii = np.array([piece.radius for piece in self._pieces])
        deepest = max((len(piece.levels) for piece in self._pieces), default=1)
        self._setters: dict[moderngl.Program, list[tuple[str, Callable[[bytes], object]]]] = {}
        self._errors = np.full((len(self._pieces), deepest), np.inf)
        for row, piece in zip(self._errors, self._pieces, strict=True):
            row[: len(piece.levels)] = [level.error for level in piece.levels]

    def warm_up(self) -> None:
        """Draws with every program that can occur: the driver compiles each at its first use, which takes a while."""
        parallel = self._lighting.sun is not None
        seen: set[Variant] = set()
        for piece, row in zip(self._pieces, self._rows, strict=True):
            for count in range(min(int(self._lighting.lit[row].sum()) - parallel, LIGHTS) + 1):
                variant = piece.surface.variant(count)
                if variant not in seen:
                    seen.add(variant)
                    draw = piece.surface.draw(count)
                    write(draw.program, view_projection=np.eye(4))
                    piece.surface.maps.use()
                    draw.array.render()

    def _seen(self, frame: Frame, world: Array, tolerance: float) -> Seen:
        """What the camera sees of the objects at their matrices (n, 4, 4)."""
        boxes = world[self._rows]
        boxes[:, :3, 3] += np.einsum("nij,nj->ni", boxes[:, :3, :3], self._middles)
        centres = boxes[:, :3, 3]
        planes = view.frustum(frame.view_projection)
        seen = np.flatnonzero((centres @ planes[:, :3].T + planes[:, 3] > -self._radii[:, None]).all(axis=1))
        # What is near hides what is far, and comes first; what reaches far, such as the ground, comes late.
        away = np.linalg.norm(centres[seen] - frame.eye, axis=1)
        order = np.argsort(away + self._radii[seen], kind="stable")
        seen, away = seen[order], away[order]
        allowed = tolerance * frame.pixel * np.maximum(away - self._radii[seen], 0.0)
        fewest = (self._errors[seen] <= allowed[:, None]).sum(axis=1) - 1
        return Seen(seen, boxes[seen], fewest.tolist())

    def _fill(
        self, seen: Seen, world: Array, marks: npt.NDArray[np.floating], lights: Sequence[tuple[int, ...]]
    ) -> list[tuple[Surface, tuple[int, ...]]]:
        """Fills the instances: a batch for what has one shape and the same lights. Returns each batch's two.

        marks: of all pieces; lights: numbers of those that shine on what is seen.
        """
        alike: dict[tuple[int, int, tuple[int, ...]], list[int]] = {}
        for i, level, chosen in zip(seen.pieces.tolist(), seen.levels, lights, strict=True):
            alike.setdefault((id(self._pieces[i]), level, chosen), []).append(i)
        batches: list[Batch] = []
        drawn: list[tuple[Surface, tuple[int, ...]]] = []
        start = 0
        for (_, level, chosen), pieces in alike.items():
            piece = self._pieces[pieces[0]]
            first, corners, _ = piece.levels[level]
            batches.append(Batch(first, corners, start, len(pieces)))
            drawn.append((piece.surface, chosen))
            start += len(pieces)
        order = list(chain.from_iterable(alike.values()))
        self._instances.fill(world[self._rows[order]], marks[order], batches)
        return drawn

    def measure(self, frame: Frame, world: Array, ranges: RangePass) -> None:
        """Draws the shapes that the camera sees, for their distances, in full detail."""
        seen = self._seen(frame, world, 0.0)
        drawn = self._fill(seen, world, self._rows + 1.0, [()] * len(seen.levels))
        for batch, (surface, _) in enumerate(drawn):
            self._instances.draw(surface.shape(ranges.program), batch)

    def draw(self, frame: Frame, world: Array) -> None:
        """Draws what the camera sees of the objects at their matrices (n, 4, 4)."""
        seen = self._seen(frame, world, self._tolerance)
        lighting = self._lighting
        places = lighting.places(world)
        lights = lighting.uniforms(places)
        strongest = lighting.strongest(places, self._rows[seen.pieces], seen.boxes, self._halves[seen.pieces])
        packed_lights = {chosen: packed(lights[list(chosen)]) for chosen in set(strongest)}
        shared: dict[str, npt.ArrayLike] = {"ambient": self._ambient, "eye": frame.eye, **frame.sun_uniforms()}
        shared["view_projection"] = frame.view_projection.T
        uniforms = {name: packed(value) for name, value in shared.items()}
        begun: set[moderngl.Program] = set()
        used: tuple[moderngl.Program | None, Maps | None] = None, None
        for batch, (surface, chosen) in enumerate(self._fill(seen, world, self._marks, strongest)):
            program, array, maps_uniforms, set_lights = surface.draw(len(chosen))
            if program not in begun:
                begun.add(program)
                self._begin(program, uniforms)
            if used[0] is not program or used[1] is not surface.maps:
                used = program, surface.maps
                surface.maps.use()
                for put, value in maps_uniforms:
                    put(value)
            if set_lights is not None:
                set_lights(packed_lights[chosen])
            self._instances.draw(array, batch)

    def _begin(self, program: moderngl.Program, uniforms: Mapping[str, bytes]) -> None:
        """Sets what a program needs of what all draws of a picture share."""
        if program not in self._setters:
            found = ((name, setter(program, name)) for name in uniforms)
            self._setters[program] = [(name, put) for name, put in found if put is not None]
        for name, put in self._setters[program]:
            put(uniforms[name])
