"""Rotations and vectors."""
