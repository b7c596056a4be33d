"""The command `topic`, which lists, prints, measures and publishes topics without a ROS install."""
