"""Hard cases of motion: scenes, the numbers that they have to reach, and how these are measured."""
