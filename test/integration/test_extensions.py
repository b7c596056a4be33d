"""Behaviors from a user's own package in the graph: they work, and an exception in one ends the node in one line."""

from pathlib import Path

import pytest
from geometry_msgs.msg import PoseStamped
from simulation_interfaces.msg import Resource
from simulation_interfaces.srv import LoadWorld

from .live import Graph, Spawn

SCENE = """
version: 1
objects:
  balloon: {model: crate, pose: [0, 0, 2], mass: 1, behavior: {my_package.rising: {speed: SPEED}}}
"""
RISING = '''
from drone_engine.scene.fields import Strict

class Parameters(Strict):
    speed: float

class Behavior:
    def __init__(self, parameters, thing):
        if parameters.speed > 100.0:
            raise ValueError("too fast")
        self.speed, self.thing = parameters.speed, thing

    def step(self):
        if self.thing.pose[2] > 4.0:
            raise RuntimeError("too high\\nfor a balloon")
        self.thing.move([0.0, 0.0, self.speed])
'''


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A scene file with a package beside it."""
    (tmp_path / "my_package").mkdir()
    (tmp_path / "my_package/__init__.py").touch()
    (tmp_path / "my_package/rising.py").write_text(RISING)
    (tmp_path / "fast.yaml").write_text(SCENE.replace("SPEED", "200.0"))
    (tmp_path / "slow.yaml").write_text(SCENE.replace("SPEED", "1.0"))
    return tmp_path / "slow.yaml"


def test_a_behavior_moves_its_object_until_its_exception_ends_the_node(graph: Graph, spawn: Spawn, scene: Path) -> None:
    poses = graph.listen(PoseStamped, "balloon/pose")
    sim = spawn("drone_sim.sim_node", "--log-level", "drone_sim:=info", scene=scene)
    graph.wait_for(lambda: poses, "the first pose")
    request = LoadWorld.Request(world_resource=Resource(uri=str(scene.with_name("fast.yaml"))))
    answer = graph.call(LoadWorld, "load_world", request)
    where = "objects.balloon.behavior.my_package.rising"
    assert answer.result.error_message == f"{scene.with_name('fast.yaml')}: {where}: ValueError: too fast"
    sim.ended_by_test = True
    graph.wait_for(lambda: poses[-1].pose.position.z > 3.5, "the balloon to rise")
    assert sim.wait() == 1
    assert sim.output().splitlines()[-1] == f"drone_sim: {scene}: {where}: RuntimeError: too high"
    assert "Traceback" not in sim.output()
