"""Draws the trail of a drone with a render pass of one's own, my_passes/trail.py. Writes trail.png."""

from pathlib import Path

from PIL import Image

from drone_engine import World, make_scene
from drone_render import Renderer

scene = make_scene(
    {
        "effects": {"gravity": {}},
        "render": {"sky": {}, "passes": {"my_passes.trail": {"object": "drone", "color": (1, 0, 0.8)}}},
        "objects": {
            "floor": {"model": "hangar_floor", "static": True, "collision": {"level": "floor"}},
            "drone": {"model": "drone", "pose": (0, -2, 1), "mass": 1.4, "flight": {"max_speed": 4}},
        },
        "lights": {"sun": {"pose": (-200, 100, 300)}},
        "cameras": {"behind": {"pose": (-6, 0, 3, 0, 0.25, 0)}},
    },
    name="trail",
    folder=Path(__file__).parent,  # where the package my_passes is
)
world = World(scene)
with Renderer(scene) as renderer:
    for _ in range(90):
        world.step({"drone": (2.0, 0.0, 0.3, 1.2)})
        picture = renderer.draw("behind", world)  # each picture adds a point to the trail
Image.fromarray(picture).save("trail.png")
red, green, _ = picture.astype(int).transpose(2, 0, 1)
print(f"trail.png: the trail covers {(red - green > 30).sum()} pixels")
