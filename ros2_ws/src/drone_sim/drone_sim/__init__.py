"""The world: scenes, collisions, dynamics, effects, and the node around them."""
