"""The parts of the node: messages, topics and services."""
