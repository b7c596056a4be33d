"""The scenes and models that come with the simulator: complete, plausible, and made by their scripts."""

import itertools
import subprocess
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image

from drone_engine import Scene, load, model
from drone_engine.assets import ASSETS
from drone_engine.collision.terrain.height_field import face_below, of_model
from drone_engine.geometry import mesh
from drone_engine.model import GROUND_LEVELS

SCENES = sorted(path.stem for path in (ASSETS / "scenes").glob("*.yaml"))
SCRIPTS = Path(__file__).parents[4] / "assets"
MODELS = sorted(path.stem for path in (ASSETS / "models").glob("*.obj"))
CLEARANCE = 1.5  # m, between a patrol and everything that stands

Array = npt.NDArray[np.float64]
Box = tuple[Array, Array, Array]  # center (3,), axes as columns (3, 3), half the size (3,)


def box_of(scene: Scene, name: str) -> Box:
    """The oriented box around an object that has no parent."""
    low, high = mesh.bounds(scene.model_path(name))
    x, y, z, roll, pitch, yaw = scene.objects[name].pose
    axes = plane_rotation(yaw, 0, 1) @ plane_rotation(pitch, 2, 0) @ plane_rotation(roll, 1, 2)
    return np.array([x, y, z]) + axes @ (low + high) / 2, axes, (high - low) / 2


def plane_rotation(angle: float, first: int, second: int) -> Array:
    """Rotation within the plane of two axes, from the first to the second."""
    matrix = np.eye(3)
    matrix[[first, first, second, second], [first, second, first, second]] = (
        np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle),
    )  # fmt: skip
    return matrix


def overlap(a: Box, b: Box) -> bool:
    """Whether two oriented boxes overlap (separating axes)."""
    (center_a, axes_a, half_a), (center_b, axes_b, half_b) = a, b
    crossed = [np.cross(p, q) for p in axes_a.T for q in axes_b.T]
    tests = np.array([*axes_a.T, *axes_b.T, *(axis for axis in crossed if axis @ axis > 1e-9)])
    reach = np.abs(tests @ axes_a) @ half_a + np.abs(tests @ axes_b) @ half_b
    return bool((np.abs(tests @ (center_b - center_a)) < reach).all())


def distance(box: Box, points: Array) -> Array:
    """Distances (n,) from points (n, 3) to a box."""
    center, axes, half = box
    return np.asarray(np.linalg.norm(np.maximum(np.abs((points - center) @ axes) - half, 0), axis=1))


def solid(scene: Scene) -> dict[str, Box]:
    """Boxes of all objects with collision except floors and terrain, by name."""
    names = [name for name, thing in scene.objects.items()
             if thing.parent is None and scene.level(name) not in ("none", *GROUND_LEVELS)]
    return {name: box_of(scene, name) for name in names}


@pytest.mark.parametrize("name", SCENES)
def test_scene_is_complete(name: str) -> None:
    scene = load(ASSETS / "scenes" / f"{name}.yaml")
    assert scene.cameras
    assert scene.lights
    assert "user_drone" in scene.objects
    assert any(scene.level(name) in GROUND_LEVELS for name in scene.objects)


@pytest.mark.parametrize("name", SCENES)
def test_nothing_overlaps_at_the_start(name: str) -> None:
    boxes = solid(load(ASSETS / "scenes" / f"{name}.yaml"))
    names, centers = list(boxes), np.array([center for center, _, _ in boxes.values()])
    reach = np.array([np.linalg.norm(half) for _, _, half in boxes.values()])
    apart = np.linalg.norm(centers[:, None] - centers, axis=2)
    near = [(names[i], names[k]) for i, k in np.argwhere(np.triu(apart < reach[:, None] + reach, 1))]
    assert [pair for pair in near if overlap(boxes[pair[0]], boxes[pair[1]])] == []


@pytest.mark.parametrize("name", SCENES)
def test_nothing_sinks_into_the_floor(name: str) -> None:
    scene = load(ASSETS / "scenes" / f"{name}.yaml")
    land = of_model(model.build(scene))
    floor = max((thing.pose[2] for name, thing in scene.objects.items() if scene.level(name) == "floor"), default=None)
    for key, (center, axes, half) in solid(scene).items():
        under = floor if land is None else face_below(land, *center[:2])[1]
        if not scene.objects[key].static:
            assert center[2] - np.abs(axes[2]) @ half > under - 1e-3, key


