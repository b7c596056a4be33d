"""Speed of the collision detection beside coal and FCL."""
