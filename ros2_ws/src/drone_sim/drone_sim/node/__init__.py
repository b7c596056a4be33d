"""What the nodes need of ROS: their process, parameters and QoS, and the pace of a simulation."""
