"""Draws a picture, depth and labels of the island after three seconds of flight, with no ROS. Writes PNG files."""

import numpy as np
from PIL import Image

from drone_engine import World, load
from drone_render import Renderer

scene = load("island")
world = World(scene)
for _ in range(round(3 * scene.rates.physics)):
    world.step({"user_drone": (2.0, 0.0, 1.0, 0.3)})  # forward, left, up in m/s; yaw rate in rad/s

with Renderer(scene) as renderer:
    picture = renderer.draw("chase", world)  # (height, width, 3) uint8
    depth, labels = renderer.measure("chase", world)  # (height, width): m, and the number of the object

Image.fromarray(picture).save("island.png")
nearness = 255 / (1 + depth / 10)  # 255 at the camera, 0 where there is nothing
Image.fromarray(nearness.astype(np.uint8)).save("island_depth.png")

names = ["", *scene.objects]
numbers, pixels = np.unique(labels[labels > 0], return_counts=True)
for number, count in sorted(zip(numbers, pixels, strict=True), key=lambda item: -item[1])[:5]:
    nearest = depth[labels == number].min()
    print(f"{names[number]:12} {100 * count / labels.size:5.1f} % of the picture, nearest point at {nearest:.1f} m")
