"""Ray casts."""
