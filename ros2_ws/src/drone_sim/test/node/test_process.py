"""What a node says of the modules that it runs."""

import logging

import pytest
from rclpy.logging import get_logger

from drone_sim.node.process import NodeLog


def test_a_warning_of_a_module_is_a_line_of_the_node(capfd: pytest.CaptureFixture[str]) -> None:
    module, handler = logging.getLogger("drone_engine.geometry.mesh"), NodeLog(get_logger("drone_render"))
    module.addHandler(handler)
    try:
        module.warning("%s: line %d: no texture", "box.mtl", 5)
    finally:
        module.removeHandler(handler)
    said = capfd.readouterr().err
    assert said.startswith("[WARN] ") and said.endswith("[drone_render]: box.mtl: line 5: no texture\n")
