"""Rotations: formulas on numbers (quaternion), the same compiled (rotation), and arrays of poses (poses)."""
