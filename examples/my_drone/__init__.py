"""A package of one's own: an effect, a flight model, a controller and behaviors that scenes name."""
