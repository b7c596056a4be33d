"""Makes the models and textures of the scenes: `python -m make` in the folder of the assets."""
