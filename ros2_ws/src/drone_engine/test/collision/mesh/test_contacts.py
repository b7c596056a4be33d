"""Contacts of meshes for the solver: normals, depths, joints between flat faces."""

import itertools
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drone_engine import parse
from drone_engine.arrays import Floats
from drone_engine.collision import Shape, manifolds
from drone_engine.collision.mesh.topology import EDGE, OPEN, POINTED, find_topology
from drone_engine.world import World
from reference.shapes import write_box

G = 9.80665
SIGNS = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
CUBE = Shape.of(SIGNS, [face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))])


def rotation(q: Floats) -> Floats:
    """The matrix of a unit quaternion x y z w."""
    x, y, z, w = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def pushed_cubes(seed: int, depth: float) -> tuple[Floats, Floats, Floats]:
    """Poses of two cubes in random orientations that overlap by `depth` m, and the direction in which b leaves a."""
    rng = np.random.default_rng(seed)
    q, p, way = rng.normal(size=4), rng.normal(size=4), rng.normal(size=3)
    q, p, way = q / np.linalg.norm(q), p / np.linalg.norm(p), way / np.linalg.norm(way)
    a, b = rotation(q).T, rotation(p).T
    axes = [*a, *b, *(np.cross(u, v) / np.linalg.norm(np.cross(u, v)) for u in a for v in b)]
    reach = np.array([0.5 * (np.abs(a @ axis) + np.abs(b @ axis)).sum() for axis in axes])
    distance = (reach / np.abs([way @ axis for axis in axes])).min()  # at which they touch
    axis = axes[int(np.argmin(reach / np.abs([way @ axis for axis in axes])))]
    normal = axis * np.sign(axis @ way)
    return np.r_[np.zeros(3), q], np.r_[distance * way - depth * normal, p], normal


def test_overlapping_cubes_have_contacts_that_lead_out() -> None:
    right = 0
    for seed in range(100):
        a, b, normal = pushed_cubes(seed, 0.002)
        found = manifolds(CUBE, a, CUBE, b)
        deepest = max(found, key=lambda manifold: manifold.depth.max())
        assert deepest.depth.max() > 0.0
        assert deepest.normal[0] @ normal > 0.0
        right += bool(deepest.normal[0] @ normal > np.cos(np.radians(5.0)) and deepest.depth.max() < 0.0021)
    assert right >= 97


def test_deeply_overlapping_cubes_have_contacts() -> None:
    for seed in range(50):
        a, b, _ = pushed_cubes(seed, 0.2)
        assert max(manifold.depth.max() for manifold in manifolds(CUBE, a, CUBE, b)) > 0.0


def grid(n: int) -> tuple[Floats, list[tuple[int, int, int]]]:
    """Vertices and faces of a flat sheet of n x n squares of 1 m, facing up."""
    vertices = np.array([(i, j, 0.0) for i in range(n + 1) for j in range(n + 1)])
    faces = []
    for i, j in itertools.product(range(n), repeat=2):
        a, b, c, d = i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1
        faces += [(a, b, c), (a, c, d)]
    return vertices, faces


def test_a_flat_sheet_has_edges_and_pointed_corners_at_its_border_only() -> None:
    vertices, faces = grid(4)
    topology = find_topology(vertices[np.array(faces)])
    bits = [(topology.owned[:, None] & (first << np.arange(3)) != 0).sum() for first in (POINTED, EDGE)]
    assert bits == [4, 16]
    assert (topology.owned & OPEN).all()


def test_a_cube_has_eight_pointed_corners_and_twelve_edges() -> None:
    owned = CUBE.topology.owned
    bits = [(owned[:, None] & (first << np.arange(3)) != 0).sum() for first in (POINTED, EDGE)]
    assert bits == [8, 12]
    assert not (owned & OPEN).any()


@pytest.fixture
def sliding(tmp_path: Path) -> Callable[..., World]:
    """A crate of 0.6 m that moves over tiles of 0.3 m or over a mesh of triangles, at the collision level triangle."""
    (tmp_path / "models").mkdir()
    (tmp_path / "scenes").mkdir()
    write_box(tmp_path / "models" / "tile.obj", (0.3, 0.3, 0.3), 0.0)
    write_box(tmp_path / "models" / "crate.obj", (0.6, 0.6, 0.6), 0.0)
    vertices, faces = grid(12)
    (tmp_path / "models" / "net.obj").write_text(
        "".join(f"v {0.4 * x - 1} {0.4 * y - 2} 0\n" for x, y, _ in vertices)
        + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))

    def make(ground: str, rate: int, substeps: int, friction: float, step: float = 0.0) -> World:
        material = f"friction: {friction}, restitution: 0"
        lines = [f"crate: {{model: crate, mass: 10, {material}, pose: [0, 0, 0.3]}}"]
        if ground == "net":
            lines += [f"net: {{model: net, static: true, {material}}}"]
        else:
            lines += [f"tile_{i}_{j}: {{model: tile, static: true, {material}, "
                      f"pose: [{0.3 * i - 0.45}, {0.3 * j - 0.45}, {-0.15 + (step if i > 5 else 0.0)}]}}"
                      for i in range(12) for j in range(8)]
        text = (f"version: 1\nrates: {{physics: {rate}}}\ndynamics: {{substeps: {substeps}, sleep: false}}\n"
                "effects: {gravity: {}}\ncollision: {level: triangle}\nobjects:\n  " + "\n  ".join(lines) + "\n")
        return World(parse(text, tmp_path / "scenes" / "sliding.yaml"))

    return make


@pytest.mark.parametrize(("rate", "substeps"), [(30, 8), (240, 1)])
@pytest.mark.parametrize("ground", ["tiles", "net"])
def test_a_crate_slides_over_joints_as_over_a_plane(sliding: Callable[..., World], ground: str, rate: int,
                                                    substeps: int) -> None:
    for friction, velocity in ((0.0, (1.7, 0.4)), (0.3, (2.0, 0.3))):
        world = sliding(ground, rate, substeps, friction)
        world.state.velocity_w[0, :2] = velocity
        highest = 0.3
        for _ in range(rate):
            world.step()
            highest = max(highest, world.state.position_w[0, 2])
        speed, time = float(np.hypot(*velocity)), 1.0
        time = min(time, speed / (friction * G)) if friction else time
        way = np.linalg.norm(world.state.position_w[0, :2])
        assert way == pytest.approx(speed * time - 0.5 * friction * G * time**2, rel=0.01)
        assert highest < 0.3005


def test_a_step_of_a_few_millimeters_stops_a_crate(sliding: Callable[..., World]) -> None:
    world = sliding("tiles", 240, 1, 0.0, step=0.005)
    world.state.velocity_w[0, 0] = 1.0
    world.run(480)
    assert world.state.position_w[0, 0] < 1.3 or world.state.position_w[0, 2] > 0.3045


@pytest.mark.parametrize(("rate", "substeps"), [(30, 8), (240, 1)])
def test_a_block_that_falls_on_another_stays_outside(sliding: Callable[..., World], rate: int, substeps: int) -> None:
    world = sliding("tiles", rate, substeps, 0.6)
    for seed in range(4):
        world.reset()
        rng = np.random.default_rng(seed)
        turn = rng.normal(size=4)
        world.state.orientation_w[0] = turn / np.linalg.norm(turn)
        world.state.position_w[0] = (0.6, 0.3, 0.8)
        for step in range(2 * rate):
            world.step()
            lowest = (SIGNS * 0.6 @ rotation(world.state.orientation_w[0]).T)[:, 2].min()
            if step > rate // 2:
                assert world.state.position_w[0, 2] + lowest > -0.005
