"""Reports on scenes: features, cost of a step, and its stages."""
