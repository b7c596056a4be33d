"""Oriented boxes, spheres and horizontal planes."""
