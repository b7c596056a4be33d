"""Nodes around the simulation engine: the simulation, the recorder, ROS messages as bytes, and the command `topic`."""
