"""Error and CPU time of the four collision levels."""
