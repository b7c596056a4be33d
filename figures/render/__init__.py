"""Stills and films drawn by the renderer."""
