"""What is in the picture, and what is in the programs that draw it."""

import moderngl
import numpy as np
import pytest

from drone_engine.geometry import mesh
from drone_render import view
from drone_render.context import Device
from drone_render.hierarchy import Hierarchy, Lighting
from drone_render.renderer import Renderer
from drone_render.shore import survey

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
    optical = np.linalg.inv(view.matrices(view.pose(camera.pose)) @ view.matrices(view.OPTICAL)) @ [*place, 1]
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


def test_programs_hold_what_the_scene_names_and_nothing_else(make_scene: Make, graphics: moderngl.Context) -> None:
    words = ["normal_map", "mirrored", "clouds", "colours", "wave_phase"]
    with Renderer(make_scene(EVERYTHING), graphics) as renderer:
        everything = "".join(source_in_use(text) for text in renderer.programs)
    assert all(word in everything for word in words)
    plain = EVERYTHING.replace(EVERYTHING.split("\n")[1], "render: {}")
    with Renderer(make_scene(plain), graphics) as renderer:
        nothing = "".join(source_in_use(text) for text in renderer.programs)
    assert not any(word in nothing for word in words)


def source_in_use(text: str) -> str:
    """A shader without what its preprocessor leaves out: #ifdef, #if and #elif of one define, #else, #endif."""
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


