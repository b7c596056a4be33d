"""The sky's domes: their center, and their colors by daylight."""

import moderngl
import numpy as np

from ..drawing import Make, draw

SKY = """
render: {ambient: [0.4, 0.4, 0.4], daylight: DAYLIGHT, sky: {stars: noise, clouds: clouds, MORE}}
objects:
  drone: {model: ball, pose: PLACE, mass: 1}
  floor: {model: floor, pose: [0, 0, -2], static: true}
lights: {sun: {pose: [-100, 200, 300]}}
cameras: {front: {size: [80, 60], pose: [0, 0, 0, 0, -0.3, 0]}}
"""


def sky(daylight: float = 1.0, more: str = "radius: 300", place: str = "[-5, 0, 0]") -> str:
    return SKY.replace("DAYLIGHT", str(daylight)).replace("MORE", more).replace("PLACE", place)


def test_it_gets_dark_and_the_stars_come_out(make_scene: Make, graphics: moderngl.Context) -> None:
    day, dusk, night = (draw(make_scene(sky(light)), graphics).astype(float) for light in (1.0, 0.4, 0.0))
    above, below = np.s_[:20], np.s_[50:]
    assert day[above].mean() > dusk[above].mean() > night[above].mean() > 5
    assert day[below].mean() > dusk[below].mean() > night[below].mean() > 5
    starless = draw(make_scene(sky(0.0).replace("stars: noise, ", "")), graphics).astype(float)
    assert np.abs(night - starless)[above].mean() > 2 and not np.abs(night - starless)[below].any()
    by_day = draw(make_scene(sky(1.0).replace("stars: noise, ", "")), graphics)
    np.testing.assert_array_equal(by_day, day)


def test_domes_move_with_their_parent(make_scene: Make, graphics: moderngl.Context) -> None:
    def far(more: str, place: str) -> np.ndarray:
        return draw(make_scene(sky(1.0, more, place)), graphics).astype(float)[:20]

    free = [far("radius: 300", place) for place in ("[-5, 0, 0]", "[-5, 60, 0]")]
    np.testing.assert_array_equal(*free)  # centered on the camera
    hanging = [far("radius: 300, parent: drone", place) for place in ("[0, 0, 0]", "[-5, 60, 0]")]
    np.testing.assert_allclose(hanging[0], free[0], atol=1)  # the drone is where the camera is
    assert np.abs(hanging[1] - hanging[0]).mean() > 3


def test_colors_come_from_a_texture(make_scene: Make, graphics: moderngl.Context) -> None:
    """noise.png has a different color in each pixel of its 16 columns."""
    text = sky().replace("clouds: clouds, ", "")
    left, right = (draw(make_scene(text.replace("stars: noise", "colours: noise").replace("daylight: 1.0", light)),
                        graphics).astype(float) for light in ("daylight: 0.9", "daylight: 1.0"))
    assert np.abs(left - right)[:20].mean() > 3
    assert np.ptp(right[:30, 40].mean(axis=1)) > 10
