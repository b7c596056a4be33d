"""Times of impact against closed forms and against the separation sampled finely along the way."""

import math

import numpy as np
import pytest

from drone_engine.collision.continuous import sweep
from drone_engine.collision.continuous.advancement import (
    IMPACT,
    IMPACT_TOLERANCE,
    MAX_ITERATIONS,
    NO_IMPACT,
    box_time_of_impact,
    relative_motion,
)
from drone_engine.collision.mesh import octree
from drone_engine.collision_level import OBB, OCTREE, SPHERE, TRIANGLE
from drone_engine.math.rotation import integrate_rotation, matrix
from reference import shapes

DT = 1 / 30
STILL = np.zeros((2, 3))
LEVEL_QUATERNION = np.array([[0, 0, 0, 1.0], [0, 0, 0, 1.0]])


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def target_of(half: np.ndarray) -> float:
    return sweep.TARGET_FRACTION * float(np.linalg.norm(half, axis=1).min())


def target_of_meshes(boxes: np.ndarray) -> float:
    """The target of two bodies with octrees, from the boxes (2, 6) of their roots."""
    return sweep.TARGET_FRACTION * min(float(np.linalg.norm(box[:3]) + np.linalg.norm(box[3:])) for box in boxes)


def axes(q: np.ndarray, w: np.ndarray, t: float) -> np.ndarray:
    """The axes of a box after a rotation for t s, one a row."""
    return np.array(matrix(*integrate_rotation(*q, *w, t))).reshape(3, 3).T


def separation(position: np.ndarray, q: np.ndarray, velocity: np.ndarray, w: np.ndarray, half: np.ndarray,
               t: float) -> float:
    """The largest separation over the fifteen axes, of boxes 0 and 1 after t s."""
    a, b = axes(q[0], w[0], t), axes(q[1], w[1], t)
    lines = np.vstack([a, b, np.cross(a[:, None], b[None]).reshape(9, 3)])
    lines = unit(lines[np.linalg.norm(lines, axis=1) > 1e-9])
    apart = lines @ (position[1] - position[0] + (velocity[1] - velocity[0]) * t)
    return float((np.abs(apart) - np.abs(lines @ a.T) @ half[0] - np.abs(lines @ b.T) @ half[1]).max())


def scene(rng: np.random.Generator, spin: float) -> tuple[np.ndarray, ...]:
    """Two boxes that move roughly towards each other: position, orientation, velocity, angular velocity, half."""
    half = 10 ** rng.uniform(-2, 0, (2, 3))
    way = unit(rng.normal(size=3)) * (np.linalg.norm(half, axis=1).sum() + rng.uniform(0, 1))
    position = np.array([way, rng.normal(size=3) * 0.1]) + rng.normal(size=3)
    velocity = np.array([-way * rng.uniform(0.5, 2) / DT, np.zeros(3)]) + rng.normal(size=(1, 3))
    return position, unit(rng.normal(size=(2, 4))), velocity, unit(rng.normal(size=(2, 3))) * spin, half


def time(position: np.ndarray, q: np.ndarray, velocity: np.ndarray, w: np.ndarray, half: np.ndarray,
         level: int = OBB, dt: float = DT, **tree: object) -> tuple[float, int]:
    """The time of impact of bodies 0 and 1, as a fraction of dt, and the outcome."""
    impacts = sweep.times_of_impact([[0, 1]], position, q, velocity, w, half, dt, level, **tree)
    return float(impacts.time[0]), int(impacts.outcome[0])


