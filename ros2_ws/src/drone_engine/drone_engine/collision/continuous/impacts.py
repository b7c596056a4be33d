"""Contacts of fast bodies: found ahead, at the poses in which they will meet within the step."""

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.continuous import sweep
from drone_engine.collision.continuous.advancement import NONE
from drone_engine.collision.manifold import Manifolds
from drone_engine.collision.mesh import octree
from drone_engine.collision.mesh.narrow import Meshes
from drone_engine.collision.placement import PlacedBodies, set_all_axes
from drone_engine.kernel import kernel
from drone_engine.math.rotation import integrate_rotation, rotate
from drone_engine.state import State


@kernel
def advance(body, time, position, orientation, velocity, spin, out_position, out_orientation):
    """Writes where each of bodies (k,) will be after its time, s."""
    for i in range(body.shape[0]):
        b, t = body[i], time[i]
        for c in range(3):
            out_position[i, c] = position[b, c] + velocity[b, c] * t
        q = integrate_rotation(orientation[b, 0], orientation[b, 1], orientation[b, 2], orientation[b, 3],
                               spin[b, 0], spin[b, 1], spin[b, 2], t)
        for c in range(4):
            out_orientation[i, c] = q[c]


@kernel
def bring_back(first, count, pair, points, normal, point, anchor, separation, body, ahead, turn_ahead, position,
               orientation):
    """Takes manifolds first to count, found among bodies placed `ahead`, back to the start of the step: anchors turn
    back with their bodies, and the separation becomes that of the anchors now. pair: rows of body, then bodies."""
    for i in range(first, count):
        for k in range(points[i]):
            for side in range(2):
                row = pair[i, side]
                b = body[row]
                p, q = turn_ahead[row], orientation[b]
                x, y, z = (point[i, k, 0] - ahead[row, 0], point[i, k, 1] - ahead[row, 1],
                           point[i, k, 2] - ahead[row, 2])
                x, y, z = rotate(-p[0], -p[1], -p[2], p[3], x, y, z)
                anchor[i, k, side, 0], anchor[i, k, side, 1], anchor[i, k, side, 2] = rotate(
                    q[0], q[1], q[2], q[3], x, y, z)
                sign = -1.0 if side == 1 else 1.0
                for c in range(3):
                    way = point[i, k, c] - position[b, c] - anchor[i, k, side, c]
                    separation[i, k] += sign * normal[i, c] * way
        for side in range(2):
            pair[i, side] = body[pair[i, side]]


@kernel
def turn_between(q, p):
    """The rotation vector, rad in the world, that takes orientation q to p."""
    x, y, z, w = (p[0] * q[3] - p[3] * q[0] - p[1] * q[2] + p[2] * q[1],
                  p[1] * q[3] - p[3] * q[1] - p[2] * q[0] + p[0] * q[2],
                  p[2] * q[3] - p[3] * q[2] - p[0] * q[1] + p[1] * q[0],
                  p[3] * q[3] + p[0] * q[0] + p[1] * q[1] + p[2] * q[2])
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    sine = np.sqrt(x * x + y * y + z * z)
    factor = 2.0 * np.arctan2(sine, w) / sine if sine > 1e-12 else 2.0
    return factor * x, factor * y, factor * z


