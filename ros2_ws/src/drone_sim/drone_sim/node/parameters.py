"""The parameters of a node: declared, checked and read in one place."""

from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node


class ParameterError(ValueError):
    """A parameter with a value that it cannot have, in one line that names it."""


class Parameters:
    """Declares the parameters of a node and returns their values at the start; they are read-only unless noted.

    Every method raises ParameterError if the command line or a parameter file gives another type or a value outside
    of the range, which includes its ends.
    """

    def __init__(self, node: Node) -> None:
        self._node = node

    def text(self, name: str, default: str, description: str) -> str:
        """A string."""
        return str(self._declare(name, default, "a string", ParameterDescriptor(description=description)))

    def texts(self, name: str, description: str) -> list[str]:
        """A list of strings, empty by default; empty strings are left out."""
        # ROS cannot tell the type of an empty list.
        values = self._declare(name, [""], "a list of strings", ParameterDescriptor(description=description))
        return [str(value) for value in values if value]

    def flag(self, name: str, default: bool, description: str) -> bool:
        """True or false."""
        return bool(self._declare(name, default, "true or false", ParameterDescriptor(description=description)))

    def number(self, name: str, default: float, low: float, high: float, description: str) -> float:
        """A float from `low` to `high`; an integer is converted."""
        limits = [FloatingPointRange(from_value=low, to_value=high)]
        return float(self._declare(name, default, f"a number from {low:g} to {high:g}",
                                   ParameterDescriptor(description=description, floating_point_range=limits)))

    def integer(self, name: str, default: int, low: int, high: int, description: str, read_only: bool = True) -> int:
        """An integer from `low` to `high`. read_only: whether it stays as it is while the node runs."""
        limits = [IntegerRange(from_value=low, to_value=high, step=1)]
        return int(self._declare(name, default, f"an integer from {low} to {high}",
                                 ParameterDescriptor(description=description, integer_range=limits), read_only))

    def _declare(self, name: str, default: Any, expected: str, descriptor: ParameterDescriptor,
                 read_only: bool = True) -> Any:
        descriptor.read_only = read_only
        try:
            return self._node.declare_parameter(name, default, descriptor).value
        except (InvalidParameterTypeException, InvalidParameterValueException):
            got = self._node.declare_parameter(name, default, ParameterDescriptor(dynamic_typing=True)).value
        if isinstance(default, float) and type(got) is int:
            self._node.undeclare_parameter(name)
            try:
                return self._node.declare_parameter(name, float(got), descriptor, ignore_override=True).value
            except InvalidParameterValueException:
                pass
        raise ParameterError(f"parameter {name}: expected {expected}, got {got!r}")
