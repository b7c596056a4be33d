"""Models from OBJ and MTL files: triangles, materials, bounding boxes and moments of inertia."""
