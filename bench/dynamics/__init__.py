"""Speed of contact solver, flight models and whole scenes beside MuJoCo, PyBullet, crazyflow and RotorPy."""
