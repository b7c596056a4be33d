"""Chooses the lights that each surface is lit by."""

from collections.abc import Sequence

import numpy as np

from drone_engine.arrays import Booleans, Floats
from drone_engine.math.poses import poses_from_rpy
from drone_render.arrays import Float32s, Indices
from drone_render.frame import daylight
from drone_render.frame.frame import Sun
from drone_render.frame.hierarchy import Hierarchy
from drone_render.frame.poses import matrices

MAX_LIGHTS = 4  # per surface beside the sun; the varyings of a triangle have room for six at most
CUTOFF = 1 / 128  # share of a light's brightness; where less is left, the light ends
NEGLIGIBLE = 1 / 255  # lights that add less are not computed
SUN_DISTANCE = 200.0  # m from the origin, beyond which a light without `reach` has parallel rays


class Lighting:
    """The l lights of a scene with n objects."""

    def __init__(self, hierarchy: Hierarchy) -> None:
        lights = list(hierarchy.scene.lights.values())
        self._hierarchy = hierarchy
        self._parents = [light.parent for light in lights]
        self._offsets = matrices(poses_from_rpy(light.pose for light in lights))
        edge_cosines = np.cos([np.pi if light.beam is None else light.beam for light in lights])
        self.beams = any(light.beam is not None for light in lights)
        """Whether any light is a beam."""
        self._edge_cosines = edge_cosines.reshape(-1)
        self._colors = np.array([light.colour for light in lights]).reshape(-1, 3)
        self._colors *= np.array([light.intensity for light in lights]).reshape(-1, 1)
        self._falloff = np.array([0.0 if light.reach is None else light.reach**-2 for light in lights])
        self._sun = self._brightest_distant_light()
        self.sun: Sun | None = None
        """The light with parallel rays, which is drawn apart from the others."""
        if (number := self._sun) is not None:
            self._colors[number] *= daylight.sun(hierarchy.scene.render.daylight)
            self.sun = Sun(self._offsets[number, :3, 3], self._colors[number])
        self._end = self._falloff * CUTOFF / (1 - CUTOFF)  # 1 / m^2, of the distance at which a light ends
        self._brightness = self._colors.max(axis=1, initial=0.0)
        self.lit: Booleans = np.array(
            [[light.parent not in {name, *hierarchy.ancestors(name)} for light in lights] for name in hierarchy.names],
            dtype=np.bool_,
        ).reshape(len(hierarchy.names), len(lights))
        """(n, l): False for lights whose parent is the object itself or one of its ancestors."""

    def matrices(self, world: Floats) -> Floats:
        """Matrices (l, 4, 4) of all lights in the world; world: (n, 4, 4) of all objects."""
        parents = [self._hierarchy.matrix(world, parent) for parent in self._parents]
        return np.array(parents).reshape(-1, 4, 4) @ self._offsets

    def uniforms(self, lights: Floats) -> Float32s:
        """Shader constants (l, 8) of the lights, (l, 12) if there are beams, as solid_facet.glsl declares them.

        lights: matrices (l, 4, 4) in the world.
        """
        columns = [lights[:, :3, 3], self._falloff, self._colors, self._end]
        if self.beams:
            # The share of a beam falls linearly in the cosine, from 1 on its axis to 0 at its edge.
            is_beam = self._edge_cosines > -1
            scale = np.where(is_beam, 1 / np.maximum(1 - self._edge_cosines, 1e-9), 0.0)
            columns += [-lights[:, :3, 0] * scale[:, None], np.where(is_beam, -self._edge_cosines * scale, 1.0)]
        return np.column_stack(columns).astype(np.float32)

    def strongest(self, lights: Floats, rows: Indices, boxes: Floats, halves: Floats) -> Sequence[tuple[int, ...]]:
        """For each of m boxes, the numbers of its brightest lights, MAX_LIGHTS at most, in the scene's order.

        lights: matrices (l, 4, 4) in the world; rows: (m,) objects that the boxes belong to; boxes: matrices (m, 4, 4)
        of the boxes' centers; halves: (m, 3) half extents. The sun is left out, and so are beams that miss the sphere
        around the box.
        """
        offset = boxes[:, None, :3, 3] - lights[None, :, :3, 3]
        outside = np.maximum(np.abs(offset @ boxes[:, :3, :3]) - halves[:, None], 0.0)
        square = np.einsum("nli,nli->nl", outside, outside)
        left = np.maximum(1 - square * self._end, 0.0) / (1 + square * self._falloff)
        strength = np.where(self.lit[rows], left * self._brightness, 0.0)
        if self.beams:
            distance = np.maximum(np.linalg.norm(offset, axis=2), 1e-9)
            angle = np.arccos(np.clip(np.einsum("nli,li->nl", offset, lights[:, :3, 0]) / distance, -1, 1))
            width = np.linalg.norm(halves, axis=1)[:, None] / distance
            nearest = angle - np.arcsin(np.minimum(width, 1.0))
            strength = np.where((width < 1) & (nearest >= np.arccos(self._edge_cosines)), 0.0, strength)
        if self._sun is not None:
            strength[:, self._sun] = 0.0
        order = np.argsort(-strength, axis=1, kind="stable")[:, :MAX_LIGHTS]
        counts = (strength > NEGLIGIBLE).sum(axis=1)
        return [tuple(sorted(chosen[:count])) for chosen, count in zip(order.tolist(), counts.tolist(), strict=True)]

    def _brightest_distant_light(self) -> int | None:
        """The brightest distant light that has no parent, no beam and no falloff, or None."""
        distant = np.linalg.norm(self._offsets[:, :3, 3], axis=1) > SUN_DISTANCE
        free = np.array([parent is None for parent in self._parents], dtype=np.bool_)
        candidates = np.flatnonzero((self._falloff == 0) & (self._edge_cosines <= -1) & distant & free)
        if not len(candidates):
            return None
        return int(candidates[np.argmax(self._colors[candidates].max(axis=1))])
