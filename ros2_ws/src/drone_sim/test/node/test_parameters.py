"""Parameters of a node: their values, their descriptors, and one line for a wrong value."""

from collections.abc import Callable, Iterator

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from drone_sim.node.parameters import ParameterError, Parameters


@pytest.fixture
def node() -> Iterator[Callable[..., Node]]:
    """Makes a node with parameters of these names and values from its command line."""
    context = Context()
    rclpy.init(context=context)
    nodes: list[Node] = []

    def make(**values: object) -> Node:
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        nodes.append(Node("tested", context=context, parameter_overrides=overrides))
        return nodes[-1]

    yield make
    for each in nodes:
        each.destroy_node()
    rclpy.shutdown(context=context)


def test_defaults_and_given_values_are_returned(node: Callable[..., Node]) -> None:
    read = Parameters(node(speed=3.5, name="b", on=True, depth=2, topics=["tf", "", "clock"]))
    assert read.number("speed", 1.0, 0.0, 10.0, "m/s") == 3.5
    assert read.number("turn", 1.0, 0.0, 10.0, "rad/s") == 1.0
    assert read.text("name", "a", "a name") == "b"
    assert read.flag("on", False, "a switch") is True
    assert read.integer("depth", 1, 0, 3, "a depth") == 2
    assert read.texts("topics", "names") == ["tf", "clock"]
    assert read.texts("others", "names") == []


def test_an_integer_is_a_number(node: Callable[..., Node]) -> None:
    tested = node(speed=2)
    assert Parameters(tested).number("speed", 1.0, 0.0, 10.0, "m/s") == 2.0
    assert tested.get_parameter("speed").type_ is Parameter.Type.DOUBLE
    assert tested.describe_parameter("speed").read_only


@pytest.mark.parametrize(("value", "got"), [(11.0, "11.0"), (11, "11"), ("fast", "'fast'"), (True, "True")])
def test_a_wrong_value_is_named_with_what_was_expected(node: Callable[..., Node], value: object, got: str) -> None:
    with pytest.raises(ParameterError) as error:
        Parameters(node(speed=value)).number("speed", 1.0, 0.0, 10.0, "m/s")
    assert str(error.value) == f"parameter speed: expected a number from 0 to 10, got {got}"


def test_a_parameter_can_be_set_while_the_node_runs_unless_it_is_read_only(node: Callable[..., Node]) -> None:
    tested = node()
    read = Parameters(tested)
    read.integer("fixed", 1, 0, 3, "a depth")
    read.integer("depth", 1, 0, 3, "a depth", read_only=False)
    results = tested.set_parameters([Parameter("fixed", value=2), Parameter("depth", value=2),
                                     Parameter("depth", value=4)])
    assert [result.successful for result in results] == [False, True, False]
