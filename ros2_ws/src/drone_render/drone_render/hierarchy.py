"""What hangs on what: the poses of a scene's objects in the world, and which lights shine on which."""

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from drone_engine import Scene
from drone_render import daylight
from drone_render.frame import Sun
from drone_render.view import Array, camera_matrix, matrices, pose

LIGHTS = 4  # that a surface is lit by beside the parallel one, at most; a triangle hands on no more than six of them
DARK = 1 / 128  # of a light's brightness; where less than that is left, it has ended
UNSEEN = 1 / 255  # a light that adds less is not computed
PARALLEL = 200.0  # m from the origin, beyond which a light without reach has parallel rays


class Hierarchy:
    """The tree of a scene's objects, in the scene's order."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.names = tuple(scene.objects)
        self.start = np.array([pose(thing.pose) for thing in scene.objects.values()]).reshape(-1, 7)
        row = {name: i for i, name in enumerate(self.names)}
        levels: dict[int, list[int]] = {}
        for name in self.names:
            levels.setdefault(len(list(self.ancestors(name))), []).append(row[name])
        # Parents come before their children, and all of one depth are turned at once.
        self._levels = [
            (np.array(rows), np.array([row[scene.objects[self.names[i]].parent or ""] for i in rows]))
            for depth, rows in sorted(levels.items())
            if depth
        ]
        self._row = row

    def ancestors(self, name: str) -> Iterator[str]:
        """The parent, its parent, and so on."""
        parent = self.scene.objects[name].parent
        while parent is not None:
            yield parent
            parent = self.scene.objects[parent].parent

    def world(self, poses: Array) -> Array:
        """Matrices (n, 4, 4) in the world of poses (n, 7), each in its parent's frame."""
        result = matrices(poses)
        for rows, parents in self._levels:
            result[rows] = result[parents] @ result[rows]
        return result

    def place(self, world: Array, name: str | None) -> Array:
        """Matrix (4, 4) of an object by its name; the world's own for None."""
        return np.eye(4) if name is None else world[self._row[name]]

    def camera(self, name: str, world: Array, time: float) -> Array:
        """Matrix (4, 4) of a camera at `time` in s."""
        camera = self.scene.cameras[name]
        target = None if camera.look_at is None else self.place(world, camera.look_at)[:3, 3]
        return camera_matrix(camera, self.place(world, camera.parent), target, time)


class Lighting:
    """Chooses, for each object, the lights that it is lit by."""

    def __init__(self, hierarchy: Hierarchy) -> None:
        lights = list(hierarchy.scene.lights.values())
        self._hierarchy = hierarchy
        self._parents = [light.parent for light in lights]
        self._offsets = matrices(np.array([pose(light.pose) for light in lights]).reshape(-1, 7))
        edges = np.cos([np.pi if light.beam is None else light.beam for light in lights])
        self.beams = any(light.beam is not None for light in lights)
        """Whether any light shines one way only."""
        self._edges = edges.reshape(-1)
        self.colours = np.array([light.colour for light in lights]).reshape(-1, 3)
        self.colours *= np.array([light.intensity for light in lights]).reshape(-1, 1)
        self.falloff = np.array([0.0 if light.reach is None else light.reach**-2 for light in lights])
        self._parallel = self._far()
        self.sun: Sun | None = None
        """What is drawn apart from the other lights, as its rays are parallel."""
        if (number := self._parallel) is not None:
            self.colours[number] *= daylight.sun(hierarchy.scene.render.daylight)
            self.sun = Sun(self._offsets[number, :3, 3], self.colours[number])
        self._end = self.falloff * DARK / (1 - DARK)  # 1 / m^2, of the distance at which a light has ended
        self._brightness = self.colours.max(axis=1, initial=0.0)
        self.lit = np.array(
            [[light.parent not in {name, *hierarchy.ancestors(name)} for light in lights] for name in hierarchy.names],
            dtype=np.bool_,
        ).reshape(len(hierarchy.names), len(lights))
        """(objects, lights): False for the lights of an object itself and of whatever it hangs on."""

    def places(self, world: Array) -> Array:
        """Matrices (lights, 4, 4) of all lights in the world."""
        parents = [self._hierarchy.place(world, parent) for parent in self._parents]
        return np.array(parents).reshape(-1, 4, 4) @ self._offsets

    def uniforms(self, places: Array) -> npt.NDArray[np.float32]:
        """What the shaders take of each light, (lights, 8), or (lights, 12) where there are beams; see lights.glsl."""
        columns = [places[:, :3, 3], self.falloff, self.colours, self._end]
        if self.beams:
            # Full along the beam, nothing from its edge on; what shines all around has no axis.
            scale = np.where(self._edges > -1, 1 / np.maximum(1 - self._edges, 1e-9), 0.0)
            columns += [-places[:, :3, 0] * scale[:, None], np.where(self._edges > -1, -self._edges * scale, 1.0)]
        return np.column_stack(columns).astype(np.float32)

    def strongest(
        self, places: Array, rows: npt.NDArray[np.intp], boxes: Array, halves: Array
    ) -> Sequence[tuple[int, ...]]:
        """For each box (matrices (n, 4, 4), half its edges (n, 3)) of the objects `rows`, the LIGHTS brightest at most,
        in the scene's order.

        places: of the lights. The parallel one is not among them, nor any whose beam misses the sphere around the box.
        """
        way = boxes[:, None, :3, 3] - places[None, :, :3, 3]
        aside = np.maximum(np.abs(way @ boxes[:, :3, :3]) - halves[:, None], 0.0)
        square = np.einsum("nli,nli->nl", aside, aside)
        left = np.maximum(1 - square * self._end, 0.0) / (1 + square * self.falloff)
        strength = np.where(self.lit[rows], left * self._brightness, 0.0)
        if self.beams:
            distance = np.maximum(np.linalg.norm(way, axis=2), 1e-9)
            turn = np.arccos(np.clip(np.einsum("nli,li->nl", way, places[:, :3, 0]) / distance, -1, 1))
            width = np.linalg.norm(halves, axis=1)[:, None] / distance
            nearest = turn - np.arcsin(np.minimum(width, 1.0))
            strength = np.where((width < 1) & (nearest >= np.arccos(self._edges)), 0.0, strength)
        if self._parallel is not None:
            strength[:, self._parallel] = 0.0
        order = np.argsort(-strength, axis=1, kind="stable")[:, :LIGHTS]
        counts = (strength > UNSEEN).sum(axis=1)
        return [tuple(sorted(lights[:count])) for lights, count in zip(order.tolist(), counts.tolist(), strict=True)]

    def _far(self) -> int | None:
        """The brightest of the far lights that shine all around and that distance does not weaken, or None."""
        away = np.linalg.norm(self._offsets[:, :3, 3], axis=1) > PARALLEL
        free = np.array([parent is None for parent in self._parents], dtype=np.bool_)
        far = np.flatnonzero((self.falloff == 0) & (self._edges <= -1) & away & free)
        return int(far[np.argmax(self.colours[far].max(axis=1))]) if len(far) else None
