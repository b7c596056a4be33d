"""Terrain: bodies rest on the drawn surface of the island, whose heights are found by vertical lines, independently."""

from collections.abc import Callable
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from drone_engine import Scene, SceneError, load, parse
from drone_engine.collision.terrain import height_field
from drone_engine.effects import ground_effect
from drone_engine.effects.disks import Disks
from drone_engine.geometry import mesh
from drone_engine.math.poses import rotate_all
from drone_engine.world import World

PLACES = {
    "square": (1.0, 2.0), "kerb": (7.1, 0.3), "meadow": (-12.0, -3.0), "top of a knoll": (-24.5, -10.7),
    "side of a knoll": (-27.0, -14.0), "path over a knoll": (-26.0, -5.2), "where the meadow ends": (30.0, -31.0),
    "beach": (-30.0, -38.5), "beach under the sea": (57.0, 2.0), "headland": (-41.0, 21.0),
    "side of the headland": (-36.2, 17.5), "foot of the headland": (-41.4, 15.2), "tip of the headland": (-47.8, 24.0),
    "ledge": (45.0, 19.8), "sea bed": (5.0, -58.0), "far out": (80.0, 5.0),
}
THINGS = {  # mass, height of the fall, roll, pitch and yaw
    "crate": (20.0, 2.5, (0.2, 0.1, 0.5)), "drone": (1.4, 2.0, (0.0, 0.0, 0.3)), "person": (75.0, 1.5, (0.0, 0.0, 0.3)),
}
SEA = -0.35  # m


def on_island(thing: str, effects: str = "gravity: {}, drag: {}", level: str = "ground", rest: str = "") -> World:
    """A world with the island's terrain and one object."""
    return World(parse(f"version: 1\nrates: {{physics: 30}}\neffects: {{{effects}}}\n{rest}\nobjects:\n"
                       f"  thing: {thing}\n  island: {{model: island, static: true, collision: {{level: {level}}}}}\n",
                       load("island").path))


def dropped(name: str, place: tuple[float, float], level: str = "ground", rest: str = "", **words: str) -> World:
    mass, height, (roll, pitch, yaw) = THINGS[name]
    pose = [*place, height, roll, pitch, yaw]
    return on_island(f"{{model: {name}, pose: {pose}, mass: {mass}, friction: 0.8}}", level=level, rest=rest, **words)


