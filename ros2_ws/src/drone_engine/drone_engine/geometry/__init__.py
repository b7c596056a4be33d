"""Models as arrays: meshes, materials, mass properties."""