def test_spheres_meet_when_the_closed_form_says() -> None:
    half = np.array([[1, 1, 1], [2, 2, 2]]) / math.sqrt(3)
    for offset in (0.0, 1.5):
        position, velocity = np.array([[0, 0, 0], [7, offset, 0]]), np.array([[3, 0, 0], [-3, 0, 0]])
        at, outcome = time(position, LEVEL_QUATERNION, velocity, STILL, half, SPHERE, 1.0)
        assert at == pytest.approx((7 - math.sqrt((3 + target_of(half)) ** 2 - offset**2)) / 6, abs=1e-9)
        assert outcome == IMPACT
    beside = np.array([[0, 0, 0], [7, 3.1, 0]])
    assert time(beside, LEVEL_QUATERNION, velocity, STILL, half, SPHERE, 1.0) == (1.0, NO_IMPACT)
    assert time(position, LEVEL_QUATERNION, -velocity, STILL, half, SPHERE, 1.0) == (1.0, NO_IMPACT)


@pytest.mark.parametrize("shift", [0.0, 1e6])
@pytest.mark.parametrize("speed", [1.0, 30.0, 1000.0])
def test_a_cube_meets_a_plate_when_the_gap_is_covered(speed: float, shift: float) -> None:
    half = np.array([[0.025, 0.025, 0.025], [1, 1, 0.005]])
    position = np.array([[0.1, 0.2, 0.04], [0, 0, 0]]) + shift
    at, outcome = time(position, LEVEL_QUATERNION, np.array([[0.3, 0, -speed], [0, 0, 0]]), STILL, half)
    gap = position[0, 2] - position[1, 2] - 0.03 - target_of(half)
    assert outcome == IMPACT
    assert at * DT == pytest.approx(gap / speed, abs=1e-9 if shift == 0.0 else 1e-6 / speed)


@pytest.mark.parametrize("half", [[[0, 0, 0], [1, 1, 0]], [[0, 0, 0.5], [1, 0, 0]], [[1e-6] * 3, [1e3, 1e3, 1e-6]],
                                  [[0, 0, 0], [0, 0, 0]]], ids=["point", "rods", "speck", "points"])
@pytest.mark.parametrize("spin", [0.0, 50.0])
def test_flat_and_tiny_bodies_are_stopped(half: list[list[float]], spin: float) -> None:
    """The spin is about the z axis, the long axis of the rod."""
    position, w = np.array([[0, 0, 1.7], [0, 0, 0]]), np.array([[0, 0, spin], [0, 0, 0]])
    at, outcome = time(position, LEVEL_QUATERNION, np.array([[0, 0, -300], [0, 0, 0]]), w, np.array(half))
    way = 1.7 - half[0][2] - half[1][2]
    near = 1.25 * target_of(np.array(half)) + 1e-9
    assert outcome == IMPACT
    assert way - near <= at * DT * 300 <= way


def test_bodies_that_touch_at_the_start_meet_at_time_zero() -> None:
    half = np.full((2, 3), 0.5)
    position, velocity = np.array([[0, 0, 0], [0.9, 0, 0]]), np.array([[50, 0, 0], [0, 0, 0]])
    assert time(position, LEVEL_QUATERNION, velocity, STILL, half) == (0.0, IMPACT)


def test_boxes_that_only_translate_meet_when_the_last_axis_closes() -> None:
    rng = np.random.default_rng(1)
    met = 0
    for _ in range(400):
        position, q, velocity, w, half = scene(rng, 0.0)
        a, b = axes(q[0], w[0], 0), axes(q[1], w[1], 0)
        lines = unit(np.vstack([a, b, np.cross(a[:, None], b[None]).reshape(9, 3)]))
        room = np.abs(lines @ a.T) @ half[0] + np.abs(lines @ b.T) @ half[1] + target_of(half)
        gap, speed = lines @ (position[1] - position[0]), lines @ (velocity[1] - velocity[0])
        first, last = np.sort([(-room - gap) / speed, (room - gap) / speed], axis=0)
        enters, leaves = max(first.max(), 0.0), last.min()
        expected = enters / DT if enters <= leaves and enters < DT else 1.0
        at, outcome = time(position, q, velocity, w, half)
        assert at <= expected + 1e-9
        if outcome == IMPACT and expected == 1.0:  # a grazing contact: between one target and IMPACT_TOLERANCE targets
            assert separation(position, q, velocity, w, half, at * DT) < 1.26 * target_of(half)
        else:
            grazes = separation(position, q, velocity, w, half, at * DT)
            assert at == pytest.approx(expected, abs=1e-9) or target_of(half) <= grazes < 1.26 * target_of(half)
        met += expected < 1.0
    assert 100 < met < 390


