"""Measurements: speed and accuracy of the simulator beside other libraries. results/ holds their numbers."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
