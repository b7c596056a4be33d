"""The collision pipeline of a step, as stages: broad phase, then the contacts of each pair at its collision level."""

from collections.abc import Callable

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.box.contacts import find_box_contacts, find_sphere_and_plane_contacts
from drone_engine.collision.box.obb import Boxes, scratch
from drone_engine.collision.broad_phase import grid
from drone_engine.collision.broad_phase.grid import find_pairs, retune_threshold, set_all_bounds, set_bounds
from drone_engine.collision.continuous.impacts import Impacts
from drone_engine.collision.continuous.sweep import needs_ccd
from drone_engine.collision.manifold import (
    BOXES,
    GROUND,
    MESHES,
    OTHERS,
    SWEPT,
    Manifolds,
    keep,
    warm_start,
    write_anchors,
)
from drone_engine.collision.margin import MARGIN, contact_margins, largest_approach
from drone_engine.collision.mesh import narrow
from drone_engine.collision.mesh.contacts import Velocities
from drone_engine.collision.mesh.octree import Octree
from drone_engine.collision.pair_arrays import BodyBounds, Counts, PairArrays
from drone_engine.collision.placement import PlacedBodies, set_all_axes, set_axes
from drone_engine.collision.policy import CollisionPolicy, PolicyTables, look_up
from drone_engine.collision.terrain import height_field
from drone_engine.collision.terrain.stage import MAX_MANIFOLDS, MORE_CONTACTS, Terrain, TerrainArrays, terrain_contacts
from drone_engine.collision_level import OCTREE, SPHERE
from drone_engine.context import Context
from drone_engine.kernel import kernel
from drone_engine.program.program import Program
from drone_engine.program.stage import Stage

REGRID, REBIN, MORE_MANIFOLDS = 10, 11, 12  # return codes of the broad phase, besides those of the grid
STATIC_GRID = ("grid_tables.levels", "grid_tables.static_top", "grid_tables.static_start",
               "grid_tables.static_entry")  # replaced when other bodies are awake than before
CONTACTS = tuple(f"contacts.{name}" for name in (  # that a stage in Python appends
    "end", "pair", "level", "points", "normal", "point", "anchor", "separation", "feature"))
Pairs = tuple[Integers, Integers, Floats, Integers, Integers, Floats]  # a < b, plane height, level, all?, margin


@kernel
def broad_phase(awake, binned, solid, position, orientation, velocity, angular_velocity, dt, body_bounds, policy, ccd,
                movers, grid_tables, pairs, counts):
    """Finds the pairs of bodies that may touch within dt, their collision levels and speculative margins.

    awake, binned: (n + 1,) number and indices of the bodies that are awake, now and when the others were put into the
    grid. Writes the bounds of awake bodies, ccd (n,): whether a body moves so far that it needs continuous collision
    detection, movers (n,): scratch, the pairs, and their counts. Returns 0 or a code that `Detection` handles.
    """
    axes, low, high, half = body_bounds.axes, body_bounds.low, body_bounds.high, body_bounds.half
    radius, plane_height = body_bounds.bounding_radius, body_bounds.plane_height
    counts.pairs[0] = counts.swept[0] = counts.fine[0] = counts.needed[0] = 0
    for k in range(1 + awake[0]):
        if awake[k] != binned[k]:
            return REBIN
    any_ccd, moving = 0, 0
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        set_axes(i, orientation, axes)
        if solid[i]:
            ccd[i] = needs_ccd(i, velocity, angular_velocity, half, dt)
            any_ccd += ccd[i]
            set_bounds(i, position, axes, half, radius if ccd[i] else body_bounds.reach, velocity, dt, MARGIN, low,
                       high)
            movers[moving] = i
            moving += 1
    if moving == 0:
        return 0
    answer, found, tests = find_pairs(low, high, movers, moving, body_bounds.planes, grid_tables)
    if answer == grid.DONE and found > pairs.floor_height.shape[0]:
        answer = grid.MORE_PAIRS
    if answer != grid.DONE:
        counts.needed[0] = found
        return answer
    a, b = grid_tables.ordered[0], grid_tables.ordered[1]
    for k in range(found):
        pairs.floor_height[k] = plane_height[a[k]] if not np.isnan(plane_height[a[k]]) else plane_height[b[k]]
    look_up(found, a, b, policy.default, policy.body_overrides, policy.pair_keys, policy.pair_overrides, pairs.level,
            pairs.all_contacts)
    swept = contact_margins(found, a, b, pairs.floor_height, velocity, angular_velocity, radius, dt, ccd, pairs.margin,
                            pairs.swept)
    for k in range(found):
        counts.fine[0] += pairs.level[k] >= OCTREE
    counts.pairs[0], counts.swept[0] = found, swept if any_ccd else 0
    return REGRID if tests > retune_threshold(moving, found) else 0