def test_an_object_is_not_lit_by_its_own_light(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = """
objects:
  ball: {model: ball, pose: [3, 0, 0], mass: 1}
  part: {model: ball, parent: ball, pose: [0, 1.2, 0]}
  other: {model: ball, pose: [3, -1.2, 0], mass: 1}
lights: {lamp: {parent: ball, pose: [-2, 0, 0]}}
cameras: {front: {size: [90, 60], fov: 1.2}}
"""
    picture = draw(make_scene(DARK + scene), graphics).sum(axis=2)
    own, other = picture[:, :58], picture[:, 60:]
    assert not own.any()  # nor by that of what it hangs on
    assert other.max() > 300


def test_a_far_beam_is_no_sun(make_scene: Make, graphics: moderngl.Context) -> None:
    """It lights what it points at, and nothing else."""
    scene = """
objects: {ball: {model: ball, pose: [3, 0, 0], mass: 1}}
lights: {lamp: {pose: [-300, 0, 0, 0, 0, YAW], beam: 0.05}}
cameras: {front: {size: [90, 60]}}
"""
    towards, away = (draw(make_scene(DARK + scene.replace("YAW", yaw)), graphics) for yaw in ("0", "3.1415927"))
    assert towards.max() > 100 and not away.any()


def boxes(*middles: list[float]) -> np.ndarray:
    """Matrices of boxes that are not turned."""
    matrices = np.tile(np.eye(4), (len(middles), 1, 1))
    matrices[:, :3, 3] = middles
    return matrices


def test_an_object_is_lit_by_its_four_strongest_lights(make_scene: Make) -> None:
    lights = "\n".join(f"  light_{i}: {{pose: [{i}, 0, 3], reach: 2, intensity: 1}}" for i in range(9))
    lights += "\n  sun: {pose: [0, 0, 90]}\n"
    scene = make_scene(f"objects: {{ball: {{model: ball, mass: 1}}}}\nlights:\n{lights}")
    hierarchy = Hierarchy(scene)
    lighting = Lighting(hierarchy)
    places = lighting.places(hierarchy.world(hierarchy.start))
    (chosen,) = lighting.strongest(places, np.zeros(1, np.intp), boxes([0, 0, 0]), np.full((1, 3), 0.5))
    assert list(chosen) == [0, 1, 2, 9]
    (far,) = lighting.strongest(places, np.zeros(1, np.intp), boxes([500, 0, 0]), np.full((1, 3), 0.5))
    assert list(far) == [9]  # the others have ended


def test_lights_over_a_wide_floor_count_by_their_distance(make_scene: Make) -> None:
    lights = "\n".join(f"  light_{i}: {{pose: [{i}, 0, {9 - 2 * i}], reach: 2}}" for i in range(5))
    hierarchy = Hierarchy(make_scene(f"objects: {{floor: {{model: floor, static: true}}}}\nlights:\n{lights}"))
    lighting = Lighting(hierarchy)
    places = lighting.places(hierarchy.world(hierarchy.start))
    turned = boxes([0, 0, 0])
    turned[0, :3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]  # its thin side is up
    (chosen,) = lighting.strongest(places, np.zeros(1, np.intp), turned, np.array([[20, 0.1, 20]]))
    assert list(chosen) == [1, 2, 3, 4]


def test_only_what_is_far_away_is_the_sun(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = """
render: {sky: {}}
objects: {}
lights: {lamp: {pose: [PLACE]}}
cameras: {front: {size: [90, 60], fov: 1.2, pose: [0, 0, 0, 0, -0.5, 0]}}
"""
    far, near = (
        draw(make_scene(scene.replace("PLACE", place)), graphics).astype(int) for place in ("900, 0, 492", "9, 0, 4.92")
    )
    assert far[30, 45].sum() > near[30, 45].sum() + 100  # only the one is seen as a disk


def test_a_beam_lights_what_is_before_it(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = """
objects:
  screen: {model: lamp, pose: [3, 0, 0], mass: 1}
  left: {model: ball, pose: [3, 1.2, 0], mass: 1}
  right: {model: ball, pose: [3, -1.2, 0], mass: 1}
lights: {screen: {parent: screen, pose: [0, 0, 0, 0, 0, 1.5707963], BEAM}}
cameras: {front: {size: [90, 60], fov: 1.2}}
"""
    around = draw(make_scene(DARK + scene.replace("BEAM", "reach: 50")), graphics).sum(axis=2)
    half = draw(make_scene(DARK + scene.replace("BEAM", "reach: 50, beam: 1.5707963")), graphics).sum(axis=2)
    narrow = draw(make_scene(DARK + scene.replace("BEAM", "reach: 50, beam: 0.3")), graphics).sum(axis=2)
    assert around[:, 48:].max() > 300 and not half[:, 48:].any() and not narrow[:, 48:].any()
    lit = [np.count_nonzero(picture[:, :40]) for picture in (around, half, narrow)]
    assert lit[0] >= lit[1] > 2 * lit[2] > 0


def test_no_beam_is_spent_on_what_it_misses(make_scene: Make) -> None:
    scene = make_scene("""
objects: {ball: {model: ball, mass: 1}}
lights: {lamp: {pose: [0, 0, 3], beam: 0.5, reach: 20}, other: {pose: [0, 0, 3, 0, 1.5707963, 0], beam: 0.5, reach: 9}}
""")
    hierarchy = Hierarchy(scene)
    lighting = Lighting(hierarchy)
    places = lighting.places(hierarchy.world(hierarchy.start))
    around = boxes([0, 0, 0], [5, 0, 3], [0, 0, 3.1])
    chosen = lighting.strongest(places, np.zeros(3, np.intp), around, np.full((3, 3), 0.3))
    assert [list(numbers) for numbers in chosen] == [[1], [0], [0, 1]]


def test_children_move_with_their_parents(make_scene: Make) -> None:
    scene = make_scene("""
objects:
  tip: {model: lamp, parent: arm, pose: [1, 0, 0]}
  arm: {model: lamp, parent: body, pose: [0, 0, 1, 0, 0, 1.5707963267948966]}
  body: {model: ball, pose: [5, 0, 0, 0, 0, 1.5707963267948966], mass: 1}
""")
    hierarchy = Hierarchy(scene)
    world = hierarchy.world(hierarchy.start)
    np.testing.assert_allclose(hierarchy.place(world, "tip")[:3, 3], [4, 0, 1], atol=1e-9)


def test_fewer_triangles_are_hardly_seen(make_scene: Make, graphics: moderngl.Context) -> None:
    scene = make_scene("""
objects: {ball: {model: ball, mass: 1, poses: [[3, 0.7, 0], [6, -1, 0], [12, 0, 1], [25, 3, -1]]}}
lights: {sun: {pose: [-100, 200, 300]}}
cameras: {front: {size: [320, 240]}}
""")
    full = draw(scene, graphics, tolerance=0.0).astype(float)
    fewer = np.abs(draw(scene, graphics) - full).mean()
    assert 0 < fewer < 0.5
    assert np.abs(draw(scene, graphics, tolerance=30.0) - full).mean() > 2 * fewer


def test_edges_are_smoothed_and_faces_stay_sharp(make_scene: Make, graphics: moderngl.Context) -> None:
    text = """
render: {ambient: [0.5, 0.5, 0.5]ANTIALIASING}
objects: {crate: {model: crate, mass: 1, pose: [3, 0, 0, 0.3, 0, 0]}}
cameras: {front: {size: [160, 120]}}
"""
    plain = draw(make_scene(text.replace("ANTIALIASING", "")), graphics).astype(float)
    smooth = draw(make_scene(text.replace("ANTIALIASING", ", antialiasing: {}")), graphics).astype(float)
    background = plain[0, 0]
    thing = np.abs(plain - background).sum(axis=2) > 0
    inside = thing.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            inside &= np.roll(thing, step, axis)
    np.testing.assert_array_equal(smooth[inside], plain[inside])
    steps = [np.abs(np.diff(picture.sum(axis=2), axis=1))[~inside[:, 1:]].max() for picture in (plain, smooth)]
    assert steps[1] < 0.75 * steps[0]


def test_a_scene_can_be_switched_on_one_context(make_scene: Make, graphics: moderngl.Context) -> None:
    picture = draw(make_scene(EVERYTHING), graphics)
    draw(make_scene(DARK + "objects: {ball: {model: ball, mass: 1}}\ncameras: {front: {}}\n"), graphics)
    np.testing.assert_array_equal(picture, draw(make_scene(EVERYTHING), graphics))


@pytest.mark.parametrize("level", [0.0, 4000.0])
def test_water_is_clear_where_land_is_near(level: float, make_scene: Make, graphics: moderngl.Context) -> None:
    device = Device(graphics)
    model = mesh.load(make_scene("objects: {floor: {model: crate, mass: 1}}").model_path("floor"))
    far, near = np.eye(4), np.eye(4)
    far[:3, 3], near[:3, 3] = (-10, 0, level - 9), (10, 0, level - 0.4)
    shore = survey(device, [(model, far), (model, near)], level)
    assert shore is not None and shore.square[:2] == (0, 0)
    clear = np.frombuffer(shore.texture.read(), np.uint8).reshape(shore.texture.size)
    device.release()
    middle = len(clear) // 2
    assert clear[middle].nonzero()[0].min() > middle  # the block at x = 10 alone; the other lies too deep
    assert clear.max() == 255
