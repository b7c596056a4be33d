"""The version of all packages of the simulator."""

__version__ = "0.1.0"