@cache
def triangles() -> np.ndarray:
    """The triangles of the island that face up, (t, 3, 3)."""
    vertices, faces = mesh.surface(load("island").model_path("island"))
    corners = vertices[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    seen: np.ndarray = corners[across[:, 2] > 1e-9]
    return seen


def drawn(points: np.ndarray) -> np.ndarray:
    """The height of the drawn island at points (k, 2), m: of the highest triangle on a vertical line."""
    corners = triangles()
    height = np.full(len(points), corners[..., 2].min())
    low, high = points.min(axis=0), points.max(axis=0)
    near = ((corners[..., :2].max(axis=1) >= low) & (corners[..., :2].min(axis=1) <= high)).all(axis=1)
    for a, b, c in corners[near]:
        u, v, w = b - a, c - a, points - a[:2]
        twice = u[0] * v[1] - u[1] * v[0]
        s, t = (w[:, 0] * v[1] - w[:, 1] * v[0]) / twice, (u[0] * w[:, 1] - u[1] * w[:, 0]) / twice
        inside = (s >= -1e-9) & (t >= -1e-9) & (s + t <= 1.0 + 1e-9)
        height[inside] = np.maximum(height, a[2] + s * u[2] + t * v[2])[inside]
    return height


def clearance(world: World) -> float:
    """The smallest height of the object's box above the drawn island, m; negative in penetration."""
    half, grid = world.model.bodies.half[0], np.linspace(-1.0, 1.0, 33)
    points = np.array([np.insert(pair, axis, side) for axis, side in product(range(3), (-1.0, 1.0))
                       for pair in product(grid, grid)]) * half
    points = rotate_all(np.tile(world.state.orientation_w[0], (len(points), 1)), points) + world.state.position_w[0]
    return float((points[:, 2] - drawn(points[:, :2])).min())


@pytest.mark.parametrize("name", THINGS)
@pytest.mark.parametrize("place", PLACES)
def test_objects_come_to_rest_on_the_drawn_surface_and_stay(name: str, place: str) -> None:
    world = dropped(name, PLACES[place])
    world.run(20 * 30)
    assert abs(clearance(world)) < 0.5e-3
    before = world.pose("thing")
    world.run(20 * 30)
    np.testing.assert_allclose(world.pose("thing"), before, atol=1e-9)


@pytest.mark.parametrize("place", ["side of a knoll", "beach under the sea", "headland", "ledge"])
def test_objects_do_not_creep_without_sleeping(place: str) -> None:
    world = dropped("crate", PLACES[place], rest="dynamics: {sleep: false}")
    world.run(20 * 30)
    before = world.pose("thing")[:3]
    world.run(30 * 30)
    assert np.linalg.norm(world.pose("thing")[:3] - before) < 1e-3
    assert abs(clearance(world)) < 0.5e-3


def test_flat_ground_equals_a_floor_bit_for_bit() -> None:
    ground, floor = (dropped("crate", PLACES["square"], level) for level in ("ground", "floor"))
    for _ in range(150):
        ground.step()
        floor.step()
        assert ground.state.hash() == floor.state.hash()


def test_heights_are_those_of_the_triangles() -> None:
    land = height_field.of_model(dropped("crate", (0.0, 0.0)).model)
    assert land is not None
    random = np.random.default_rng(3)
    angle, away = random.uniform(0.0, 2.0 * np.pi, 3000), 80.0 * np.sqrt(random.random(3000))
    points = np.column_stack([away * np.cos(angle), away * np.sin(angle)])
    found = [height_field.face_below(land, x, y)[1] for x, y in points]
    np.testing.assert_allclose(found, [drawn(point[None])[0] for point in points], atol=1e-9)


@pytest.mark.parametrize("level", ["octree", "triangle"])
def test_finer_levels_rest_on_the_corners_of_their_mesh(level: str) -> None:
    world = dropped("drone", PLACES["side of a knoll"])
    world.set_collision_level(level)
    world.run(30 * 30)
    corners = mesh.surface(load("island").model_path("user_drone"))[0]
    pose = world.pose("thing")
    corners = rotate_all(np.tile(pose[3:], (len(corners), 1)), corners) + pose[:3]
    assert abs((corners[:, 2] - drawn(corners[:, :2])).min()) < 1e-3


def test_a_sphere_rests_on_its_lowest_point() -> None:
    world = dropped("drone", PLACES["square"])
    world.set_collision_level("sphere")
    world.run(10 * 30)
    assert world.state.position_w[0, 2] == pytest.approx(np.linalg.norm(world.model.bodies.half[0]), abs=1e-3)


FLYING = "{model: drone, pose: [%g, %g, %g, 0, 0, %g], mass: 1.4, friction: 0.5, flight: {}}"


def test_a_drone_that_flies_at_the_headland_stays_outside() -> None:
    world = on_island(FLYING % (-36.0, 2.0, 0.5, 1.9))
    deepest = 0.0
    for step in range(100):
        world.step({"thing": (8.0, 0.0, 0.0, 0.0)})
        if step > 40:  # it is close
            deepest = min(deepest, clearance(world))
    assert -0.1 < deepest < -1e-4  # m; a step at that speed is 0.27 m
    assert np.linalg.norm(world.pose("thing")[:2] - (-36.0, 2.0)) > 5.0


@pytest.mark.parametrize("place", ["beach", "side of a knoll", "headland", "square"])
def test_a_drone_lands_on_terrain_and_takes_off_again(place: str) -> None:
    world = on_island(FLYING % (*PLACES[place], 2.5, 0.4))
    for _ in range(150):
        world.step({"thing": (0.0, 0.0, -1.0, 0.0)})
    world.run(150)
    landed = world.pose("thing")
    assert world.state.landed[0]
    assert abs(clearance(world)) < 0.5e-3
    world.run(300)
    np.testing.assert_allclose(world.pose("thing"), landed, atol=1e-9)
    for _ in range(60):
        world.step({"thing": (0.0, 0.0, 1.0, 0.0)})
    assert world.pose("thing")[2] > landed[2] + 1.0


STEP = [(-5, -5, 1), (0, -5, 1), (0, 5, 1), (-5, 5, 1), (0, -5, 0), (5, -5, 0), (5, 5, 0), (0, 5, 0)]


@pytest.mark.parametrize("wall", [True, False])
def test_a_crate_that_overhangs_a_step_stays(tmp_path: Path, wall: bool) -> None:
    """A crate of 0.6 m, a third of it over the edge of ground that drops by a metre, with and without a face there."""
    faces = [(1, 2, 3), (1, 3, 4), (5, 6, 7), (5, 7, 8)] + [(2, 5, 8), (2, 8, 3)] * wall
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "step.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in STEP) + "".join(f"f {a} {b} {c}\n" for a, b, c in faces))
    world = World(parse("version: 1\neffects: {gravity: {}}\nobjects:\n"
                        "  crate: {model: crate, pose: [-0.1, 0, 1.05], mass: 20, friction: 0.8}\n"
                        "  step: {model: step, static: true, collision: {level: ground}}\n",
                        tmp_path / "scenes" / "step.yaml"))
    world.run(300)
    assert world.pose("crate")[:2] == pytest.approx([-0.1, 0.0], abs=0.02)
    assert world.pose("crate")[2] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("steep", [30, 45, 60])
def test_a_ball_is_stopped_by_a_slope(tmp_path: Path, steep: float) -> None:
    rise = float(np.tan(np.radians(steep)))
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "slope.obj").write_text(
        f"v -9 -9 0\nv 0 -9 0\nv 0 9 0\nv -9 9 0\nv 5 -9 {5 * rise}\nv 5 9 {5 * rise}\n"
        "f 1 2 3\nf 1 3 4\nf 2 5 6\nf 2 6 3\n")
    world = World(parse("version: 1\neffects: {gravity: {}}\nobjects:\n"
                        "  ball: {model: crate, pose: [-3, 0, 0.22], mass: 5, collision: {level: sphere}}\n"
                        "  slope: {model: slope, static: true, collision: {level: ground}}\n",
                        tmp_path / "scenes" / "slope.yaml"))
    radius = float(np.linalg.norm(world.model.bodies.half[0]))
    normal = np.array([-rise, 0.0, 1.0]) / np.hypot(rise, 1.0)
    world.state.velocity_w[0] = 2.0, 0.0, 0.0
    clear = []
    for _ in range(90):
        world.step()
        clear.append(float(normal @ world.state.position_w[0]) - radius)
    assert min(clear) > -0.01  # m
    assert world.state.velocity_w[0, 0] < 1.9


