"""Scenes: the schema of scene files, validation, and loading from YAML or from Python data."""
