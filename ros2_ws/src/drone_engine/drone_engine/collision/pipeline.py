"""Collision detection of a whole step, as stages: broad phase, then the contacts of each pair at its level."""

from collections.abc import Callable
from typing import Any

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box import contacts as narrow
from drone_engine.collision.box.contacts import find_boxes, find_others
from drone_engine.collision.broad_phase import grid
from drone_engine.collision.broad_phase.grid import bound, bounds, crowd, find_pairs
from drone_engine.collision.continuous.impacts import Impacts
from drone_engine.collision.continuous.sweep import fast
from drone_engine.collision.manifold import BOXES, GROUND, MESHES, OTHERS, SWEPT, Manifolds, anchor, carry_over, keep
from drone_engine.collision.margin import MARGIN, contact_margins
from drone_engine.collision.mesh import narrow as meshes
from drone_engine.collision.mesh.octree import Octree
from drone_engine.collision.placement import PlacedBodies, set_all_axes, set_axes
from drone_engine.collision.policy import CollisionPolicy, look_up
from drone_engine.collision.terrain import height_field as terrain
from drone_engine.collision.terrain.stage import MORE_CONTACTS, MOST, Footing, stand
from drone_engine.collision_level import OCTREE, SPHERE
from drone_engine.kernel import kernel
from drone_engine.model import Model
from drone_engine.program.program import Program
from drone_engine.program.stage import Stage
from drone_engine.state import State

CROWDED, OTHERS_STAND_STILL, MORE_MANIFOLDS = 10, 11, 12  # codes beside those of the grid
PAIRS, AHEAD, FINE, NEEDED = range(4)  # places in `count`
Pairs = tuple[Integers, Integers, Floats, Integers, Integers, Floats]  # a < b, floor's height, level, all?, margin


@kernel
def approach(awake, binned, solid, position, orientation, velocity, spin, half, ball, radius, dt, floor_of, planes,
             default, own, keys, words, axes, low, high, quick, movers, levels, static_top, static_start, static_entry,
             start, bucket, listed, entry, marks, pair, ordered, floor_height, level, everything, margin, swept, count):
    """The broad phase: what bodies that are awake may touch within dt, at which level, and how near is near.

    count: (4,) pairs, those to be looked for ahead, those of meshes, what is needed where a code other than 0 returns.
    binned: (n + 1,) who was awake when the others were put into the grid. floor_of: (n,) height of a floor, else NaN.
    """
    count[:] = 0
    for k in range(1 + awake[0]):
        if awake[k] != binned[k]:
            return OTHERS_STAND_STILL
    hurry, moving = 0, 0
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        set_axes(i, orientation, axes)
        if solid[i]:
            quick[i] = fast(i, velocity, spin, half, dt)
            hurry += quick[i]
            bound(i, position, axes, half, ball if quick[i] else radius, velocity, dt, MARGIN, low, high)
            movers[moving] = i
            moving += 1
    if moving == 0:
        return 0
    answer, found, tests = find_pairs(low, high, movers, moving, planes, levels, static_top, static_start, static_entry,
                                      start, bucket, listed, entry, marks, pair, ordered)
    if answer == grid.DONE and found > floor_height.shape[0]:
        answer = grid.MORE_PAIRS
    if answer != grid.DONE:
        count[NEEDED] = found
        return answer
    for k in range(found):
        a, b = ordered[0, k], ordered[1, k]
        floor_height[k] = floor_of[a] if not np.isnan(floor_of[a]) else floor_of[b]
    look_up(found, ordered[0], ordered[1], default, own, keys, words, level, everything)
    ahead = contact_margins(found, ordered[0], ordered[1], floor_height, velocity, spin, ball, dt, quick, margin, swept)
    for k in range(found):
        count[FINE] += level[k] >= OCTREE
    count[PAIRS], count[AHEAD] = found, ahead if hurry else 0
    return CROWDED if tests > crowd(moving, found) else 0