def test_wide_terrain_has_a_bounded_number_of_cells(tmp_path: Path) -> None:
    (tmp_path / "plain.obj").write_text("v -1e4 -1e4 0\nv 1e4 -1e4 0\nv 1e4 1e4 0\nv -1e4 1e4 1\nf 1 2 3\nf 1 3 4\n")
    found = height_field.build(*mesh.surface(tmp_path / "plain.obj"), tmp_path / "plain.obj")
    assert len(found.flat) < 300_000
    assert height_field.face_below(found, -9e3, 9e3)[1] == pytest.approx(0.9)


# The sea

@pytest.mark.parametrize("name", ["island", "lagoon"])
def test_the_sea_is_where_it_is_drawn(name: str) -> None:
    scene = load(name)
    low, high = mesh.bounds(scene.model_path("sea"))
    assert low[2] == high[2] == 0.0
    assert scene.objects["sea"].pose[2] == scene.effects["water"]["level"]


def test_the_sea_covers_the_beach() -> None:
    assert load("island").effects["water"]["level"] == SEA


def test_in_the_sea_a_crate_floats_or_lies_on_the_bed() -> None:
    light, heavy = (on_island(f"{{model: crate, pose: [80, 5, 1], mass: {mass}}}",
                              f"gravity: {{}}, drag: {{}}, water: {{level: {SEA}}}") for mass in (20, 800))
    for world in (light, heavy):
        world.run(60 * 30)
    half = light.model.bodies.half[0]
    under = 20.0 / 1025.0 / (4.0 * half[0] * half[1])  # of a box that lies level
    assert light.pose("thing")[2] == pytest.approx(SEA - under, abs=2e-3)
    assert abs(clearance(heavy)) < 0.5e-3


