"""The tree of a scene's objects: where each of them is in the world."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from drone_engine import Scene
from drone_engine.arrays import Floats
from drone_engine.math.poses import compose, poses_from_rpy
from drone_render.frame.poses import matrices
from drone_render.frame.view import camera_matrix

if TYPE_CHECKING:
    from drone_engine.world import World

    State = World | Mapping[str, Floats] | Floats | None  # see Renderer


class Hierarchy:
    """The n objects of a scene, in the scene's order, each with a pose in its parent's frame."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.names = tuple(scene.objects)
        self.start = poses_from_rpy(thing.pose for thing in scene.objects.values())
        """Poses (n, 7) in the scene file."""
        row = {name: i for i, name in enumerate(self.names)}
        depths: dict[int, list[int]] = {}
        for name in self.names:
            depths.setdefault(len(list(self.ancestors(name))), []).append(row[name])
        # Rows and their parents' rows, by depth: parents are transformed before their children.
        self._depths = [
            (np.array(rows), np.array([row[scene.objects[self.names[i]].parent or ""] for i in rows]))
            for depth, rows in sorted(depths.items())
            if depth
        ]
        self._row = row

    def ancestors(self, name: str) -> Iterator[str]:
        """The object's parent, the parent's parent, and so on."""
        parent = self.scene.objects[name].parent
        while parent is not None:
            yield parent
            parent = self.scene.objects[parent].parent

    def poses(self, state: "State") -> Floats:
        """Poses (n, 7) of all objects, each in its parent's frame.

        state: a World of this scene; poses (7,) by name, the others as at the start; poses (n, 7); or None, the start.
        Raises ValueError for an unknown object, and for poses of another shape.
        """
        if state is None:
            return self.start
        if isinstance(state, np.ndarray):
            if state.shape != self.start.shape:
                raise ValueError(f"poses: expected an array of shape {self.start.shape}, got {state.shape}")
            return state
        changed = state if isinstance(state, Mapping) else _world_poses(state)
        result = self.start.copy()
        for name, numbers in changed.items():
            if name not in self._row:
                raise ValueError(f"poses: no object is called '{name}' in the scene '{self.scene.name}'")
            if np.shape(numbers) != (7,):
                raise ValueError(f"poses: '{name}': expected 7 numbers, x y z qx qy qz qw, got an array of shape "
                                 f"{np.shape(numbers)}")
            result[self._row[name]] = numbers
        return result

    def world(self, poses: Floats) -> Floats:
        """Matrices (n, 4, 4) in the world of poses (n, 7), each in its parent's frame."""
        result = matrices(poses)
        for rows, parents in self._depths:
            result[rows] = result[parents] @ result[rows]
        return result

    def matrix(self, world: Floats, name: str | None) -> Floats:
        """Matrix (4, 4) of the object `name` among the matrices `world` (n, 4, 4); the unit matrix for None."""
        return np.eye(4) if name is None else world[self._row[name]]

    def camera(self, name: str, world: Floats, time: float) -> Floats:
        """Matrix (4, 4) of a camera in the world at `time` in s; world: (n, 4, 4) of all objects."""
        camera = self.scene.cameras[name]
        target = None if camera.look_at is None else self.matrix(world, camera.look_at)[:3, 3]
        return camera_matrix(camera, self.matrix(world, camera.parent), target, time)


def _world_poses(world: "World") -> dict[str, Floats]:
    """Poses (7,) of the bodies and rotors of a World by name, each in its parent's frame."""
    rotors, half_angle = world.model.rotors, world.state.rotor_angle / 2
    rotation = np.zeros((len(half_angle), 7))
    rotation[:, 5], rotation[:, 6] = np.sin(half_angle), np.cos(half_angle)
    names = [*world.model.bodies.names, *rotors.names]
    return dict(zip(names, [*world.object_poses(), *compose(rotors.pose_p, rotation)], strict=True))
