"""Collision levels: how closely the shapes of two bodies are compared, from the coarsest to the exact."""

SPHERE, OBB, OCTREE, TRIANGLE = range(4)  # as drone_interfaces/CollisionEvent numbers them
DISABLED, UNSET = -1, -2  # instead of a level: the two pass through each other; another setting decides
LEVELS = {"none": DISABLED, "sphere": SPHERE, "obb": OBB, "octree": OCTREE, "triangle": TRIANGLE}
TESTED = ("sphere", "obb", "octree", "triangle")  # the names of the levels that are tested, in order