class Impacts:
    """Finds when fast bodies meet, with its buffers."""

    def __init__(self, half: Floats, dt: float) -> None:
        """half: (n, 3) half extents of the boxes, m."""
        self._half, self._dt = half, dt
        self._room = sweep.room()

    def compile(self, state: State, quick: Booleans, meshes: Meshes | None) -> None:
        """Compiles what only a step with fast bodies needs."""
        nothing = np.empty(0, np.int64)
        self.keep(state)
        self.catch(state, nothing, nothing, nothing, quick, meshes)
        for orientation in state.orientation_w[:1]:
            turn_between(orientation, orientation)

    def place(self, state: State, pair_a: Integers, pair_b: Integers, level: Integers,
              meshes: Meshes | None) -> tuple[PlacedBodies, Integers]:
        """Of the pairs (k,) those that meet, (m,), and their bodies where they do: rows 0 and 1 of the first pair, 2
        and 3 of the second, and so on."""
        time, outcome = self._times(pair_a, pair_b, level, state.position_w, state.orientation_w, state.velocity_w,
                                    state.angular_velocity_w, self._half, meshes)
        meeting = np.flatnonzero((outcome != NONE) & (time > 0.0))
        body = np.stack([pair_a[meeting], pair_b[meeting]], axis=1).ravel()
        position, orientation = np.empty((len(body), 3)), np.empty((len(body), 4))
        advance(body, np.repeat(time[meeting] * self._dt, 2), state.position_w, state.orientation_w, state.velocity_w,
                state.angular_velocity_w, position, orientation)
        axes = np.empty((len(body), 3, 3))
        set_all_axes(orientation, axes)
        return PlacedBodies(body, position, orientation, axes, self._half[body]), meeting

    def keep(self, state: State) -> None:
        """Notes where all bodies are."""
        self._before = state.position_w.copy(), state.orientation_w.copy()

    def catch(self, state: State, pair_a: Integers, pair_b: Integers, level: Integers, quick: Booleans,
              meshes: Meshes | None) -> None:
        """Takes quick bodies of the pairs (k,) back to where they met, if the way from where they were noted leads
        through something: what is left of the step they wait. Of two bodies that meet both are taken back."""
        position, orientation = self._before
        way = (state.position_w - position) / self._dt
        spin = np.zeros_like(way)
        for i in np.unique(np.concatenate([pair_a, pair_b])):
            spin[i] = np.array(turn_between(orientation[i], state.orientation_w[i])) / self._dt
        moved = position, orientation, way, spin
        time, outcome = self._times(pair_a, pair_b, level, *moved, self._half, meshes)
        first = np.ones(len(position))
        # What touched before has to keep its middle on the side where it was.
        close = np.flatnonzero((outcome != NONE) & (time <= 0.0))
        if len(close):
            middles = np.where(quick[:, None], 0.0, self._half)
            _, through = self._times(pair_a[close], pair_b[close], level[close], *moved, middles, meshes, quick)
            outcome[close] = through
        hit = outcome != NONE
        for body in (pair_a[hit], pair_b[hit]):
            np.minimum.at(first, body, time[hit])
        caught = np.flatnonzero((first < 1.0) & quick)
        place, turn = np.empty((len(caught), 3)), np.empty((len(caught), 4))
        advance(caught, first[caught] * self._dt, position, orientation, way, spin, place, turn)
        state.position_w[caught], state.orientation_w[caught] = place, turn

    def _times(self, pair_a: Integers, pair_b: Integers, level: Integers, position: Floats, orientation: Floats,
               velocity: Floats, spin: Floats, half: Floats, meshes: Meshes | None,
               boxes: Booleans | None = None) -> tuple[Floats, Integers]:
        """When pairs (k,) that move so meet, as a part of the step, and whether; boxes: (n,) those without a mesh."""
        time, outcome = np.empty(len(pair_a)), np.empty(len(pair_a), np.int64)
        box, link, corners, *_ = meshes.tree if meshes else octree.EMPTY
        roots = meshes.roots if meshes else np.full(len(half), -1)
        if boxes is not None:
            roots = np.where(boxes, -1, roots)
        sweep.sweep_pairs(pair_a, pair_b, position, orientation, velocity, spin, half, level, roots, box, link,
                          corners, self._dt, time, outcome, *self._room)
        return time, outcome

    def bring_back(self, m: Manifolds, first: int, placed: PlacedBodies, state: State) -> None:
        """Turns the contacts of the placed bodies, from number `first` on, into contacts ahead of where they are."""
        bring_back(first, m.count, m.pair, m.points, m.normal_w, m.point_w, m.anchor_w, m.separation,
                   placed.body, placed.position, placed.orientation, state.position_w, state.orientation_w)
