"""start.py: runs that end by themselves, by Ctrl-C or with a failed node, and invalid options."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from geometry_msgs.msg import PoseStamped

from .live import Graph, NodeProcess, Spawn

MEADOW = Path(__file__).with_name("meadow.yaml")
START = Path(__file__).parents[2] / "ros2_ws" / "start.py"


@pytest.fixture
def start(spawn: Spawn, tmp_path: Path) -> "Start":
    return Start(spawn, tmp_path)


class Start:
    """start.py without a keyboard, its logs in the test's own folder."""

    def __init__(self, spawn: Spawn, folder: Path) -> None:
        self._spawn = spawn
        self._folder = folder

    def __call__(self, *options: str) -> NodeProcess:
        command = [sys.executable, str(START), "--no-teleop", "--log-dir", str(self._folder / "log"), *options]
        return self._spawn.command("start.py", command)


def test_the_island_flies_for_as_long_as_told(start: Start, tmp_path: Path) -> None:
    run = start("--duration", "3", "--film", str(tmp_path / "film.mp4"))
    assert run.wait(90) == 0
    assert "failed" not in run.output()
    assert f"film: {tmp_path / 'film.mp4'}" in run.output().splitlines()[-1]
    assert (tmp_path / "film.mp4").stat().st_size > 10_000
    assert {path.stem for path in (tmp_path / "log").iterdir()} == {"drone_sim", "drone_render", "drone_ai"}


def test_ctrl_c_is_a_clean_end(start: Start, graph: Graph) -> None:
    run = start("--scene", str(MEADOW), "--no-render")
    heard = graph.listen(PoseStamped, "user_drone/pose")
    graph.wait_for(lambda: heard, "the first pose")
    assert run.interrupt() == 0
    assert "failed" not in run.output()
    assert "killed" not in run.output()


def test_a_node_that_dies_is_named_and_the_others_go_on(start: Start, graph: Graph) -> None:
    run = start("--scene", str(MEADOW), "--no-render")
    heard = graph.listen(PoseStamped, "user_drone/pose")
    graph.wait_for(lambda: heard, "the first pose")
    os.kill(graph.wait_for(lambda: run.child("drone_ai.ai_node"), "the AI's process"), signal.SIGKILL)
    graph.wait_for(lambda: "drone_ai was killed by SIGKILL" in run.output(), "the death to be reported")
    before = len(heard)
    graph.wait_for(lambda: len(heard) > before + 30, "the simulation to go on")
    assert run.interrupt() == 1
    assert "failed: drone_ai" in run.output()


def test_a_namespace_moves_the_whole_graph(start: Start, graph: Graph) -> None:
    run = start("--scene", str(MEADOW), "--no-render", "--namespace", "swarm")
    heard = graph.listen(PoseStamped, "/swarm/user_drone/pose")
    graph.wait_for(lambda: heard, "a pose in the namespace")
    graph.wait_for(lambda: ("drone_ai", "/swarm") in graph.node.get_node_names_and_namespaces(), "the AI")
    own = {name for name, _ in graph.node.get_publisher_names_and_types_by_node("drone_sim", "/swarm")}
    assert "/swarm/clock" in own
    assert own - {"/rosout", "/parameter_events"} == {name for name in own if name.startswith("/swarm/")}
    ears = {name for name, _ in graph.node.get_subscriber_names_and_types_by_node("drone_ai", "/swarm")}
    assert "/swarm/clock" in ears
    assert "/clock" not in ears
    assert run.interrupt() == 0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--scene", "atlantis"], "no scene 'atlantis'; there are"),
        (["--record", "."], "exists"),
        (["--record-topics", "tf"], "--record"),
        (["--film", "film.avi"], ".mp4 or .gif"),
        (["--film", "film.gif", "--no-render"], "--no-render"),
        (["--duration", "-1"], "expected a number of 0 or more"),
        (["--rtf", "nan"], "expected a number of 0 or more"),
        (["--domain", "233"], "0 to 232"),
        (["--namespace", "a b"], "letters"),
        (["--scene", str(MEADOW), "--camera", "nose"], "--camera: expected one of chase, wide, got 'nose'"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(options: list[str], said: str) -> None:
    result = subprocess.run([sys.executable, str(START), *options], capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert said in result.stderr
    assert result.stderr.count("\n") == 1