@pytest.mark.parametrize("spin", [1.0, 30.0, 300.0])
def test_rotating_boxes_do_not_touch_before_the_time_of_impact(spin: float) -> None:
    rng = np.random.default_rng(2)
    met = 0
    for _ in range(40):
        moving = scene(rng, spin)
        at, outcome = time(*moving)
        target = target_of(moving[-1])
        samples = [separation(*moving, t) for t in np.linspace(0, at * DT, 150)]
        assert min(samples) >= target * (1 - 1e-6)
        if outcome == IMPACT:
            assert samples[-1] <= 1.26 * target
            met += 1
        else:
            assert (at, outcome) == (1.0, NO_IMPACT)
    assert 5 < met < 40


def test_order_of_the_pair_and_position_in_the_world_do_not_matter() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        position, q, velocity, w, half = scene(rng, 20.0)
        at, outcome = time(position, q, velocity, w, half)
        swapped = sweep.times_of_impact([[1, 0]], position, q, velocity, w, half, DT)
        near = 0.3 * target_of(half) / DT / 0.1  # a grazing contact has this tolerance
        assert outcome == swapped.outcome[0]
        assert at == pytest.approx(swapped.time[0], abs=1e-9)
        far, outcome_far = time(position + 1e6, q, velocity, w, half)
        assert far == pytest.approx(at, abs=near) and outcome == outcome_far


@pytest.mark.parametrize("speed", [5.0, -200.0])
def test_a_rotating_rod_meets_a_wall_at_the_known_angle(speed: float) -> None:
    half = np.array([[1.0, 0.01, 0.02], [2.0, 0.1, 2.0]])
    height = 0.6
    position = np.array([[5, 5, 5], [5, 5 + height + 0.1, 5.0]])
    w = np.array([[0, 0, speed], [0, 0, 0.0]])
    radius, lead = math.hypot(1.0, 0.01), math.atan(0.01)
    angles = [math.asin((height - n * target_of(half)) / radius) - lead for n in (1.25, 1)]
    at, outcome = time(position, LEVEL_QUATERNION, STILL, w, half, dt=1.0)
    assert outcome == IMPACT
    assert angles[0] - 1e-9 <= at * abs(speed) <= angles[1] + 1e-9


def test_a_rod_that_rotates_beside_a_wall_misses_it() -> None:
    half = np.array([[1.0, 0.01, 0.02], [2.0, 0.1, 2.0]])
    position = np.array([[0, 0, 0], [0, math.hypot(1.0, 0.01) + 0.1 + 2 * target_of(half), 0.0]])
    assert time(position, LEVEL_QUATERNION, STILL, np.array([[0, 0, 30.0], [0, 0, 0]]), half) == (1.0, NO_IMPACT)


def ring() -> octree.Octree:
    """A tube of radius 0.1 around a circle of radius 1 in the x y plane."""
    u, v = (x.ravel() for x in np.meshgrid(*[np.linspace(0, 2 * np.pi, n, endpoint=False) for n in (40, 12)],
                                           indexing="ij"))
    r = 1 + 0.1 * np.cos(v)
    i, j = np.divmod(np.arange(480), 12)
    a, b, c, d = i * 12 + j, (i + 1) % 40 * 12 + j, (i + 1) % 40 * 12 + (j + 1) % 12, i * 12 + (j + 1) % 12
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return octree.build(np.stack([r * np.cos(u), r * np.sin(u), 0.1 * np.sin(v)], 1), faces)


