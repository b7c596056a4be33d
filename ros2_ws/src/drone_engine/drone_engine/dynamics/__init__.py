"""How bodies move under forces and contacts."""
