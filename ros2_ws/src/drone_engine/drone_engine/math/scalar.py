"""Minimum and maximum of a few numbers, one comparison per step.

A comparison with NaN is false, so the later argument is returned where one of two is NaN.
"""

from drone_engine.kernel import kernel


@kernel
def min2(x, y):
    """The smaller of two numbers."""
    return x if x < y else y


@kernel
def max2(x, y):
    """The larger of two numbers."""
    return x if x > y else y


@kernel
def min3(x, y, z):
    """The smallest of three numbers."""
    least = x if x < y else y
    return least if least < z else z


@kernel
def max3(x, y, z):
    """The largest of three numbers."""
    most = x if x > y else y
    return most if most > z else z
