"""Pictures of a scene: content, programs, and the states and contexts that a renderer accepts."""

import subprocess
import sys

import moderngl
import numpy as np
import pytest

from drone_engine.world import World
from drone_render import Renderer
from drone_render.frame import poses, view

from .drawing import Make, draw

DARK = "render: {ambient: [0, 0, 0]}\n"
EVERYTHING = """
render: {sky: {clouds: clouds}, water: {}, normal_mapping: {}, specular: {}}
objects:
  floor: {model: floor, pose: [0, 0, -0.5], static: true, shading: water}
  crate: {model: crate, pose: [4, 0, 1, 0, 0, 0.5], mass: 1}
  ball: {model: ball, pose: [3, 1, 0.5], mass: 1}
  lamp: {model: lamp, parent: ball, pose: [0, 0, 0.7]}
lights:
  sun: {pose: [-100, 200, 300]}
  lamp: {parent: ball, pose: [0, 0, 0.7], colour: [1, 0.5, 0.2], reach: 2}
cameras:
  front: {size: [160, 120], pose: [0, 0, 1, 0, 0.1, 0]}
"""


@pytest.mark.parametrize("place", [(6.0, 0.0, 0.0), (5.0, 1.3, 0.9), (8.0, -2.5, -1.5), (30.0, 8.0, 4.0)])
def test_points_appear_where_camera_info_says(
    place: tuple[float, float, float], make_scene: Make, graphics: moderngl.Context
) -> None:
    scene = make_scene(DARK + f"""
objects: {{lamp: {{model: lamp, pose: [{place[0]}, {place[1]}, {place[2]}], mass: 1}}}}
cameras: {{front: {{size: [640, 480], pose: [-0.5, 0.2, 0.3, 0.05, -0.04, 0.1]}}}}
""")
    glow = draw(scene, graphics).sum(axis=2).astype(float)
    rows, columns = np.indices(glow.shape)
    found = np.array([(columns * glow).sum(), (rows * glow).sum()]) / glow.sum()
    camera = scene.cameras["front"]
    optical = np.linalg.inv(poses.matrices(poses.pose(camera.pose)) @ poses.matrices(view.OPTICAL)) @ [*place, 1]
    expected = view.intrinsics(camera) @ optical[:3]
    np.testing.assert_allclose(found, expected[:2] / expected[2], atol=0.5)


