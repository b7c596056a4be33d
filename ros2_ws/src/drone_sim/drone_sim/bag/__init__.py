"""Bags in rosbag2's format, written so that what is on disk survives the death of the writer.

BagWriter copies serialized messages; `recover` makes a bag readable whose writer was killed.
"""

from drone_sim.bag.recovery import recover
from drone_sim.bag.storage import BagError, Topic
from drone_sim.bag.writer import BagWriter

__all__ = ["BagError", "BagWriter", "Topic", "recover"]
