"""The README holds: its examples run, and a plain `colcon build` builds every package."""

import os
import re
import subprocess
import sys
from pathlib import Path

from geometry_msgs.msg import PoseStamped

from .live import Graph, Spawn

ROOT = Path(__file__).parents[2]
EXAMPLES = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)


def test_the_node_of_the_readme_flies(graph: Graph, spawn: Spawn, tmp_path: Path) -> None:
    program = tmp_path / "square.py"
    program.write_text(next(code for code in EXAMPLES if "rclpy" in code))
    poses = graph.listen(PoseStamped, "user_drone/pose")
    spawn("drone_sim.sim_node", scene="hangar")
    spawn.command("square", [sys.executable, str(program)])
    graph.wait_for(lambda: span([pose.pose.position.x for pose in poses]) > 0.5, "the drone to fly forward")
    graph.wait_for(lambda: span([pose.pose.position.y for pose in poses]) > 0.5, "the drone to fly sideways")


def span(numbers: list[float]) -> float:
    """Difference of the largest and the smallest number."""
    return max(numbers) - min(numbers) if numbers else 0.0


def test_the_world_of_the_readme_runs_without_ros() -> None:
    code = next(code for code in EXAMPLES if "World" in code)
    runs = [subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
            for _ in range(2)]
    assert re.fullmatch(r"\[ ?[\d.e+ -]+\s[^]]*\] [0-9a-f]{64}\n", runs[0], re.DOTALL)
    assert runs[0] == runs[1]


def test_plain_colcon_builds_every_package(tmp_path: Path) -> None:
    """As on a machine with a ROS install, but for the folders, which are temporary here."""
    tools = Path(sys.executable).parent
    environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "VIRTUAL_ENV": sys.prefix,
                   "AMENT_PREFIX_PATH": sys.prefix, "PYTHONHASHSEED": "0", "COLCON_LOG_PATH": str(tmp_path / "log")}
    build = subprocess.run(
        ["colcon", "build", "--build-base", str(tmp_path / "build"), "--install-base", str(tmp_path / "install")],
        cwd=ROOT / "ros2_ws", env=environment, capture_output=True, text=True, check=False)
    assert build.returncode == 0, build.stdout + build.stderr
    packages = {path.name for path in (tmp_path / "install").iterdir() if path.is_dir()}
    assert packages == {"drone_ai", "drone_engine", "drone_interfaces", "drone_render", "drone_sim", "drone_teleop"}
    assert (tmp_path / "install/drone_sim/lib/drone_sim/sim_node").is_file()
    scenes = (tmp_path / "install/drone_engine").glob("lib/python3*/site-packages/drone_engine/data/scenes/*.yaml")
    assert {scene.name for scene in scenes} == {path.name for path in (ROOT / "assets/scenes").glob("*.yaml")}
    assert list((tmp_path / "install/drone_sim").glob("lib/python3*/site-packages/drone_sim/node/fastdds.xml"))
    shaders = list((tmp_path / "install/drone_render").rglob("*.frag"))
    assert {shader.name for shader in shaders} == {
        path.name for path in (ROOT / "ros2_ws/src/drone_render/drone_render/gl/shaders").glob("*.frag")}
    for command in ("topic", "drone_engine"):
        shell = f". {tmp_path / 'install/local_setup.sh'} && command -v {command} && {command} --help"
        result = subprocess.run(["sh", "-c", shell], cwd=tmp_path / "install", env=environment | {"PYTHONPATH": ""},
                                capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stdout + result.stderr
        assert result.stdout.startswith(str(tmp_path / "install"))
