"""ROS messages as bytes."""