def test_plants_and_rocks_stand_on_the_island() -> None:
    scene = load("island")
    land = of_model(model.build(scene))
    assert land is not None
    for name, thing in scene.objects.items():
        if thing.static and thing.model in ("palm", "pine", "bush", "rock_round", "rock_flat"):
            _, height = face_below(land, *thing.pose[:2])
            assert -0.12 < thing.pose[2] - height < 0.005, name


@pytest.mark.parametrize("name", SCENES)
def test_patrols_are_clear(name: str) -> None:
    scene = load(ASSETS / "scenes" / f"{name}.yaml")
    for flier, thing in scene.objects.items():
        if thing.patrol is None:
            continue
        stops = np.array([thing.pose[:3], *thing.patrol.waypoints, thing.patrol.waypoints[0]])
        line = np.concatenate([np.linspace(a, b, 200) for a, b in itertools.pairwise(stops)])
        near = {other: distance(box, line).min() for other, box in solid(scene).items() if other != flier}
        assert {other: gap for other, gap in near.items() if gap < CLEARANCE} == {}


@pytest.mark.parametrize(("name", "height"), [("ring", 1.2), ("archway", 1.2), ("table", 0.6)])
def test_the_drone_fits_through(name: str, height: float) -> None:
    """Straight ahead along x, with 0.1 m to spare on each side."""
    drone = mesh.load((ASSETS / "models/drone.obj").resolve())
    reach = np.maximum(-drone.low, drone.high)[1:] + 0.1
    for part in mesh.load((ASSETS / "models" / f"{name}.obj").resolve()).parts:
        corners = part.vertices[part.faces][..., 1:] - [0.0, height]
        beside = (corners.min(axis=1) > reach) | (corners.max(axis=1) < -reach)
        assert beside.any(axis=1).all()


@pytest.mark.parametrize("name", MODELS)
def test_model_is_sound(name: str) -> None:
    path = (ASSETS / "models" / f"{name}.obj").resolve()
    model = mesh.load(path)
    named = {line.split()[1] for line in path.with_suffix(".mtl").read_text().splitlines() if line.startswith("newmtl")}
    assert {part.material.name for part in model.parts} == named
    for part in model.parts:
        assert all(np.isfinite(values).all() for values in (part.vertices, part.normals, part.uv))
        assert np.allclose(np.linalg.norm(part.normals, axis=1), 1, atol=2e-3)
        corners = part.vertices[part.faces]
        outwards = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert np.mean(np.einsum("fi,fci->fc", outwards, part.normals[part.faces]) > 0) > 0.99


@pytest.mark.parametrize("library", sorted((ASSETS / "models").glob("*.mtl")), ids=lambda path: path.stem)
def test_textures_exist(library: Path) -> None:
    named = [line.split()[-1] for line in library.read_text().splitlines() if line.startswith(("map_", "norm"))]
    assert [texture for texture in named if not (library.parent / texture).is_file()] == []


@pytest.mark.parametrize("name", [name for name in MODELS if name != "water"])
def test_solid_objects_have_color_and_normal_maps(name: str) -> None:
    """Both maps have one size, so that they can be packed into one."""
    for part in mesh.load((ASSETS / "models" / f"{name}.obj").resolve()).parts:
        colors, bumps = part.material.color_map, part.material.normal_map
        assert colors is not None, part.material.name
        assert bumps is not None, part.material.name
        with Image.open(colors) as first, Image.open(bumps) as second:
            assert first.size == second.size
            assert max(first.size) <= 1024


def test_scripts_make_the_same_bytes(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-m", "make", "--into", tmp_path, "crate", "metal"], cwd=SCRIPTS, check=True,
                   capture_output=True)  # fmt: skip
    for made in ("models/crate.obj", "models/crate.mtl", "textures/metal.png"):
        assert (tmp_path / made).read_bytes() == (ASSETS / made).read_bytes(), made
