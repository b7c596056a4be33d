"""Makes a scene without a file: a spiral staircase of crates, and a drone that flies up along it."""

import math
from typing import Any

from drone_engine import SceneError, World, make_scene

STEPS = 12


def staircase(turns: float = 1.0) -> dict[str, Any]:
    """Crates on a helix around the z axis, in the form of an object with several poses."""
    angles = [2 * math.pi * turns * k / STEPS for k in range(STEPS)]
    poses = [(3 * math.cos(a), 3 * math.sin(a), 0.5 * k, 0, 0, a) for k, a in enumerate(angles)]
    return {"model": "crate", "static": True, "poses": poses}


content: dict[str, Any] = {
    "rates": {"physics": 60},
    "effects": {"gravity": {}, "linear_drag": {}},
    "objects": {
        "floor": {"model": "hangar_floor", "static": True, "collision": {"level": "floor"}},
        "step": staircase(),
        "drone": {"model": "drone", "pose": (5, 0, 1), "mass": 1.4, "flight": {"max_speed": 4}},
    },
    "cameras": {"chase": {"parent": "drone", "pose": (-3, 0, 1), "level": True}},
}

world = World(make_scene(content, name="staircase"))
radius, speed = 5.0, 2.0
for k in range(900):  # a circle around the stairs: forward speed = radius x yaw rate
    # The drone starts at heading 0 beside the stairs, so it first turns left to fly along the circle.
    command = (0.0, 0.0, 0.0, math.pi / 2) if k < 60 else (speed, 0.0, 0.35, speed / radius)
    world.step({"drone": command})
x, y, z = world.pose("drone")[:3]
print(f"after {world.time:.0f} s the drone is {math.hypot(x, y):.1f} m from the axis, {z:.1f} m up")
print(f"contacts: {sum(world.contact_counts().values())}")

content["objects"]["step"]["mass"] = 2.0
try:
    make_scene(content, name="staircase")
except SceneError as error:
    print(error)  # one line: the scene, the key, what was expected