@pytest.mark.parametrize("level", [OBB, OCTREE, TRIANGLE])
def test_a_ball_passes_through_a_ring_except_at_level_obb(level: int) -> None:
    vertices, faces = shapes.ball(6, 8)
    forest, roots = octree.join([ring(), octree.build(0.3 * np.asarray(vertices), faces)])
    velocity, w = np.array([[0, 0, 0], [0, 0, -90.0]]), np.array([[0, 0, 3], [10, 0, 0.0]])
    for x, through in ((0.1, level != OBB), (0.75, False)):
        position = np.array([[0, 0, 0], [x, 0, 1.5]])
        at, outcome = time(position, LEVEL_QUATERNION, velocity, w, np.zeros((2, 3)), level, forest=forest, roots=roots)
        assert outcome == (NO_IMPACT if through else IMPACT)
        if not through:
            assert 0.3 < at < 1.4 / 3


@pytest.mark.parametrize("spin", [0.0, 20.0])
def test_octrees_meet_when_their_first_pair_of_leaves_does(spin: float) -> None:
    rng = np.random.default_rng(4)
    forest, roots = octree.join([octree.build(*shapes.ball(6, 9, bumps=0.3)), ring()])
    leaves = np.flatnonzero(forest.link[:, 1] == 0)
    of_a, of_b = leaves[leaves < roots[1]], leaves[leaves >= roots[1]]
    motion, poses = sweep.scratch()[:2]
    met = 0
    for _ in range(12):
        position, q, velocity, w, _ = scene(rng, spin)
        position[0] = position[1] + 2.6 * unit(position[0] - position[1])
        velocity[0] = velocity[1] + (position[1] - position[0] + rng.normal(size=3) * 2.5) * 1.3 / DT
        at, outcome = time(position, q, velocity, w, np.zeros((2, 3)), OCTREE, forest=forest, roots=roots)
        relative_motion(position, q, velocity, w, 0, 1, motion)
        target = target_of_meshes(forest.box[roots])
        # The search for a pair stops at a separation between one target and IMPACT_TOLERANCE targets: bounds of both.
        soon, late = (min(box_time_of_impact(motion, poses, forest.box[i], forest.box[j], 0.0, DT, n * target,
                                             MAX_ITERATIONS)[0] for i in of_a for j in of_b)
                      for n in (IMPACT_TOLERANCE * 1.001, 0.999 / IMPACT_TOLERANCE))
        assert soon <= at * DT <= late
        assert outcome == (IMPACT if at < 1.0 else NO_IMPACT)
        met += outcome == IMPACT
    assert 3 < met < 12


def apart(a: np.ndarray, b: np.ndarray) -> float:
    """The distance of triangles (m, 3, 3) and (n, 3, 3) that do not intersect, from all pairs of features."""
    centers = np.linalg.norm(a.mean(1)[:, None] - b.mean(1)[None], axis=-1)
    size_a, size_b = (np.linalg.norm(x - x.mean(1, keepdims=True), axis=-1).max(1) for x in (a, b))
    i, j = np.nonzero(centers - size_a[:, None] - size_b <= centers.min())
    a, b, least = a[i], b[j], np.inf
    for p, q in ((a, b), (b, a)):
        u, v = q[..., 1, :] - q[..., 0, :], q[..., 2, :] - q[..., 0, :]
        n = np.cross(u, v)
        for k in range(3):
            w = p[..., k, :] - q[..., 0, :]
            s, t = ((np.cross(x, y) * n).sum(-1) / (n * n).sum(-1) for x, y in ((w, v), (u, w)))
            over = (s >= 0) & (t >= 0) & (s + t <= 1)
            height = np.abs((w * n).sum(-1)) / np.linalg.norm(n, axis=-1)
            least = min(least, float(np.min(height, where=over, initial=np.inf)))
    for i in range(3):
        for j in range(3):
            p, q = a[..., i, :], b[..., j, :]
            u, v, w = a[..., (i + 1) % 3, :] - p, b[..., (j + 1) % 3, :] - q, q - p
            n = np.cross(u, v)
            square = (n * n).sum(-1)
            with np.errstate(invalid="ignore", divide="ignore"):
                s, t = (np.clip((np.cross(w, x) * n).sum(-1) / square, 0, 1) for x in (v, u))
            candidates = [(s, t)]
            for end in (0.0, 1.0):
                candidates.append((np.clip(((w + end * v) * u).sum(-1) / (u * u).sum(-1), 0, 1), np.full(s.shape, end)))
                candidates.append((np.full(s.shape, end), np.clip(((end * u - w) * v).sum(-1) / (v * v).sum(-1), 0, 1)))
            for s, t in candidates:
                least = min(least, float(np.nanmin(np.linalg.norm(w + t[..., None] * v - s[..., None] * u, axis=-1))))
    return least