@kernel
def primitive_contacts(counts, position, velocity, body_bounds, grid_tables, pairs, box_scratch, contacts):
    """Writes the manifolds of spheres, boxes and planes. Returns MORE_MANIFOLDS if there is no room, else 0."""
    count, c = counts.pairs[0], contacts
    a, b = grid_tables.ordered[0], grid_tables.ordered[1]
    boxes = Boxes(position, body_bounds.axes, body_bounds.half)
    if count > c.points.shape[0]:
        return MORE_MANIFOLDS
    found = find_box_contacts(count, boxes, velocity, a, b, pairs.floor_height, pairs.level, pairs.all_contacts,
                              pairs.margin, box_scratch, c, 0)
    c.end[BOXES] = found
    found = find_sphere_and_plane_contacts(count, boxes, a, b, pairs.floor_height, pairs.level, pairs.all_contacts,
                                           pairs.margin, c, found)
    c.end[OTHERS] = c.end[GROUND] = c.end[MESHES] = c.end[SWEPT] = found
    write_anchors(0, found, c.pair, c.points, c.point, position, c.anchor)
    return 0


@kernel
def any_fine(counts):
    """Asks Python to append the manifolds of meshes, if there are pairs at level octree or triangle: returns their
    number. counts: Counts."""
    return counts.fine[0]


@kernel
def any_swept(counts):
    """Asks Python to treat the pairs with continuous collision detection, if there are any: returns their number.
    counts: Counts."""
    return counts.swept[0]


