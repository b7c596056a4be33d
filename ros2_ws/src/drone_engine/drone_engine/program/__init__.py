"""A step as one compiled loop of stages."""
