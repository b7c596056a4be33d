"""Kernels run without the compiler, too, so that a debugger can step through them."""

import os
import subprocess
import sys

import pytest

WORLD = """
from drone_engine import World, make_scene
crate = {"model": "crate", "mass": 3, "pose": (0, 0, 0.001)}
world = World(make_scene({
    "dynamics": {"substeps": 1}, "effects": {"gravity": {}, "drag": {}}, "collision": {"level": "LEVEL"},
    "objects": {"floor": {"model": "hangar_floor", "static": True, "collision": {"level": "floor"}}, "crate": crate,
                "drone": {"model": "drone", "pose": (2, 0, 1), "mass": 1.4, "flight": {"model": "quadrotor"}}}}))
world.step({"drone": (1.0, 0.0, 0.2, 0.1)})
world.run(2)
print(world.state.hash(), sum(world.contact_counts().values()))
"""
FLEET = """
from drone_engine import Fleet, make_scene
fleet = Fleet(make_scene({
    "dynamics": {"substeps": 2, "integrator": "LEVEL"}, "effects": {"gravity": {}, "drag": {}, "motor_lag": {}},
    "objects": {"drone": {"model": "drone", "pose": (2, 0, 1), "mass": 1.4, "flight": {"model": "quadrotor"}}}}), 3)
fleet.run(3, (1.0, 0.0, 0.2, 0.1))
print(fleet.in_blocks, fleet.world(2).state.hash())
"""


def printed(program: str, without_compiler: bool) -> str:
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1" if without_compiler else "0"}
    result = subprocess.run([sys.executable, "-W", "ignore::RuntimeWarning", "-c", program], env=environment,
                            capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.mark.parametrize(("program", "choice"), [
    (WORLD, "obb"), (WORLD, "triangle"), (FLEET, "midpoint"), (FLEET, "semi_implicit_euler")])
def test_a_small_scene_without_the_compiler_equals_the_compiled_one_bit_for_bit(program: str, choice: str) -> None:
    text = program.replace("LEVEL", choice)
    assert printed(text, without_compiler=True) == printed(text, without_compiler=False)
