"""Antialiasing of edges between surfaces."""

import moderngl
import numpy as np

from ..drawing import Make, draw


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