@pytest.mark.parametrize("spin", [0.0, 20.0])
def test_meshes_meet_when_their_triangles_come_within_the_target(spin: float) -> None:
    rng = np.random.default_rng(5)
    forest, roots = octree.join([octree.build(*shapes.ball(6, 9, bumps=0.3)), ring()])
    of_a = forest.link[roots[1], 2]
    met = 0
    for _ in range(8):
        position, q, velocity, w, _ = scene(rng, spin)
        position[0] = position[1] + 2.6 * unit(position[0] - position[1])
        velocity[0] = velocity[1] + (position[1] - position[0] + rng.normal(size=3) * 2.5) * 1.3 / DT
        at, outcome = time(position, q, velocity, w, np.zeros((2, 3)), TRIANGLE, forest=forest, roots=roots)
        target = target_of_meshes(forest.box[roots])

        distance = []
        for t in np.linspace(0, at, 6) * DT:
            a, b = (triangles @ axes(q[i], w[i], t) + position[i] + velocity[i] * t
                    for i, triangles in enumerate((forest.corners[:of_a], forest.corners[of_a:])))
            distance.append(apart(a, b))
        assert min(distance) >= target * (1 - 1e-6)
        if outcome == IMPACT:
            assert distance[-1] <= 1.26 * target
            assert at > time(position, q, velocity, w, np.zeros((2, 3)), OCTREE, forest=forest, roots=roots)[0]
            met += 1
        else:
            assert (at, outcome) == (1.0, NO_IMPACT)
    assert 2 < met < 8


def test_bodies_that_move_far_in_a_step_need_ccd() -> None:
    half = np.array([[0.1, 0.2, 0.3]] * 4)
    velocity = np.array([[1.4, 0, 0], [1.6, 0, 0], [0, 0, 0], [0, 0, 0]])
    spin = np.array([[0, 0, 0], [0, 0, 0], [0, 3.9, 0], [0, 0, 4.1]])
    spin = spin.astype(float)
    assert [bool(sweep.needs_ccd(i, velocity, spin, half, DT)) for i in range(4)] == [False, True, False, True]


@pytest.mark.parametrize(("change", "message"), [
    ({"velocities": [[0, 0, 0], [np.inf, 0, 0]]}, r"velocities: expected finite numbers, got \[inf, 0.0, 0.0\]"),
    ({"positions": [[0, 0], [0, 0]]}, r"positions: expected \(2, 3\), got \(2, 2\)"),
    ({"pairs": [[0, 2]]}, "pairs: expected bodies 0 to 1, got 0 to 2"),
    ({"roots": 0}, "roots: expected nodes of a forest of 0, got 0"),
    ({"dt": 0.0}, "dt: expected seconds above 0, got 0.0"),
])
def test_invalid_arguments_are_refused(change: dict, message: str) -> None:
    bodies = {"pairs": [[0, 1]], "positions": STILL, "orientations": LEVEL_QUATERNION, "velocities": STILL,
              "angular_velocities": STILL, "half": 1.0, "dt": DT}
    with pytest.raises(ValueError, match=message):
        sweep.times_of_impact(**bodies | change)
