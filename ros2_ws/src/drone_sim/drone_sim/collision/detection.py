"""Collision detection of a whole step: broad phase, then the contacts of each pair at its level."""

import numpy as np

from drone_sim.arrays import Floats, Integers
from drone_sim.collision import grid, meshes, obb
from drone_sim.collision.impacts import Impacts
from drone_sim.collision.levels import Levels
from drone_sim.collision.manifold import Manifolds, anchor
from drone_sim.collision.narrow import MARGIN, Placed, axes_of, find_contacts, margins
from drone_sim.model import OCTREE, SPHERE, Model
from drone_sim.state import State

Pairs = tuple[Integers, Integers, Floats, Integers, Integers, Floats]  # a < b, floor's height, level, all?, margin


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
        self._ball: Floats = np.linalg.norm(bodies.half, axis=1)
        self._scratch = obb.scratch()
        half = bodies.half.copy()
        half[[plane.body for plane in model.floors]] = np.inf
        self._now = Placed(np.arange(bodies.count), state.position_w, state.orientation_w, self.axes, half)
        on_floor = np.flatnonzero(bodies.movable & bodies.solid)
        self._floor_pairs = np.array([sorted((i, plane.body)) for plane in model.floors for i in on_floor],
                                     np.int64).reshape(-1, 2)
        self._floor_heights = np.repeat([plane.height for plane in model.floors], len(on_floor)).astype(np.float64)
        self._impacts = Impacts(bodies.half, dt)
        self._meshes: meshes.Meshes | None = None
        self._with_meshes: Integers = np.empty(0, np.int64)
        self.prepare()

    def prepare(self) -> None:
        """Gets ready for the levels as they are now. Raises mesh.MeshError for models that cannot be read."""
        bodies = self.levels.meshes()
        if not np.array_equal(self._with_meshes, bodies):
            self._meshes = meshes.read(self._model, bodies) if len(bodies) else None
            self._with_meshes = bodies
        self._radius = self._ball if self.levels.uses(SPHERE) else np.zeros_like(self._ball)

    def compile(self) -> None:
        """Compiles what the levels as they are now may need, so that no step has to."""
        nothing = np.empty(0, np.int64)
        pairs = nothing, nothing, np.empty(0), nothing, nothing, np.empty(0)
        self._find_rough(self._now, pairs)
        self._find_ahead(pairs)
        if self._meshes:
            self.manifolds = self._meshes.find(self.manifolds, self._now, *pairs)
        self.manifolds.start_from(self._last)
        self.clear()

    def clear(self) -> None:
        """Forgets the last step."""
        self.manifolds.empty()

    def __call__(self) -> None:
        state, bodies = self._state, self._model.bodies
        self.manifolds, self._last = self._last, self.manifolds
        self.manifolds.empty()
        axes_of(state.orientation_w, self.axes)
        quick = self._impacts.look(state)
        radius = np.where(self._impacts.quick, self._ball, self._radius) if quick else self._radius
        grid.bounds(state.position_w, self.axes, bodies.half, radius, state.velocity_w, self._dt, MARGIN,
                    self._low, self._high)
        a, b, height = self._candidates()
        level, everything = self.levels.of(a, b)
        margin, swept = np.empty(len(a)), np.empty(len(a), np.bool_)
        ahead = margins(a, b, height, state.velocity_w, self._dt, self._impacts.quick, margin, swept)
        pairs = a, b, height, level, everything, margin
        self._find_rough(self._now, pairs)
        self.manifolds.mesh_start = self.manifolds.count
        self._find_fine(self._now, pairs)
        m = self.manifolds
        m.swept_start = m.count
        anchor(m.count, m.pair, m.points, m.point_w, state.position_w, m.anchor_w)
        if quick and ahead:
            self._find_ahead(_only(swept & (level >= SPHERE), pairs))
        self.manifolds.start_from(self._last)

    def _find_rough(self, placed: Placed, pairs: Pairs) -> None:
        """Appends the contacts of placed spheres, boxes and floors."""
        if self._meshes:
            pairs = _only(pairs[3] < OCTREE, pairs)
        m = self.manifolds = self.manifolds.with_room(len(pairs[0]))
        m.count = find_contacts(placed.position, placed.axes, placed.half, *pairs, self._scratch, m.pair, m.points,
                                m.normal_w, m.point_w, m.separation, m.feature, m.level, m.count)

    def _find_fine(self, placed: Placed, pairs: Pairs) -> None:
        """Appends the contacts of placed meshes."""
        if self._meshes:
            fine = _only(pairs[3] >= OCTREE, pairs)
            if len(fine[0]):  # most steps have none
                self.manifolds = self._meshes.find(self.manifolds, placed, *fine)

    def _find_ahead(self, pairs: Pairs) -> None:
        """Appends the contacts that fast bodies will have within the step."""
        placed, meeting = self._impacts.place(self._state, pairs[0], pairs[1], pairs[3], self._meshes)
        a, b, height, level, everything, margin = _only(meeting, pairs)
        margin = margin + 2.0 * np.minimum(self._ball[a], self._ball[b])  # all that may swing round
        first = 2 * np.arange(len(meeting))
        there = first, first + 1, height, level, everything, margin
        self._find_rough(placed, there)
        self._find_fine(placed, there)
        self._impacts.bring_back(self.manifolds, placed, self._state)

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


def _only(which: Integers | np.ndarray, pairs: Pairs) -> Pairs:
    """Those pairs, by mask or index."""
    a, b, height, level, everything, margin = pairs
    return a[which], b[which], height[which], level[which], everything[which], margin[which]
