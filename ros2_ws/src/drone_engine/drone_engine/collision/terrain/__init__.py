"""Terrain: height fields and the contacts of bodies with them."""
