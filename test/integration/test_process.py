"""A single node: it ends cleanly on a signal, and rejects wrong parameters in one line."""

import signal

import pytest
from geometry_msgs.msg import PoseStamped

from .live import Graph, Spawn


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_simulation_cleanly(graph: Graph, spawn: Spawn, number: signal.Signals) -> None:
    poses = graph.listen(PoseStamped, "user_drone/pose")
    sim = spawn("drone_sim.sim_node", scene="hangar")
    graph.wait_for(lambda: poses, "the simulation to run")
    sim.send(number)
    assert sim.wait() == 0
    assert "Traceback" not in sim.output()


@pytest.mark.parametrize(("parameters", "said"), [
    ({"rtf": 2000.0}, "drone_sim: parameter rtf: expected a number from 0 to 1000, got 2000.0"),
    ({"rtf": "fast"}, "drone_sim: parameter rtf: expected a number from 0 to 1000, got 'fast'"),
    ({"scene": "atlantis"}, "drone_sim: no scene 'atlantis'; there are crates, hangar, island, lagoon, ring"),
])
def test_a_parameter_that_cannot_be_is_refused_in_one_line(
        spawn: Spawn, parameters: dict[str, object], said: str) -> None:
    sim = spawn("drone_sim.sim_node", **parameters)
    assert sim.wait() == 1
    assert sim.output().startswith(said)
    assert sim.output().count("\n") == 1
