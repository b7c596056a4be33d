"""Oriented boxes, spheres and planes."""