@kernel
def touch(count, position, axes, half, ordered, floor_height, level, everything, margin, table, cut, of_a, of_b, number,
          end, pair, points, normal, point, anchors, separation, feature, met):
    """The contacts of spheres, boxes and floors."""
    if count[PAIRS] > points.shape[0]:
        return MORE_MANIFOLDS
    found = find_boxes(count[PAIRS], position, axes, half, ordered[0], ordered[1], floor_height, level, everything,
                       margin, table, cut, of_a, of_b, number, pair, points, normal, point, separation, feature, met, 0)
    end[BOXES] = found
    found = find_others(count[PAIRS], position, axes, half, ordered[0], ordered[1], floor_height, level, everything,
                        margin, pair, points, normal, point, separation, feature, met, found)
    end[OTHERS] = end[GROUND] = end[MESHES] = end[SWEPT] = found
    anchor(0, found, pair, points, point, position, anchors)
    return 0


@kernel
def any_fine(count):
    """Whether meshes may touch."""
    return count[FINE]


@kernel
def any_ahead(count):
    """Whether fast bodies may meet within the step."""
    return count[AHEAD]


class Detection:
    """The stages that find all contacts; `manifolds` are those of the last step, `levels` may change between two."""

    def __init__(self, model: Model, state: State, dt: float) -> None:
        bodies = model.bodies
        n = bodies.count
        self._model, self._state, self._dt = model, state, dt
        self.levels = CollisionPolicy(model.collision)
        self.axes: Floats = np.empty((n, 3, 3))
        self.manifolds = Manifolds(64)
        self._grid = grid.Grid(bodies.half[bodies.solid])
        self._grid.room(n)
        self._low, self._high = np.empty((2, n, 3))
        self._ball: Floats = np.linalg.norm(bodies.half, axis=1)
        self._planes: Integers = np.array([plane.body for plane in model.floors], np.int64)
        self._floor_of: Floats = np.full(n, np.nan)
        half = bodies.half.copy()
        half[self._planes] = np.inf
        self._floor_of[self._planes] = [plane.height for plane in model.floors]
        land = terrain.of(model)
        self._footing = None if land is None or model.ground is None else Footing(land, model.ground)
        self._top: Floats = self._floor_of.copy()  # of floors, m
        if self._footing:
            self._top[self._footing.body] = self._footing.terrain.frame[6]
        self._now = PlacedBodies(np.arange(n), state.position_w, state.orientation_w, self.axes, half)
        self._impacts = Impacts(bodies.half, dt)
        self._quick: Booleans = np.zeros(n, np.bool_)
        self.sleeping: Booleans = np.zeros(n, np.bool_)
        self._movers, self._binned = np.empty(n, np.int64), np.full(n + 1, -1)
        self._count: Integers = np.zeros(4, np.int64)
        self._scratch = narrow.scratch()
        self._meshes: meshes.Meshes | None = None
        self._with_meshes: Integers = np.empty(0, np.int64)
        self._program: Program | None = None
        self.on_waking: Callable[[], None] = lambda: None  # called when others are awake than before
        self._make_room(len(self._grid.ordered[0]))
        self.prepare()

    def _make_room(self, pairs: int) -> None:
        self._floor_height, self._margin = np.empty((2, pairs))
        self._level, self._everything = np.empty((2, pairs), np.int64)
        self._swept = np.empty(pairs, np.bool_)

    @property
    def stages(self) -> tuple[Stage, ...]:
        """Those of a step; a scene without meshes has none for them."""
        fine = (Stage("mesh contacts", any_fine, (self._count,), self._find_fine),) if self.levels.uses_meshes else ()
        ground = (Stage("ground contacts", stand, self._ground_arguments, self._more_room),) if self._footing else ()
        return (Stage("keep", keep, self._keep_arguments),
                Stage("broad phase", approach, self._broad_arguments, self._attend),
                Stage("contacts", touch, self._contact_arguments, self._more_manifolds), *ground, *fine,
                Stage("impacts", any_ahead, (self._count,), self._find_ahead),
                Stage("warm start", carry_over, self._warm_arguments))

    @property
    def catching(self) -> Stage:
        """The stage after motion: no fast body is left where it could not have got."""
        return Stage("catch", any_ahead, (self._count,), self._catch)

    def belong_to(self, program: Program) -> None:
        """Tells which program to bind anew when arrays become others."""
        self._program = program

    def bind(self) -> None:
        """Takes all arrays anew, as some are others now."""
        if self._program:
            self._program.bind()

    def _broad_arguments(self) -> tuple[Any, ...]:
        s, bodies = self._state, self._model.bodies
        return (s.awake, self._binned, bodies.solid, s.position_w, s.orientation_w, s.velocity_w, s.angular_velocity_w,
                bodies.half, self._ball, self._radius, self._dt, self._floor_of, self._planes, *self.levels.tables(),
                self.axes, self._low, self._high, self._quick, self._movers, *self._grid.tables(), self._floor_height,
                self._level, self._everything, self._margin, self._swept, self._count)

    def _keep_arguments(self) -> tuple[Any, ...]:
        m = self.manifolds
        return (m.end, m.pair, m.level, m.points, m.normal_w, m.point_w, m.separation, m.feature, m.impulse,
                m.friction, m.total, *m.last.arrays())

    def _contact_arguments(self) -> tuple[Any, ...]:
        m = self.manifolds
        return (self._count, self._state.position_w, self.axes, self._now.half, self._grid.ordered, self._floor_height,
                self._level, self._everything, self._margin, *self._scratch, m.end, m.pair, m.points, m.normal_w,
                m.point_w, m.anchor_w, m.separation, m.feature, m.level)

    def _ground_arguments(self) -> tuple[Any, ...]:
        assert self._footing
        m = self.manifolds
        return (self._count, m.end, self._state.position_w, self.axes, self._now.half, self._low, self._high,
                self._grid.ordered, self._level, self._everything, self._margin,
                *self._footing.tables(self._meshes.corners if self._meshes else meshes.NO_CORNERS), m.pair, m.points,
                m.normal_w, m.point_w, m.anchor_w, m.separation, m.feature, m.level)

    def _warm_arguments(self) -> tuple[Any, ...]:
        m = self.manifolds
        return (m.end, m.pair, m.points, m.normal_w, m.point_w, m.feature, m.impulse, m.friction,
                *m.last.arrays())

    def _attend(self, code: int) -> str | None:
        """Makes the broad phase able to go on."""
        low, high, needed = self._low, self._high, int(self._count[NEEDED])
        movers = np.flatnonzero(self._state.is_awake & self._model.bodies.solid)
        again: str | None = "broad phase"
        if code == OTHERS_STAND_STILL:
            self.on_waking()
            self._settle()
        elif code == CROWDED:
            self._grid.think_over(low, high, movers)
            again = None
        else:
            self._grid.renew(code, needed, low, high, movers)
            self._make_room(len(self._grid.ordered[0]))
        self.bind()
        return again

    def _settle(self) -> None:
        """Puts all that is not awake into the grid."""
        bodies, s = self._model.bodies, self._state
        set_all_axes(s.orientation_w, self.axes)
        bounds(s.position_w, self.axes, bodies.half, self._radius, s.velocity_w, self._dt, MARGIN, self._low,
               self._high)
        self._quick[:] = False
        self.sleeping[:] = bodies.movable & ~self._state.is_awake
        self._low[self._planes], self._high[self._planes] = -np.inf, np.inf
        self._high[self._planes, 2] = self._top[self._planes]
        self._grid.settle(self._low, self._high, np.flatnonzero(bodies.solid & ~self._state.is_awake))
        self._binned[:] = s.awake

    def prepare(self) -> None:
        """Gets ready for the levels as they are now. Raises mesh.MeshError for models that cannot be read."""
        bodies = self.levels.mesh_bodies()
        if not np.array_equal(self._with_meshes, bodies):
            self._meshes = meshes.read(self._model, bodies) if len(bodies) else None
            self._with_meshes = bodies
        self._radius = self._ball if self.levels.uses(SPHERE) else np.zeros_like(self._ball)
        self._binned[:] = -1
        self.bind()

    def compile(self) -> None:
        """Compiles what a step may need beside the stages, so that no step has to."""
        nothing = np.empty(0, np.int64)
        pairs = nothing, nothing, np.empty(0), nothing, nothing, np.empty(0)
        self._append_rough(self._now, pairs)
        if self._meshes:
            self.manifolds = self._meshes.find(self.manifolds, self._now, *pairs)
        self._look_ahead(pairs)
        self._impacts.compile(self._state, self._quick, self._meshes)
        self._settle()
        self._binned[:] = -1

    def clear(self) -> None:
        """Forgets the last step."""
        self.manifolds.forget()
        self._binned[:] = -1

    def _more_manifolds(self, code: int) -> str:
        self.manifolds = self.manifolds.with_room(2 * int(self._count[PAIRS]))
        self.bind()
        return "contacts"

    def _more_room(self, code: int) -> str:
        assert self._footing
        if code == MORE_CONTACTS:
            self._footing.grow()
        else:
            self.manifolds = self.manifolds.with_room(MOST * int(self._count[PAIRS]))
        self.bind()
        return "ground contacts"

    def _pairs(self) -> Pairs:
        """Those of the step."""
        k = self._count[PAIRS]
        return (self._grid.ordered[0, :k], self._grid.ordered[1, :k], self._floor_height[:k], self._level[:k],
                self._everything[:k], self._margin[:k])

    def _find_fine(self, code: int) -> None:
        """Appends the contacts of meshes."""
        before = self.manifolds
        self._append_fine(self._now, self._pairs())
        m = self.manifolds
        m.end[MESHES] = m.end[SWEPT]
        anchor(m.end[GROUND], m.count, m.pair, m.points, m.point_w, self._state.position_w, m.anchor_w)
        if m is not before:
            self.bind()

    def _find_ahead(self, code: int) -> None:
        """Appends the contacts that fast bodies will have within the step."""
        before, pairs = self.manifolds, self._pairs()
        self._impacts.keep(self._state)
        self._look_ahead(_only(self._swept[: len(pairs[0])] & (pairs[3] >= SPHERE), pairs))
        if self.manifolds is not before:
            self.bind()

    def _catch(self, code: int) -> None:
        """Stops fast bodies that got through something, whatever the solver made of the contacts ahead."""
        pairs = self._pairs()
        chosen = self._swept[: len(pairs[0])] & (pairs[3] >= SPHERE)
        a, b, _, level, *_ = _only(chosen, pairs)
        self._impacts.catch(self._state, a, b, level, self._quick, self._meshes)

    def _look_ahead(self, pairs: Pairs) -> None:
        placed, meeting = self._impacts.place(self._state, pairs[0], pairs[1], pairs[3], self._meshes)
        a, b, height, level, everything, margin = _only(meeting, pairs)
        margin = margin + 2.0 * np.minimum(self._ball[a], self._ball[b])  # all that may swing round
        k = 2 * np.arange(len(meeting))
        there = k, k + 1, height, level, everything, margin
        first = self.manifolds.count
        self._append_rough(placed, there)
        self._append_fine(placed, there)
        self._impacts.bring_back(self.manifolds, first, placed, self._state)

    def _append_rough(self, placed: PlacedBodies, pairs: Pairs) -> None:
        """Appends the contacts of placed spheres, boxes and floors."""
        m = self.manifolds = self.manifolds.with_room(len(pairs[0]))
        arrays = m.pair, m.points, m.normal_w, m.point_w, m.separation, m.feature, m.level
        pairs = tuple(np.ascontiguousarray(array) for array in pairs)  # type: ignore[assignment]
        a, b, *rest = pairs
        finders: tuple[tuple[Any, tuple[Any, ...]], ...] = (find_boxes, self._scratch), (find_others, ())
        for find, scratch in finders:
            m.count = find(len(a), placed.position, placed.axes, placed.half, a, b, *rest, *scratch, *arrays, m.count)

    def _append_fine(self, placed: PlacedBodies, pairs: Pairs) -> None:
        """Appends the contacts of placed meshes."""
        if self._meshes:
            fine = _only(pairs[3] >= OCTREE, pairs)
            if len(fine[0]):  # most steps have none
                self.manifolds = self._meshes.find(self.manifolds, placed, *fine)

    @property
    def forest(self) -> tuple[Octree, Integers] | None:
        """The octrees, in the frames of their boxes' centres, and the root (n,) of each body's, -1 for none."""
        return None if self._meshes is None else (self._meshes.tree, self._meshes.roots)

    def sectors(self) -> tuple[Floats, Floats]:
        """Lowest corners (k, 3) and edges (k,) in m of the sectors that bodies stand in which can move, each once."""
        moving = self._model.bodies.movable & self._model.bodies.solid
        return self._grid.sectors(self._low[moving], self._high[moving])


def _only(which: Integers | np.ndarray, pairs: Pairs) -> Pairs:
    """Those pairs, by mask or index."""
    a, b, height, level, everything, margin = pairs
    return a[which], b[which], height[which], level[which], everything[which], margin[which]
