"""The picture: draws the scene off-screen and publishes camera images."""
