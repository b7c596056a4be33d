"""Fixtures of the integration tests: a private ROS domain, real node processes, and a node of the test among them.

Each module of tests has its own domain; its tests share the processes and the Graph.
"""

import os
import sys
from collections.abc import Generator, Iterator
from itertools import cycle

import domain_coordinator
import pytest

from drone_sim.node import DDS_PROFILE

os.environ.setdefault("AMENT_PREFIX_PATH", sys.prefix)
os.environ.setdefault("FASTRTPS_DEFAULT_PROFILES_FILE", str(DDS_PROFILE))
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"


from .live import Graph, NodeProcess, Spawn

# Domains whose ports lie below those that Linux gives to outgoing connections.
DOMAINS = range(40, 101)

_RUNNING = pytest.StashKey[list[NodeProcess]]()


@pytest.fixture(scope="module")
def domain_id() -> Iterator[int]:
    """A ROS domain that no other test uses at the same time, not even one of another pytest."""
    with domain_coordinator.domain_id(cycle(DOMAINS).__next__) as domain:
        yield domain


@pytest.fixture(scope="module")
def spawn(domain_id: int, request: pytest.FixtureRequest) -> Iterator[Spawn]:
    """Starts real nodes: `spawn("drone_sim.sim_node", scene="island")`; see live.Spawn."""
    nodes = Spawn(domain_id)
    request.config.stash[_RUNNING] = nodes.processes
    yield nodes
    for process in nodes.processes:
        process.kill()
    request.config.stash[_RUNNING] = []


@pytest.fixture(scope="module")
def graph(domain_id: int, spawn: Spawn) -> Iterator[Graph]:
    """A node of the test itself in the domain of the processes; see live.Graph."""
    with Graph(domain_id, spawn.processes) as graph:
        yield graph


@pytest.fixture(autouse=True)
def _listen_for_one_test(request: pytest.FixtureRequest) -> Iterator[None]:
    yield
    if "graph" in request.fixturenames:
        request.getfixturevalue("graph").stop_listening()


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Forgets processes that ended in an earlier test."""
    processes = item.config.stash.get(_RUNNING, [])
    for process in [process for process in processes if process.ended()]:
        process.kill()  # with the processes it may have started
        processes.remove(process)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Adds the output of the processes of its module to the report of a test that fails."""
    report = yield
    if report.failed:
        for process in item.config.stash.get(_RUNNING, []):
            report.sections.append((f"{process.name}, {process.state()}", process.output()[-5000:]))
    return report