def test_the_first_row_is_the_top(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = make_scene(DARK + """
objects: {lamp: {model: lamp, pose: [2, 0.5, 0.5], mass: 1}}
cameras: {front: {size: [64, 64]}}
""")
    bright = draw(scene, graphics).sum(axis=2)
    assert bright[:32, :32].any() and not bright[32:].any() and not bright[:, 32:].any()


def test_two_draws_are_equal_bytes(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = make_scene(EVERYTHING)
    first = draw(scene, graphics, time=3.0)
    np.testing.assert_array_equal(first, draw(scene, graphics, time=3.0))
    assert first.std() > 20
    assert (first != draw(scene, graphics, time=4.0)).any()  # clouds and waves have moved


def test_programs_contain_only_the_features_of_the_scene(make_scene: Make, graphics: moderngl.Context) -> None:
    words = ["normal_map", "mirrored", "clouds", "colors", "wave_phase"]
    with Renderer(make_scene(EVERYTHING), graphics) as renderer:
        everything = "".join(source_in_use(text) for text in renderer.programs)
    assert all(word in everything for word in words)
    plain = EVERYTHING.replace(EVERYTHING.split("\n")[1], "render: {}")
    with Renderer(make_scene(plain), graphics) as renderer:
        nothing = "".join(source_in_use(text) for text in renderer.programs)
    assert not any(word in nothing for word in words)


def source_in_use(text: str) -> str:
    """A shader after its preprocessor; handles #ifdef, #if and #elif of one define, #else and #endif."""
    defines: dict[str, int] = {}
    kept: list[str] = []
    stack: list[tuple[bool, bool]] = []  # is this branch on, was any before
    for line in text.splitlines():
        words = line.split("//")[0].split()
        on = all(branch for branch, _ in stack)
        match words:
            case ["#define", name, number]:
                defines[name] = int(number)
            case ["#ifdef", name]:
                stack.append((name in defines, name in defines))
            case ["#if", name, ">", "0"]:
                stack.append((defines.get(name, 0) > 0, defines.get(name, 0) > 0))
            case ["#elif", name, ">", "0"]:
                _, before = stack.pop()
                stack.append((not before and defines.get(name, 0) > 0, before or defines.get(name, 0) > 0))
            case ["#else"]:
                _, before = stack.pop()
                stack.append((not before, True))
            case ["#endif"]:
                stack.pop()
            case _ if on:
                kept.append(" ".join(words))
    return "\n".join(kept)


def test_coarse_levels_are_barely_visible(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = make_scene("""
objects: {ball: {model: ball, mass: 1, poses: [[3, 0.7, 0], [6, -1, 0], [12, 0, 1], [25, 3, -1]]}}
lights: {sun: {pose: [-100, 200, 300]}}
cameras: {front: {size: [320, 240]}}
""")
    full = draw(scene, graphics, tolerance=0.0).astype(float)
    fewer = np.abs(draw(scene, graphics) - full).mean()
    assert 0 < fewer < 0.5
    assert np.abs(draw(scene, graphics, tolerance=30.0) - full).mean() > 2 * fewer


def test_a_scene_can_be_switched_on_one_context(make_scene: Make, graphics: moderngl.Context) -> None:
    picture = draw(make_scene(EVERYTHING), graphics)
    draw(make_scene(DARK + "objects: {ball: {model: ball, mass: 1}}\ncameras: {front: {}}\n"), graphics)
    np.testing.assert_array_equal(picture, draw(make_scene(EVERYTHING), graphics))


def test_a_world_is_drawn_where_its_bodies_are(make_scene: Make) -> None:
    scene = make_scene("effects: {gravity: {}}" + EVERYTHING)
    world = World(scene)
    world.run(12)
    with Renderer(scene) as renderer:
        now = renderer.draw("front", world)
        by_name = renderer.draw("front", {name: world.pose(name) for name in ("crate", "ball")}, world.time)
        start = renderer.draw("front", time=world.time)
    assert now.shape == (120, 160, 3) and now.dtype == np.uint8
    np.testing.assert_array_equal(by_name, now)
    assert np.abs(now.astype(int) - start).mean() > 1


def test_two_renderers_take_turns_on_their_own_contexts(make_scene: Make) -> None:
    scene, other = make_scene(EVERYTHING), make_scene(EVERYTHING.replace("pose: [3, 1, 0.5]", "pose: [3, -1, 0.5]"))
    with Renderer(scene) as first, Renderer(other) as second:
        pictures = [renderer.draw("front") for _ in range(2) for renderer in (first, second)]
        second.release()
        again = first.draw("front")
    np.testing.assert_array_equal(pictures[0], pictures[2])
    np.testing.assert_array_equal(pictures[1], pictures[3])
    np.testing.assert_array_equal(pictures[0], again)
    assert (pictures[0] != pictures[1]).any()


def test_an_unknown_camera_is_an_error_that_lists_the_cameras(make_scene: Make, graphics: moderngl.Context) -> None:
    with Renderer(make_scene(EVERYTHING), graphics) as renderer:
        with pytest.raises(ValueError, match=r"^no camera 'back' in the scene 'test'; there are front$"):
            renderer.draw("back")
        with pytest.raises(ValueError, match="no camera 'back'"):
            renderer.measure("back")


def test_drawing_imports_no_ros() -> None:
    """Nor drone_sim, whose wire format only the node uses."""
    program = """
import sys
from drone_engine import load
from drone_render import Film, Lines, Renderer
with Renderer(load("ring")) as renderer:
    renderer.draw("chase"), renderer.measure("chase")
found = {name.partition(".")[0] for name in sys.modules}
ros = [name for name in found if name.startswith(("rclpy", "ament", "rosidl")) or name.endswith(("_msgs", "_srvs"))]
assert not ros and not found & {"drone_sim", "drone_interfaces"}, ros
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
