"""A scene with one's own effect, flight model, controller and behaviors: those of the package my_drone, beside it."""

from pathlib import Path

from drone_engine import World, make_scene

scene = make_scene({
    "version": 1,
    "effects": {"gravity": {}, "my_drone.spring": {"stiffness": 0.5}},
    "objects": {
        "user_drone": {"model": "drone", "pose": [3, 0, 1], "mass": 1.4, "flight": {},
                       "behavior": {"my_drone.laps": {}}},
        "balloon": {"model": "crate", "pose": [0, 6, 2], "mass": 2.0,
                    "flight": {"model": "my_drone.balloon", "parameters": {"response": 0.5},
                               "cmd_vel": "balloon/cmd_vel",
                               "controller": {"my_drone.follow": {"target": "user_drone"}}}},
        "door": {"model": "crate", "pose": [3, 0, 4], "mass": 40,
                 "behavior": {"my_drone.door": {"opens_for": "balloon"}}},
    },
}, name="extensions", folder=Path(__file__).parent)

world = World(scene)
for _ in range(300):
    world.step({"user_drone": (1.5, 0.0, 0.0, 0.5)})  # a circle
print("laps", round(float(world.state.memory["user_drone.laps"][0]), 2))
print("balloon at", world.pose("balloon")[:3].round(1), "door at", world.pose("door")[:3].round(1))
