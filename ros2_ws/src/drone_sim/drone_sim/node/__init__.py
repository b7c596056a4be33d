"""What the nodes need of ROS: their process, parameters and QoS, and the pace of a simulation."""

from pathlib import Path

DDS_PROFILE = Path(__file__).with_name("fastdds.xml")
"""Fast DDS settings of all nodes but the renderer: for FASTRTPS_DEFAULT_PROFILES_FILE."""
