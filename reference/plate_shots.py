"""Shots of a 5 cm cube at a 1 cm plate: 1 to 1000 m/s, any direction and angular velocity, 30 steps per second."""

import numpy as np

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.continuous import sweep
from drone_engine.collision.continuous.advancement import IMPACT
from drone_engine.collision.mesh import octree
from drone_engine.math.poses import inverse, rotate_all

DT = 1 / 30
CUBE, PLATE = np.full(3, 0.025), np.array([1.0, 1.0, 0.005])
FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
         (1, 5, 7), (1, 7, 3)]
FOREST, ROOTS = octree.join([octree.build(half * [(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], FACES)
                             for half in (CUBE, PLATE)])


def unit(vectors: Floats) -> Floats:
    """Vectors divided by their length, along the last axis."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def shots_through(count: int, level: int, seed: int = 0) -> int:
    """The number of shots that continuous collision detection does not stop in front of the plate.

    count: shots at random points of the plate; level: collision level. A shot counts as stopped only if the cube does
    not overlap the plate afterwards.
    """
    rng = np.random.default_rng(seed)
    direction = unit(rng.normal(size=(count, 3)))
    speed, angular_speed = 10 ** rng.uniform(0, 3, count), 10 ** rng.uniform(-1, 3, count)
    plate_q, plate = unit(rng.normal(size=(count, 4))), rng.uniform(-5, 5, (count, 3))
    flat = rotate_all(inverse(plate_q), direction)
    aim = np.column_stack([rng.uniform(-0.9, 0.9, (count, 2)), np.zeros(count)])
    # Starts clear of the plate, plus a distance of up to two steps.
    clear = np.minimum(0.06 / np.abs(flat[:, 2]), 3.0) + speed * DT * rng.uniform(0, 2, count)
    position = plate + rotate_all(plate_q, aim) - direction * clear[:, None]
    q, angular_velocity = unit(rng.normal(size=(count, 4))), unit(rng.normal(size=(count, 3))) * angular_speed[:, None]
    side = np.sign(-flat[:, 2])
    through, active = np.zeros(count, bool), np.arange(count)
    for _ in range(100):  # 3.3 m at the lowest speed
        impact, time = _step(position[active], q[active], plate[active], plate_q[active],
                             direction[active] * speed[active, None], angular_velocity[active], level)
        position[active] += direction[active] * (speed[active] * DT * time)[:, None]
        q[active] = _turned(q[active], angular_velocity[active], DT * time)
        through[active] = _past(position[active], q[active], plate[active], plate_q[active], side[active])
        active = active[~impact & ~through[active]]
    return int(through.sum()) + len(active)


def _step(position: Floats, q: Floats, plate: Floats, plate_q: Floats, velocity: Floats, angular_velocity: Floats,
          level: int) -> tuple[Booleans, Floats]:
    """Whether each cube hits its plate within the step, and the time of impact in steps."""
    n = len(position)
    zero, pairs = np.zeros((n, 3)), np.column_stack([np.arange(n), np.arange(n, 2 * n)])
    half = np.repeat([CUBE, PLATE], n, axis=0)
    impacts = sweep.times_of_impact(pairs, np.vstack([position, plate]), np.vstack([q, plate_q]),
                                    np.vstack([velocity, zero]), np.vstack([angular_velocity, zero]), half, DT,
                                    level, FOREST, np.repeat(ROOTS, n))
    return impacts.outcome == IMPACT, impacts.time


def _turned(q: Floats, angular_velocity: Floats, t: Floats) -> Floats:
    """Quaternions (n, 4) after rotation at `angular_velocity` (n, 3) rad/s for t (n,) s."""
    speed = np.linalg.norm(angular_velocity, axis=1)
    axis, half = angular_velocity / speed[:, None], 0.5 * speed * t
    v, w = np.sin(half)[:, None] * axis, np.cos(half)[:, None]
    return np.column_stack([w * q[:, :3] + q[:, 3:] * v + np.cross(v, q[:, :3]),
                            w * q[:, 3:] - (v * q[:, :3]).sum(1, keepdims=True)])


def _past(position: Floats, q: Floats, plate: Floats, plate_q: Floats, side: Floats) -> Booleans:
    """Whether the cube overlaps the plate, or its center has passed through it."""
    n = len(position)
    cube, wall = (np.stack([rotate_all(rotation, np.broadcast_to(e, (n, 3))) for e in np.eye(3)], 1)
                  for rotation in (q, plate_q))
    edges = np.cross(cube[:, :, None], wall[:, None]).reshape(n, 9, 3)
    axes = np.concatenate([cube, wall, edges / np.maximum(np.linalg.norm(edges, axis=2, keepdims=True), 1e-12)], 1)
    reach = np.abs(axes @ cube.transpose(0, 2, 1)) @ CUBE + np.abs(axes @ wall.transpose(0, 2, 1)) @ PLATE
    offset = position - plate
    separation = (np.abs((axes * offset[:, None]).sum(2)) - reach).max(1)
    x, y, z = (wall * offset[:, None]).sum(2).T
    return np.asarray((separation <= 0.0) | ((z * side < 0.0) & (np.abs(x) < PLATE[0]) & (np.abs(y) < PLATE[1])))
