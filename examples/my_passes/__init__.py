"""Render passes of a user's own package; see own_render_pass.py."""
