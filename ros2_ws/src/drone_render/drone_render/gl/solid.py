"""Solid objects: culling, choice of lights and levels of detail, order of drawing."""

from collections.abc import Callable, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from drone_engine.arrays import Floats
from drone_engine.geometry.mesh import Model
from drone_engine.scene.picture import Render
from drone_render.arrays import Indices
from drone_render.frame import view
from drone_render.frame.frame import Frame
from drone_render.frame.lighting import MAX_LIGHTS, Lighting
from drone_render.gl.depth import DepthPass
from drone_render.gl.device import Device
from drone_render.gl.edges import marks
from drone_render.gl.instances import Batch, Instances
from drone_render.gl.surface import Maps, Surface, Surfaces
from drone_render.gl.uniforms import packed, setter, write
from drone_render.gl.variant import Variant

TOLERANCE = 1.4  # pixels, error of levels of detail


class Visible(NamedTuple):
    """The m pieces in view, the nearest first."""

    pieces: Indices  # (m,) their numbers
    boxes: Floats  # (m, 4, 4) matrices of their boxes' centers in the world
    levels: list[int]  # level of detail of each


class SolidPass:
    """All surfaces but water and sky.

    models: by their object's row in the scene; objects with equal models share surfaces. tolerance: error of the levels
    of detail in pixels; at 0 only levels without error are used.
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
        self._centers = np.array([piece.center for piece in self._pieces]).reshape(-1, 3)
        self._halves = np.array([piece.half for piece in self._pieces]).reshape(-1, 3)
        self._radii = np.array([piece.radius for piece in self._pieces])
        most_levels = max((len(piece.levels) for piece in self._pieces), default=1)
        self._setters: dict[moderngl.Program, list[tuple[str, Callable[[bytes], object]]]] = {}
        self._errors = np.full((len(self._pieces), most_levels), np.inf)
        for row, piece in zip(self._errors, self._pieces, strict=True):
            row[: len(piece.levels)] = [level.error for level in piece.levels]

    def warm_up(self) -> None:
        """Draws with every program that can occur: the driver compiles each at its first use, which is slow."""
        parallel = self._lighting.sun is not None
        done: set[Variant] = set()
        for piece, row in zip(self._pieces, self._rows, strict=True):
            for count in range(min(int(self._lighting.lit[row].sum()) - parallel, MAX_LIGHTS) + 1):
                variant = piece.surface.variant(count)
                if variant not in done:
                    done.add(variant)
                    draw = piece.surface.draw(count)
                    write(draw.program, view_projection=np.eye(4))
                    piece.surface.maps.use()
                    draw.array.render()

    def _visible(self, frame: Frame, tolerance: float) -> Visible:
        """The pieces in view; tolerance: error of their levels of detail, pixels."""
        boxes = frame.world[self._rows]
        boxes[:, :3, 3] += np.einsum("nij,nj->ni", boxes[:, :3, :3], self._centers)
        centers = boxes[:, :3, 3]
        planes = view.frustum(frame.view_projection)
        inside = (centers @ planes[:, :3].T + planes[:, 3] > -self._radii[:, None]).all(axis=1)
        visible = np.flatnonzero(inside)
        # Near pieces hide far ones and are drawn first; pieces that extend far, such as the ground, are drawn late.
        distance = np.linalg.norm(centers[visible] - frame.eye, axis=1)
        order = np.argsort(distance + self._radii[visible], kind="stable")
        visible, distance = visible[order], distance[order]
        allowed = tolerance * frame.pixel_angle * np.maximum(distance - self._radii[visible], 0.0)
        coarsest = (self._errors[visible] <= allowed[:, None]).sum(axis=1) - 1
        return Visible(visible, boxes[visible], coarsest.tolist())

    def _fill(
        self, visible: Visible, world: Floats, marks: npt.NDArray[np.floating], lights: Sequence[tuple[int, ...]]
    ) -> list[tuple[Surface, tuple[int, ...]]]:
        """Fills the instance buffers with one batch per shape, level and set of lights; returns surface and lights of
        each batch.

        marks: (n,) of all pieces; lights: numbers of the lights of each visible piece.
        """
        groups: dict[tuple[int, int, tuple[int, ...]], list[int]] = {}
        for i, level, chosen in zip(visible.pieces.tolist(), visible.levels, lights, strict=True):
            groups.setdefault((id(self._pieces[i]), level, chosen), []).append(i)
        batches: list[Batch] = []
        drawn: list[tuple[Surface, tuple[int, ...]]] = []
        start = 0
        for (_, level, chosen), pieces in groups.items():
            piece = self._pieces[pieces[0]]
            first, indices, _ = piece.levels[level]
            batches.append(Batch(first, indices, start, len(pieces)))
            drawn.append((piece.surface, chosen))
            start += len(pieces)
        order = list(chain.from_iterable(groups.values()))
        self._instances.fill(world[self._rows[order]], marks[order], batches)
        return drawn

    def draw_depth(self, frame: Frame, depth: DepthPass) -> None:
        """Draws depth and labels in full detail."""
        visible = self._visible(frame, 0.0)
        drawn = self._fill(visible, frame.world, self._rows + 1.0, [()] * len(visible.levels))
        for batch, (surface, _) in enumerate(drawn):
            self._instances.draw(surface.shape(depth.program), batch)

    def draw(self, frame: Frame) -> None:
        """Draws the surfaces in view."""
        visible = self._visible(frame, self._tolerance)
        lighting = self._lighting
        matrices = lighting.matrices(frame.world)
        lights = lighting.uniforms(matrices)
        rows = visible.pieces
        strongest = lighting.strongest(matrices, self._rows[rows], visible.boxes, self._halves[rows])
        packed_lights = {chosen: packed(lights[list(chosen)]) for chosen in set(strongest)}
        shared: dict[str, npt.ArrayLike] = {"ambient": self._ambient, "eye": frame.eye, **frame.sun_uniforms()}
        shared["view_projection"] = frame.view_projection.T
        uniforms = {name: packed(value) for name, value in shared.items()}
        begun: set[moderngl.Program] = set()
        used: tuple[moderngl.Program | None, Maps | None] = None, None
        for batch, (surface, chosen) in enumerate(self._fill(visible, frame.world, self._marks, strongest)):
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
        """Sets the uniforms of a program that all draws of a picture share."""
        if program not in self._setters:
            found = ((name, setter(program, name)) for name in uniforms)
            self._setters[program] = [(name, put) for name, put in found if put is not None]
        for name, put in self._setters[program]:
            put(uniforms[name])
