"""Depth to which debug/markers shows octrees: the parameter `debug_depth` of drone_sim. 0 shows only their roots."""

DEFAULT, DEEPEST = 3, 6
