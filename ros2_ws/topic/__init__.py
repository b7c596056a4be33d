"""The command `topic`: a look at topics for those who have no ROS install."""
