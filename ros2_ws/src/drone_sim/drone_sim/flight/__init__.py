"""How drones turn commands into forces."""
