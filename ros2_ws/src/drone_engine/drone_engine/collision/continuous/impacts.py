"""Continuous collision detection (CCD) of fast bodies within a step.

Contacts of fast bodies are found ahead of time: at the poses at which they will touch within the step. After the
motion, a body that got through something nevertheless is moved back to its time of impact.
"""

from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.continuous import sweep
from drone_engine.collision.continuous.advancement import NO_IMPACT
from drone_engine.collision.manifold import Manifolds
from drone_engine.collision.mesh import octree
from drone_engine.collision.mesh.narrow import Meshes
from drone_engine.collision.placement import PlacedBodies, set_all_axes
from drone_engine.kernel import kernel
from drone_engine.math.rotation import integrate_rotation, rotate
from drone_engine.state import State


@kernel
def advance_poses(body, time, position, orientation, velocity, angular_velocity, out_position, out_orientation):
    """Writes the poses of bodies (k,) after their times (k,), s, at constant velocities.

    position, velocity, angular_velocity: (n, 3); orientation: (n, 4) x y z w; out_position: (k, 3); out_orientation:
    (k, 4). World frame.
    """
    for i in range(body.shape[0]):
        b, t = body[i], time[i]
        for c in range(3):
            out_position[i, c] = position[b, c] + velocity[b, c] * t
        q = integrate_rotation(orientation[b, 0], orientation[b, 1], orientation[b, 2], orientation[b, 3],
                               angular_velocity[b, 0], angular_velocity[b, 1], angular_velocity[b, 2], t)
        for c in range(4):
            out_orientation[i, c] = q[c]


@kernel
def shift_to_step_start(first, count, pair, points, normal, point, anchor, separation, body, later_position,
                        later_orientation, position, orientation):
    """Converts manifolds `first` to `count`, found at later poses of their bodies, to the poses at the start of the
    step: anchors rotate back with their bodies, and separations become those of the anchors at the start.

    pair: (k, 2) rows of `body` on input, bodies on output. points .. separation: arrays of Manifolds. body: (m,), with
    later_position (m, 3) and later_orientation (m, 4), the poses of the contacts. position (n, 3), orientation (n, 4):
    the poses at the start of the step. World frame.
    """
    for i in range(first, count):
        for k in range(points[i]):
            for side in range(2):
                row = pair[i, side]
                b = body[row]
                p, q = later_orientation[row], orientation[b]
                x, y, z = (point[i, k, 0] - later_position[row, 0], point[i, k, 1] - later_position[row, 1],
                           point[i, k, 2] - later_position[row, 2])
                x, y, z = rotate(-p[0], -p[1], -p[2], p[3], x, y, z)
                anchor[i, k, side, 0], anchor[i, k, side, 1], anchor[i, k, side, 2] = rotate(
                    q[0], q[1], q[2], q[3], x, y, z)
                sign = -1.0 if side == 1 else 1.0
                for c in range(3):
                    offset = point[i, k, c] - position[b, c] - anchor[i, k, side, c]
                    separation[i, k] += sign * normal[i, c] * offset
        for side in range(2):
            pair[i, side] = body[pair[i, side]]


@kernel
def rotation_vector(q, p):
    """The rotation vector (x, y, z), rad in the world, from orientation q to orientation p, of at most half a turn;
    unit quaternions x y z w."""
    x, y, z, w = (p[0] * q[3] - p[3] * q[0] - p[1] * q[2] + p[2] * q[1],
                  p[1] * q[3] - p[3] * q[1] - p[2] * q[0] + p[0] * q[2],
                  p[2] * q[3] - p[3] * q[2] - p[0] * q[1] + p[1] * q[0],
                  p[3] * q[3] + p[0] * q[0] + p[1] * q[1] + p[2] * q[2])
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    sine = np.sqrt(x * x + y * y + z * z)
    factor = 2.0 * np.arctan2(sine, w) / sine if sine > 1e-12 else 2.0
    return factor * x, factor * y, factor * z


class Meetings(NamedTuple):
    """When pairs of bodies touch within a step, by their indices."""

    touching: Integers  # (t,) that touch at the start
    ahead: Integers  # (m,) that will touch later
    time: Floats  # (m,) s, when these do


