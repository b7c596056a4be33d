"""Scene files: schema, validation, loading."""