def test_a_drone_that_fell_into_the_sea_floats_and_flies_on() -> None:
    """It comes down with the speed of a fall from 5 m."""
    world = on_island(FLYING % (80.0, 5.0, 5.0, 0.0), f"gravity: {{}}, drag: {{}}, water: {{level: {SEA}}}")
    for _ in range(120):
        world.step({"thing": (0.0, 0.0, -8.0, 0.0)})
    world.run(150)
    floats = world.pose("thing")
    assert SEA - 0.2 < floats[2] < SEA + 0.2
    for _ in range(90):
        world.step({"thing": (0.0, 0.0, 1.0, 0.0)})
    assert world.pose("thing")[2] > floats[2] + 1.0


# Small terrains

@pytest.fixture
def folder(scene: Callable[..., Scene]) -> Path:
    """The folder of the small models."""
    return scene("crate: {model: crate, mass: 1}").path.parents[1]


def hill(folder: Path, name: str = "hill") -> None:
    """A ridge along y, 1 m high over flanks of 10 m, down to 0."""
    (folder / "models" / f"{name}.obj").write_text(
        "v -10 -20 0\nv 0 -20 1\nv 10 -20 0\nv -10 20 0\nv 0 20 1\nv 10 20 0\n"
        "f 1 2 5\nf 1 5 4\nf 2 3 6\nf 2 6 5\n")


HILL = "hill: {model: hill, static: true, collision: {level: ground}}\n"


def test_a_crate_lies_across_a_ridge(world: Callable[..., World], folder: Path) -> None:
    """Its corners are above the slopes on both sides."""
    hill(folder)
    lying = world(HILL + "crate: {model: crate, mass: 5, pose: [0, 0, 1.05, 0, 0, 0.3]}", "effects: {gravity: {}}")
    lying.run(20 * round(1 / lying.dt))
    assert lying.pose("crate")[2] == pytest.approx(1.0, abs=1e-4)
    assert lying.pose("crate")[:2] == pytest.approx((0.0, 0.0), abs=1e-2)


def test_outside_of_its_model_the_ground_is_at_its_lowest_height(world: Callable[..., World], folder: Path) -> None:
    hill(folder)
    far = world(HILL + "crate: {model: crate, mass: 5, pose: [500, 0, 0.4]}", "effects: {gravity: {}}")
    far.run(5 * round(1 / far.dt))
    assert far.pose("crate")[2] == pytest.approx(0.0, abs=1e-4)


def test_ground_effect_uses_the_terrain_below_the_rotors() -> None:
    island = height_field.of_model(dropped("crate", (0.0, 0.0)).model)
    assert island is not None
    x, y = PLACES["headland"]
    force, torque = np.zeros((1, 3)), np.zeros((1, 3))
    rotor = Disks(np.zeros(1, np.int64), np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]), np.array([0.1]))
    ground_effect.lift(np.empty(0), island, rotor, np.array([3.0]),
                       np.array([[x, y, drawn(np.array([[x, y]]))[0] + 0.1]]), np.array([[0.0, 0.0, 0.0, 1.0]]),
                       np.zeros((1, 3)), np.empty((0, 3)), 1.225, force, torque)
    np.testing.assert_allclose(force[0], [0.0, 0.0, 3.0 / 15.0])


def test_invalid_terrain_is_refused(folder: Path, world: Callable[..., World]) -> None:
    hill(folder)
    with pytest.raises(SceneError, match=r"other.collision.level: expected one 'ground' in a scene, and 'hill'"):
        world(HILL + "other: {model: hill, static: true, collision: {level: ground}}")
    with pytest.raises(SceneError, match="a 'ground' is static, so it must not have a 'mass'"):
        world("hill: {model: hill, mass: 1, collision: {level: ground}}")
    (folder / "models" / "ceiling.obj").write_text("v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 3 2\n")
    with pytest.raises(mesh.MeshError, match=r"expected a triangle that faces up, .* got none"):
        world("ceiling: {model: ceiling, static: true, collision: {level: ground}}")
