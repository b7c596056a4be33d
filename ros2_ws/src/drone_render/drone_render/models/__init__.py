"""Prepares models for drawing: levels of detail, vertex attributes and textures. Arrays only, without OpenGL."""
