"""Broad phase: hierarchical uniform grids find the pairs of bodies whose bounds overlap."""
