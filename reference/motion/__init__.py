"""Hard cases of motion: the scenes, the limits that they have to keep, and the measurements."""