class Impacts:
    """CCD of fast bodies, with its buffers."""

    def __init__(self, half: Floats, dt: float) -> None:
        """half: (n, 3) half extents of the bodies' boxes, m; dt: length of a step, s."""
        self._half, self._dt = half, dt
        self._scratch = sweep.scratch()

    def compile(self, state: State, ccd: Booleans, meshes: Meshes | None) -> None:
        """Compiles the kernels that only a step with fast bodies calls."""
        nothing = np.empty(0, np.int64)
        self.save_poses(state)
        self.stop_at_impacts(state, nothing, nothing, nothing, ccd, meshes)
        for orientation in state.orientation_w[:1]:
            rotation_vector(orientation, orientation)

    def find_impacts(self, state: State, pair_a: Integers, pair_b: Integers, level: Integers,
                     meshes: Meshes | None) -> "Meetings":
        """Which of the pairs (k,) touch at the start of the step, and which will within it, and when."""
        time, outcome = self._times_of_impact(pair_a, pair_b, level, state.position_w, state.orientation_w,
                                              state.velocity_w, state.angular_velocity_w, self._half, meshes)
        hit = outcome != NO_IMPACT
        ahead = np.flatnonzero(hit & (time > 0.0))
        return Meetings(np.flatnonzero(hit & (time <= 0.0)), ahead, time[ahead] * self._dt)

    def bodies_at_impact(self, state: State, pair_a: Integers, pair_b: Integers,
                         meetings: "Meetings") -> tuple[PlacedBodies, Integers]:
        """The bodies of pairs that will touch within the step, at the poses at which they will, and these pairs.

        pair_a, pair_b: (k,); meetings: as found for them. Returns the bodies (rows 0 and 1 are the first pair, 2 and 3
        the second, and so on) and the indices (m,) of their pairs.
        """
        body = np.stack([pair_a[meetings.ahead], pair_b[meetings.ahead]], axis=1).ravel()
        position, orientation = np.empty((len(body), 3)), np.empty((len(body), 4))
        advance_poses(body, np.repeat(meetings.time, 2), state.position_w, state.orientation_w, state.velocity_w,
                      state.angular_velocity_w, position, orientation)
        axes = np.empty((len(body), 3, 3))
        set_all_axes(orientation, axes)
        return PlacedBodies(body, position, orientation, axes, self._half[body]), meetings.ahead

    def save_poses(self, state: State) -> None:
        """Saves the poses of all bodies, for `stop_at_impacts`."""
        self._before = state.position_w.copy(), state.orientation_w.copy()

    def stop_at_impacts(self, state: State, pair_a: Integers, pair_b: Integers, level: Integers, ccd: Booleans,
                        meshes: Meshes | None) -> None:
        """Moves CCD bodies of the pairs (k,) back to their times of impact if their way from the saved poses leads
        through something; they hold that pose for the rest of the step. Of two CCD bodies both are moved back.

        ccd: (n,) whether a body needs CCD. Changes the poses in `state`.
        """
        position, orientation = self._before
        velocity = (state.position_w - position) / self._dt
        angular_velocity = np.zeros_like(velocity)
        for i in np.unique(np.concatenate([pair_a, pair_b])):
            angular_velocity[i] = np.array(rotation_vector(orientation[i], state.orientation_w[i])) / self._dt
        motion = position, orientation, velocity, angular_velocity
        time, outcome = self._times_of_impact(pair_a, pair_b, level, *motion, self._half, meshes)
        first = np.ones(len(position))
        # A pair that touched at the start may go on touching, but the center of a CCD body must stay on its side; one
        # that begins on the surface has no side.
        close = np.flatnonzero((outcome != NO_IMPACT) & (time <= 0.0))
        if len(close):
            extents = np.where(ccd[:, None], 0.0, self._half)
            time[close], outcome[close] = self._times_of_impact(pair_a[close], pair_b[close], level[close], *motion,
                                                                extents, meshes, ccd)
        hit = (outcome != NO_IMPACT) & (time > 0.0)
        for bodies in (pair_a[hit], pair_b[hit]):
            np.minimum.at(first, bodies, time[hit])
        body = np.flatnonzero((first < 1.0) & ccd)
        position_then, orientation_then = np.empty((len(body), 3)), np.empty((len(body), 4))
        advance_poses(body, first[body] * self._dt, *motion, position_then, orientation_then)
        state.position_w[body], state.orientation_w[body] = position_then, orientation_then

    def _times_of_impact(self, pair_a: Integers, pair_b: Integers, level: Integers, position: Floats,
                         orientation: Floats, velocity: Floats, angular_velocity: Floats, half: Floats,
                         meshes: Meshes | None, boxes: Booleans | None = None) -> tuple[Floats, Integers]:
        """Times of impact of the pairs (k,) as fractions of the step, and outcomes.

        boxes: (n,) bodies that count as boxes of these extents although they have a mesh.
        """
        time, outcome = np.empty(len(pair_a)), np.empty(len(pair_a), np.int64)
        roots = meshes.roots if meshes else np.full(len(half), -1)
        if boxes is not None:
            roots = np.where(boxes, -1, roots)
        sweep.sweep_pairs(pair_a, pair_b, position, orientation, velocity, angular_velocity, half, level, roots,
                          meshes.tree if meshes else octree.EMPTY, self._dt, time, outcome, self._scratch)
        return time, outcome

    def move_to_step_start(self, m: Manifolds, first: int, placed: PlacedBodies, state: State) -> None:
        """Converts the manifolds from number `first` on, found among the placed bodies, to the poses at the start of
        the step: their separations become the distances that the points still have to travel."""
        shift_to_step_start(first, m.count, m.pair, m.points, m.normal_w, m.point_w, m.anchor_w, m.separation,
                            placed.body, placed.position, placed.orientation, state.position_w, state.orientation_w)
