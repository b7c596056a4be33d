"""Start-up time, real-time factor and camera rate of the whole ROS graph."""
