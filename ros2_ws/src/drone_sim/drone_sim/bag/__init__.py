"""Bags in the format of rosbag2, written so that their files can be read back after the writer was killed.

BagWriter writes serialized messages; `recover` completes a bag whose writer was killed.
"""

from drone_sim.bag.recovery import recover
from drone_sim.bag.storage import BagError, Topic
from drone_sim.bag.writer import BagWriter

__all__ = ["BagError", "BagWriter", "Topic", "recover"]
