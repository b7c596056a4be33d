"""Which lights shine on which objects."""

import moderngl
import numpy as np

from drone_render.frame.hierarchy import Hierarchy
from drone_render.frame.lighting import Lighting

from ..drawing import Make, draw

DARK = "render: {ambient: [0, 0, 0]}\n"


def boxes(*middles: list[float]) -> np.ndarray:
    """Matrices of boxes without rotation."""
    matrices = np.tile(np.eye(4), (len(middles), 1, 1))
    matrices[:, :3, 3] = middles
    return matrices


def test_an_object_is_lit_by_its_four_strongest_lights(make_scene: Make) -> None:
    lights = "\n".join(f"  light_{i}: {{pose: [{i}, 0, 3], reach: 2, intensity: 1}}" for i in range(9))
    lights += "\n  sun: {pose: [0, 0, 90]}\n"
    scene = make_scene(f"objects: {{ball: {{model: ball, mass: 1}}}}\nlights:\n{lights}")
    hierarchy = Hierarchy(scene)
    lighting = Lighting(hierarchy)
    places = lighting.matrices(hierarchy.world(hierarchy.start))
    (chosen,) = lighting.strongest(places, np.zeros(1, np.intp), boxes([0, 0, 0]), np.full((1, 3), 0.5))
    assert list(chosen) == [0, 1, 2, 9]
    (far,) = lighting.strongest(places, np.zeros(1, np.intp), boxes([500, 0, 0]), np.full((1, 3), 0.5))
    assert list(far) == [9]  # the others have ended


def test_lights_over_a_wide_floor_count_by_their_distance(make_scene: Make) -> None:
    lights = "\n".join(f"  light_{i}: {{pose: [{i}, 0, {9 - 2 * i}], reach: 2}}" for i in range(5))
    hierarchy = Hierarchy(make_scene(f"objects: {{floor: {{model: floor, static: true}}}}\nlights:\n{lights}"))
    lighting = Lighting(hierarchy)
    places = lighting.matrices(hierarchy.world(hierarchy.start))
    turned = boxes([0, 0, 0])
    turned[0, :3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]  # rotated: its thin side is up
    (chosen,) = lighting.strongest(places, np.zeros(1, np.intp), turned, np.array([[20, 0.1, 20]]))
    assert list(chosen) == [1, 2, 3, 4]


def test_a_beam_that_misses_an_object_is_not_among_its_lights(make_scene: Make) -> None:
    scene = make_scene("""
objects: {ball: {model: ball, mass: 1}}
lights: {lamp: {pose: [0, 0, 3], beam: 0.5, reach: 20}, other: {pose: [0, 0, 3, 0, 1.5707963, 0], beam: 0.5, reach: 9}}
""")
    hierarchy = Hierarchy(scene)
    lighting = Lighting(hierarchy)
    places = lighting.matrices(hierarchy.world(hierarchy.start))
    around = boxes([0, 0, 0], [5, 0, 3], [0, 0, 3.1])
    chosen = lighting.strongest(places, np.zeros(3, np.intp), around, np.full((3, 3), 0.3))
    assert [list(numbers) for numbers in chosen] == [[1], [0], [0, 1]]


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
    assert not own.any()  # nor is it lit by the light of its parent
    assert other.max() > 300


def test_a_far_beam_is_no_sun(make_scene: Make, graphics: moderngl.Context) -> None:
    """A distant beam lights only the objects that it points at."""
    scene = """
objects: {ball: {model: ball, pose: [3, 0, 0], mass: 1}}
lights: {lamp: {pose: [-300, 0, 0, 0, 0, YAW], beam: 0.05}}
cameras: {front: {size: [90, 60]}}
"""
    towards, away = (draw(make_scene(DARK + scene.replace("YAW", yaw)), graphics) for yaw in ("0", "3.1415927"))
    assert towards.max() > 100 and not away.any()


def test_only_a_distant_light_is_the_sun(make_scene: Make, graphics: moderngl.Context) -> None:
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


def test_a_beam_lights_the_objects_in_front_of_it(make_scene: Make, graphics: moderngl.Context) -> None:
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
