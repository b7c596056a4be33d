"""Continuous collision detection: times of impact within a step."""
