"""ROS messages: serialized from arrays for those of every step, ordinary objects for the rest."""
