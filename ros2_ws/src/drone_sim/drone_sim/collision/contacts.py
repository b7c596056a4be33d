"""Collision detection of a whole step: broad phase, then the contacts of each pair at its level."""

import numpy as np

from drone_sim.arrays import Floats, Integers
from drone_sim.collision import grid
from drone_sim.collision.levels import Levels
from drone_sim.collision.manifold import Manifolds
from drone_sim.collision.meshes import Meshes
from drone_sim.collision.narrow import MARGIN, axes_of, find_contacts
from drone_sim.model import OCTREE, SPHERE, Model
from drone_sim.state import State


class Detection:
    """The stage that finds all contacts; `manifolds` are those of the current step, `levels` may change between two."""

    def __init__(self, model: Model, state: State, dt: float) -> None:
        bodies = model.bodies
        self._model, self._state, self._dt = model, state, dt
        self.levels = Levels(model.meeting)
        self.axes: Floats = np.empty((bodies.count, 3, 3))
        self.manifolds, self._last = Manifolds(64), Manifolds(64)
        self._grid = grid.Grid(bodies.half[bodies.solid])
        self._low, self._high = np.empty((2, bodies.count, 3))
        self._scratch = np.empty((3, 15))
        self._half = bodies.half.copy()
        self._half[[plane.body for plane in model.floors]] = np.inf
        on_floor = np.flatnonzero(bodies.movable & bodies.solid)
        self._floor_pairs = np.array([sorted((i, plane.body)) for plane in model.floors for i in on_floor],
                                     np.int64).reshape(-1, 2)
        self._floor_heights = np.repeat([plane.height for plane in model.floors], len(on_floor)).astype(np.float64)
        self._meshes: Meshes | None = None
        self.prepare()

    def prepare(self) -> None:
        """Gets ready for the levels as they are now. Raises mesh.MeshError for models that cannot be read."""
        bodies = self.levels.meshes()
        if self._meshes is None or not np.array_equal(self._meshes.bodies, bodies):
            self._meshes = Meshes(self._model, bodies) if len(bodies) else None
        radius = np.linalg.norm(self._model.bodies.half, axis=1)
        self._radius = radius if self.levels.uses(SPHERE) else np.zeros_like(radius)

    def clear(self) -> None:
        """Forgets the last step."""
        self.manifolds.empty()

    def __call__(self) -> None:
        state, bodies = self._state, self._model.bodies
        self.manifolds, self._last = self._last, self.manifolds
        axes_of(state.orientation_w, self.axes)
        grid.bounds(state.position_w, self.axes, bodies.half, self._radius, state.velocity_w, self._dt, MARGIN,
                    self._low, self._high)
        a, b, height = self._candidates()
        level, everything = self.levels.of(a, b)
        self.manifolds.empty()
        if self._meshes:
            fine = level >= OCTREE
            self._find(a[~fine], b[~fine], height[~fine], level[~fine], everything[~fine])
            self.manifolds = self._meshes.find(self.manifolds, state, self.axes, self._dt, a[fine], b[fine],
                                               height[fine], level[fine], everything[fine])
        else:
            self._find(a, b, height, level, everything)
        self.manifolds.start_from(self._last)

    def _find(self, a: Integers, b: Integers, height: Floats, level: Integers, everything: Integers) -> None:
        """Finds the contacts of boxes, spheres and floors."""
        new, state = self.manifolds.with_room(len(a)), self._state
        self.manifolds = new
        new.count = find_contacts(state.position_w, self.axes, self._half, state.velocity_w, self._dt, a, b, height,
                                  level, everything, self._scratch, new.pair, new.points, new.normal_w, new.point_w,
                                  new.separation, new.feature, new.origin_w, new.level)
        new.mesh_start = new.swept_start = new.count

    def sectors(self) -> tuple[Floats, Floats]:
        """Lowest corners (k, 3) and edges (k,) in m of the sectors that bodies stand in which can move, each once."""
        moving = self._model.bodies.movable & self._model.bodies.solid
        return self._grid.sectors(self._low[moving], self._high[moving])

    def _candidates(self) -> tuple[Integers, Integers, Floats]:
        """Pairs a < b in order, and the height of the floor where one of the two is a floor, else NaN."""
        bodies = self._model.bodies
        a, b = self._grid.pairs(self._low, self._high, bodies.solid, bodies.movable)
        if not len(self._floor_pairs):
            return a, b, np.full(len(a), np.nan)
        a, b = np.concatenate([a, self._floor_pairs[:, 0]]), np.concatenate([b, self._floor_pairs[:, 1]])
        height = np.concatenate([np.full(len(a) - len(self._floor_heights), np.nan), self._floor_heights])
        order = np.lexsort((b, a))
        return a[order], b[order], height[order]
