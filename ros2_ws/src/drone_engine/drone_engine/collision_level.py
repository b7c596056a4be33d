"""Collision levels: how closely the shapes of two bodies are compared, from coarse to exact."""

SPHERE, OBB, OCTREE, TRIANGLE = range(4)  # numbered as in drone_interfaces/CollisionEvent
DISABLED, UNSET = -1, -2  # in place of a level: the bodies do not collide; another setting decides
LEVELS = {"none": DISABLED, "sphere": SPHERE, "obb": OBB, "octree": OCTREE, "triangle": TRIANGLE}
TESTED = ("sphere", "obb", "octree", "triangle")  # names of the levels, by number