class Detection:
    """The stages that find all contacts. `manifolds` are those of the last step; `levels` may change between steps."""

    def __init__(self, context: Context) -> None:
        model = context.model
        bodies = model.bodies
        n = bodies.count
        self._model, self._state, self._dt = model, context.state, context.dt
        self.levels = CollisionPolicy(model.collision)
        self.axes: Floats = np.empty((n, 3, 3))
        self.manifolds = Manifolds(64)
        self._grid = grid.Grid(bodies.half[bodies.solid])
        self._grid.reserve(n)
        self._low, self._high = np.empty((2, n, 3))
        self._bounding_radius: Floats = np.linalg.norm(bodies.half, axis=1)
        self._planes: Integers = np.array([plane.body for plane in model.planes], np.int64)
        self._plane_height: Floats = np.full(n, np.nan)
        half = bodies.half.copy()
        half[self._planes] = np.inf
        self._plane_height[self._planes] = [plane.height for plane in model.planes]
        field = height_field.of_model(model)
        self._terrain = None if field is None or model.terrain is None else Terrain(field, model.terrain)
        self._top: Floats = self._plane_height.copy()  # of planes and terrain, m
        if self._terrain:
            self._top[self._terrain.body] = self._terrain.field.grid[height_field.HIGHEST]
        self._now = PlacedBodies(np.arange(n), context.state.position_w, context.state.orientation_w, self.axes, half)
        self._impacts = Impacts(bodies.half, context.dt)
        self.ccd: Booleans = np.zeros(n, np.bool_)
        self.sleeping: Booleans = np.zeros(n, np.bool_)
        self.movers, self.binned = np.empty(n, np.int64), np.full(n + 1, -1)
        self.counts = Counts(*np.zeros((4, 1), np.int64))
        self.box_scratch = scratch()
        self._meshes: narrow.Meshes | None = None
        self._with_meshes: Integers = np.empty(0, np.int64)
        self._program: Program | None = None
        self.on_waking: Callable[[], None] = lambda: None  # called when other bodies are awake than before
        self._make_room(len(self._grid.ordered[0]))
        self.prepare()
        self._share(context)

    def _share(self, context: Context) -> None:
        """Shares the arrays of the pipeline, and makes the stages that take them."""
        scope = context.scope
        scope.share(self.manifolds, contacts="arrays")
        scope.share(self.manifolds.last, previous="arrays")
        scope.share(self, "body_bounds", "policy", "ccd", "pairs", "counts", "sleeping")
        own = scope.child(self, "binned", "movers", "grid_tables", "box_scratch")
        self.keep = Stage("keep", keep, scope)
        self.broad_phase = Stage("broad phase", broad_phase, own, handle=self._handle_broad_phase,
                                 writes=("binned", "sleeping", *STATIC_GRID))
        self._sweep_pairs = Stage("sweep", any_swept, own, handle=self._sweep, writes=("pairs.margin",))
        self.primitives = Stage("contacts", primitive_contacts, own, handle=self._more_manifolds)
        self._terrain_contacts = Stage("ground contacts", terrain_contacts, own.child(self, "terrain"),
                                       handle=self._more_room)
        self._mesh_contacts = Stage("mesh contacts", any_fine, scope, handle=self._find_fine, writes=CONTACTS)
        self._impact_contacts = Stage("impacts", any_swept, scope, handle=self._find_swept, writes=CONTACTS)
        self.warm_start = Stage("warm start", warm_start, scope)
        self.catch = Stage("catch", any_swept, scope, handle=self._catch, writes=("position", "orientation"))

    def _make_room(self, pairs: int) -> None:
        self.pairs = PairArrays(np.empty(pairs), np.empty(pairs, np.int64), np.empty(pairs, np.int64), np.empty(pairs),
                                np.empty(pairs, np.bool_))

    @property
    def stages(self) -> tuple[Stage, ...]:
        """The stages before the motion, in order; a scene without meshes or terrain has none for them."""
        terrain = (self._terrain_contacts,) if self._terrain else ()
        meshes = (self._mesh_contacts,) if self.levels.uses_meshes else ()
        return (self.keep, self.broad_phase, self._sweep_pairs, self.primitives, *terrain, *meshes,
                self._impact_contacts, self.warm_start)

    @property
    def body_bounds(self) -> BodyBounds:
        """Bounds of the bodies, as kernels take them."""
        return BodyBounds(self.axes, self._low, self._high, self._now.half, self._bounding_radius, self._reach,
                          self._plane_height, self._planes)

    @property
    def policy(self) -> PolicyTables:
        """The collision settings of pairs, as kernels take them."""
        return self.levels.tables()

    @property
    def grid_tables(self) -> grid.GridTables:
        """The tables of the broad phase, as kernels take them."""
        return self._grid.tables()

    @property
    def terrain(self) -> TerrainArrays | None:
        """The terrain and the buffers of its contacts, as kernels take them; None without terrain."""
        if self._terrain is None:
            return None
        return self._terrain.arrays(self._meshes.corners if self._meshes else narrow.NO_CORNERS)

    def belong_to(self, program: Program) -> None:
        """Sets the program to bind again when arrays are replaced."""
        self._program = program

    def bind(self) -> None:
        """Binds the program again, since arrays have been replaced."""
        if self._program:
            self._program.bind()

    def _handle_broad_phase(self, code: int) -> Stage | None:
        """Grows or rebuilds whatever stopped the broad phase, and repeats it."""
        low, high, needed = self._low, self._high, int(self.counts.needed[0])
        movers = np.flatnonzero(self._state.is_awake & self._model.bodies.solid)
        again: Stage | None = self.broad_phase
        if code == REBIN:
            self.on_waking()
            self._bin_resting()
        elif code == REGRID:
            self._grid.retune(low, high, movers)
            again = None
        else:
            self._grid.prepare_retry(code, needed, low, high, movers)
            self._make_room(len(self._grid.ordered[0]))
        self.bind()
        return again

    def _bin_resting(self) -> None:
        """Puts the bodies that are not awake into the grid."""
        bodies, s = self._model.bodies, self._state
        set_all_axes(s.orientation_w, self.axes)
        set_all_bounds(s.position_w, self.axes, bodies.half, self._reach, s.velocity_w, self._dt, MARGIN, self._low,
                       self._high)
        self.ccd[:] = False
        self.sleeping[:] = bodies.movable & ~self._state.is_awake
        self._low[self._planes], self._high[self._planes] = -np.inf, np.inf
        self._high[self._planes, 2] = self._top[self._planes]
        self._grid.store_static(self._low, self._high, np.flatnonzero(bodies.solid & ~self._state.is_awake))
        self.binned[:] = s.awake

    def prepare(self) -> None:
        """Prepares for the collision levels as they are now. Raises mesh.MeshError for models that cannot be read."""
        bodies = self.levels.mesh_bodies()
        if not np.array_equal(self._with_meshes, bodies):
            self._meshes = narrow.load_meshes(self._model, bodies) if len(bodies) else None
            self._with_meshes = bodies
        self._reach = self._bounding_radius if self.levels.uses(SPHERE) else np.zeros_like(self._bounding_radius)
        self.binned[:] = -1
        self.bind()

    def compile(self) -> None:
        """Compiles what a step may need besides the stages, so that no step has to wait for it."""
        nothing = np.empty(0, np.int64)
        pairs = nothing, nothing, np.empty(0), nothing, nothing, np.empty(0)
        self._meeting = self._impacts.find_impacts(self._state, nothing, nothing, nothing, self._meshes)
        self._append_primitives(self._now, pairs)
        if self._meshes:
            velocities = Velocities(self._state.velocity_w, self._state.angular_velocity_w, self._dt)
            self._meshes.find(self.manifolds, self._now, velocities, *pairs)
        self._find_ahead(pairs)
        self._impacts.compile(self._state, self.ccd, self._meshes)
        self._bin_resting()
        self.binned[:] = -1

    def clear(self) -> None:
        """Forgets the contacts of the last step."""
        self.manifolds.forget()
        self.binned[:] = -1

    def _more_manifolds(self, code: int) -> Stage:
        self.manifolds.reserve(2 * int(self.counts.pairs[0]))
        self.bind()
        return self.primitives

    def _more_room(self, code: int) -> Stage:
        assert self._terrain
        if code == MORE_CONTACTS:
            self._terrain.grow()
        else:
            self.manifolds.reserve(MAX_MANIFOLDS * int(self.counts.pairs[0]))
        self.bind()
        return self._terrain_contacts

    def _pairs(self) -> Pairs:
        """The pairs of the step."""
        k, p = self.counts.pairs[0], self.pairs
        return (self._grid.ordered[0, :k], self._grid.ordered[1, :k], p.floor_height[:k], p.level[:k],
                p.all_contacts[:k], p.margin[:k])

    def _find_fine(self, code: int) -> None:
        """Appends the contacts of meshes."""
        m, capacity = self.manifolds, self.manifolds.capacity
        self._append_meshes(self._now, self._pairs())
        m.end[MESHES] = m.end[SWEPT]
        write_anchors(m.end[GROUND], m.count, m.pair, m.points, m.point_w, self._state.position_w, m.anchor_w)
        if m.capacity != capacity:
            self.bind()

    def _swept(self) -> Pairs:
        """The pairs with continuous collision detection."""
        return _only(self._swept_rows(), self._pairs())

    def _swept_rows(self) -> Integers:
        """The numbers of these pairs."""
        k = self.counts.pairs[0]
        return np.flatnonzero(self.pairs.swept[:k] & (self.pairs.level[:k] >= SPHERE))

    def _sweep(self, code: int) -> None:
        """Finds when the pairs with continuous collision detection touch within the step. Those that touch at its
        start may go on to touch elsewhere: their margins cover all of their motion."""
        s, pairs = self._state, self._swept()
        self._impacts.save_poses(s)
        self._meeting = self._impacts.find_impacts(s, pairs[0], pairs[1], pairs[3], self._meshes)
        a, b, touching = pairs[0], pairs[1], self._meeting.touching
        self.pairs.margin[self._swept_rows()[touching]] += largest_approach(
            s.velocity_w, s.angular_velocity_w, self._bounding_radius, a[touching], b[touching], self._dt)

    def _find_swept(self, code: int) -> None:
        """Appends the contacts of bodies with continuous collision detection that will touch within the step."""
        capacity = self.manifolds.capacity
        self._find_ahead(self._swept())
        if self.manifolds.capacity != capacity:
            self.bind()

    def _catch(self, code: int) -> None:
        """Moves bodies that tunneled through something back, whatever the solver did with their contacts."""
        a, b, _, level, *_ = self._swept()
        self._impacts.stop_at_impacts(self._state, a, b, level, self.ccd, self._meshes)

    def _find_ahead(self, pairs: Pairs) -> None:
        """Appends the contacts of pairs at the poses in which they will first touch within the step."""
        placed, meeting = self._impacts.bodies_at_impact(self._state, pairs[0], pairs[1], self._meeting)
        a, b, height, level, everything, margin = _only(meeting, pairs)
        s = self._state
        margin = margin + largest_approach(s.velocity_w, s.angular_velocity_w, self._bounding_radius, a, b, self._dt)
        k = 2 * np.arange(len(meeting))
        there = k, k + 1, height, level, everything, margin
        first = self.manifolds.count
        self._append_primitives(placed, there)
        self._append_meshes(placed, there)
        self._impacts.move_to_step_start(self.manifolds, first, placed, self._state)

    def _append_primitives(self, placed: PlacedBodies, pairs: Pairs) -> None:
        """Appends the contacts of placed spheres, boxes and floors."""
        m = self.manifolds.reserve(len(pairs[0]))
        boxes, arrays = Boxes(placed.position, placed.axes, placed.half), m.arrays
        a, b, height, level, all_contacts, margin = (np.ascontiguousarray(array) for array in pairs)
        velocity = self._state.velocity_w[placed.body]
        m.count = find_box_contacts(len(a), boxes, velocity, a, b, height, level, all_contacts, margin,
                                    self.box_scratch, arrays, m.count)
        m.count = find_sphere_and_plane_contacts(len(a), boxes, a, b, height, level, all_contacts, margin, arrays,
                                                 m.count)

    def _append_meshes(self, placed: PlacedBodies, pairs: Pairs) -> None:
        """Appends the contacts of placed meshes."""
        if self._meshes:
            fine = _only(pairs[3] >= OCTREE, pairs)
            if len(fine[0]):  # most steps have none
                s = self._state
                now = placed is self._now
                linear, angular = ((s.velocity_w, s.angular_velocity_w) if now else
                                   (s.velocity_w[placed.body], s.angular_velocity_w[placed.body]))
                self._meshes.find(self.manifolds, placed, Velocities(linear, angular, self._dt, not now), *fine)

    @property
    def forest(self) -> tuple[Octree, Integers] | None:
        """The octrees, in the frames of their boxes' centres, and the root (n,) of each body's, -1 for none."""
        return None if self._meshes is None else (self._meshes.tree, self._meshes.roots)

    def sectors(self) -> tuple[Floats, Floats]:
        """Lowest corners (k, 3) and edges (k,) in m of the sectors that bodies stand in which can move, each once."""
        moving = self._model.bodies.movable & self._model.bodies.solid
        return self._grid.occupied_cells(self._low[moving], self._high[moving])


def _only(which: Integers | np.ndarray, pairs: Pairs) -> Pairs:
    """Those pairs, by mask or index."""
    a, b, height, level, everything, margin = pairs
    return a[which], b[which], height[which], level[which], everything[which], margin[which]
