"""The AI pilot: flies a patrol, and lands while it is held."""
