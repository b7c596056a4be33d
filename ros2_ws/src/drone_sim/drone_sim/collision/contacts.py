"""Collision detection of a whole step: broad phase, then the contact of each pair."""

import numpy as np

from drone_sim.arrays import Floats, Integers
from drone_sim.collision import floor, grid, manifold, obb
from drone_sim.collision.manifold import Manifolds
from drone_sim.kernel import kernel
from drone_sim.model import Model
from drone_sim.rotation import matrix
from drone_sim.state import State

MARGIN = 0.01  # m; pairs this close are contacts already, so that resting ones do not come and go


@kernel
def axes_of(orientation, axes):
    """Writes the boxes' axes in the world, (n, 3, 3), one a row."""
    for i in range(orientation.shape[0]):
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        for k in range(3):
            axes[i, k, 0], axes[i, k, 1], axes[i, k, 2] = m[k], m[3 + k], m[6 + k]


@kernel
def find_contacts(position, axes, half, velocity, dt, pair_a, pair_b, floor_height, scratch,
                  pair, points, normal, point, separation, feature):
    """Writes the manifolds of the candidate pairs and returns how many; a pair whose floor_height is not NaN is a
    box and a floor. The margin grows by the way that the two approach in a step, so that none is passed through."""
    found = 0
    for k in range(pair_a.shape[0]):
        a, b = pair_a[k], pair_b[k]
        square = 0.0
        for c in range(3):
            square += (velocity[b, c] - velocity[a, c]) ** 2
        margin = MARGIN + dt * np.sqrt(square)
        if np.isnan(floor_height[k]):
            count = obb.contact(position, axes, half, a, position, axes, half, b, margin, normal[found], point[found],
                                separation[found], feature[found], scratch)
        else:
            box, up = (b, 1.0) if half[a, 0] == np.inf else (a, -1.0)
            normal[found, 0], normal[found, 1], normal[found, 2] = 0.0, 0.0, up
            count = floor.contact(position, axes, half, box, floor_height[k], margin, point[found], separation[found],
                                  feature[found])
        if count:
            pair[found, 0], pair[found, 1] = a, b
            points[found] = count
            found += 1
    return found


class Detection:
    """The stage that finds all contacts; `manifolds` are those of the current step."""

    def __init__(self, model: Model, state: State, dt: float) -> None:
        bodies = model.bodies
        self._bodies, self._state, self._dt = bodies, state, dt
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

    def clear(self) -> None:
        """Forgets the last step."""
        self.manifolds.count = 0

    def __call__(self) -> None:
        state, bodies, half = self._state, self._bodies, self._half
        self.manifolds, self._last = self._last, self.manifolds
        axes_of(state.orientation_w, self.axes)
        grid.bounds(state.position_w, self.axes, bodies.half, state.velocity_w, self._dt, MARGIN, self._low, self._high)
        a, b, height = self._candidates()
        if len(a) > self.manifolds.capacity:
            self.manifolds = Manifolds(2 * len(a))
        new, old = self.manifolds, self._last
        new.count = find_contacts(state.position_w, self.axes, half, state.velocity_w, self._dt, a, b, height,
                                  self._scratch, new.pair, new.points, new.normal_w, new.point_w, new.separation,
                                  new.feature)
        manifold.carry_over(new.count, new.pair, new.points, new.feature, new.impulse,
                            old.count, old.pair, old.points, old.feature, old.impulse)

    def sectors(self) -> tuple[Floats, Floats]:
        """Lowest corners (k, 3) and edges (k,) in m of the sectors that bodies stand in which can move, each once."""
        moving = self._bodies.movable & self._bodies.solid
        return self._grid.sectors(self._low[moving], self._high[moving])

    def _candidates(self) -> tuple[Integers, Integers, Floats]:
        """Pairs a < b in order, and the height of the floor where one of the two is a floor, else NaN."""
        a, b = self._grid.pairs(self._low, self._high, self._bodies.solid, self._bodies.movable)
        if not len(self._floor_pairs):
            return a, b, np.full(len(a), np.nan)
        a, b = np.concatenate([a, self._floor_pairs[:, 0]]), np.concatenate([b, self._floor_pairs[:, 1]])
        height = np.concatenate([np.full(len(a) - len(self._floor_heights), np.nan), self._floor_heights])
        order = np.lexsort((b, a))
        return a[order], b[order], height[order]
