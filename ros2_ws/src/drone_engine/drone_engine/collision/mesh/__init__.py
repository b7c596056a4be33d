"""Triangle meshes: octrees, the tests of two of them against each other, and their contacts."""
