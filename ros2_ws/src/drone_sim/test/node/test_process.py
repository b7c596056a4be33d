"""The process of a node: how it ends, and its log."""

import logging
import os
import signal
import subprocess
import sys

import pytest
from rclpy.logging import get_logger

from drone_sim.node.process import NodeLog, Stop

NODE = """
import sys
from rclpy.node import Node
from drone_sim.node.process import run, spin, spinning
class Tested(Node):
    def __init__(self, stop):
        super().__init__("tested")
        self.create_timer(0.01, {timer})
    def fail(self):
        raise ValueError("no air")
    def work(self, stop):
        {work}
        print("interrupted" if stop.interrupted else "stopped", flush=True)
def up():
    print("up", flush=True)
sys.exit(run("tested", Tested, [], ValueError, work=Tested.work))
"""
IN_MAIN, IN_THREAD = "spin(self, stop)", "with spinning(self, stop): wait(stop)"
WAIT = "def wait(stop):\n    import time\n    while not stop.is_set(): time.sleep(0.01)\n"


def start(timer: str, work: str) -> subprocess.Popen[str]:
    environment = os.environ | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}
    return subprocess.Popen([sys.executable, "-c", WAIT + NODE.format(timer=timer, work=work)], env=environment,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.mark.parametrize("work", [IN_MAIN, IN_THREAD])
@pytest.mark.parametrize(("number", "last"), [(signal.SIGINT, "interrupted"), (signal.SIGTERM, "stopped")])
def test_a_signal_ends_the_work_after_the_running_callback(work: str, number: signal.Signals, last: str) -> None:
    with start("up", work) as process:
        assert process.stdout and process.stdout.readline() == "up\n"
        process.send_signal(number)
        output, errors = process.communicate()
    assert process.returncode == 0
    assert errors == ""
    assert output.splitlines()[-1] == last


@pytest.mark.parametrize("work", [IN_MAIN, IN_THREAD])
def test_an_expected_error_in_a_callback_is_one_line(work: str) -> None:
    with start("self.fail", work) as process:
        _, errors = process.communicate()
    assert process.returncode == 1
    assert errors == "tested: no air\n"


def test_a_stop_may_be_set_twice() -> None:
    stop = Stop()
    assert not stop.is_set()
    stop.set()
    stop.set()
    assert stop.is_set() and not stop.interrupted


def test_a_warning_of_a_module_is_a_line_of_the_node(capfd: pytest.CaptureFixture[str]) -> None:
    module, handler = logging.getLogger("drone_engine.geometry.mesh"), NodeLog(get_logger("drone_render"))
    module.addHandler(handler)
    try:
        module.warning("%s: line %d: no texture", "box.mtl", 5)
    finally:
        module.removeHandler(handler)
    logged = capfd.readouterr().err
    assert logged.startswith("[WARN] ") and logged.endswith("[drone_render]: box.mtl: line 5: no texture\n")
